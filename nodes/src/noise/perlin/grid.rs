//! From the columns and rows around a position to the hashes of their lattice points.

use super::Kind;
use crate::noise::hash::{AXES, corner, word};
use crate::noise::jenkins;
use crate::noise::sum::{Octave, Octaves, along};
use crate::noise::tile::wrapped;
use crate::noise::trigonometric;
use mipless_codegen::ir::{Builder, Float, Int, Scalar, Scalars, Uint};

/// Whether a lattice repeats, and how many times as far along y.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tiles(bool, f32);

impl Tiles {
    pub(super) fn of(octaves: Octaves) -> Self {
        Self(octaves.tiles(), octaves.ratio)
    }
}

/// The lattice around a position.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid<'b> {
    cells: [Int<'b>; 2],
    seed: Uint<'b>,
    /// After how many cells (a real) it repeats; the position's cell then lies in the period.
    period: Option<Float<'b>>,
    /// How many times as far it repeats along y.
    ratio: f32,
    kind: Kind,
}

impl<'b> Grid<'b> {
    pub(super) fn of(state: &Octave<'b, 2>, kind: Kind) -> Self {
        Self {
            kind,
            cells: state.cells,
            seed: state.seed,
            period: state.period,
            ratio: state.ratio,
        }
    }

    /// The parameters of a function that takes it over.
    pub(super) fn declare(b: &'b Builder, kind: Kind, tiles: Tiles) -> Self {
        Self {
            kind,
            cells: ["cell_x", "cell_y"].map(|name| b.int_param(name)),
            seed: b.uint_param("seed"),
            period: tiles.0.then(|| b.float_param("period")),
            ratio: tiles.1,
        }
    }

    /// The word of the column (axis 0) or row (axis 1) at `offset`, an integer as a real, from the
    /// position's cell.
    pub(super) fn word(&self, axis: usize, offset: Float<'b>) -> Uint<'b> {
        self.mixed(self.line(axis, offset))
    }

    /// The word of a line.
    fn mixed(&self, line: Uint<'b>) -> Uint<'b> {
        match self.kind {
            Kind::Materialx(_) | Kind::Materialmaker { .. } => line,
            _ => word(line),
        }
    }

    /// The hash of a lattice point from the words of its column and its row.
    pub(super) fn corner(&self, column: Uint<'b>, row: Uint<'b>) -> Uint<'b> {
        match self.kind {
            Kind::Materialx(_) => jenkins::plane([column, row], self.seed),
            Kind::Materialmaker { seed } => {
                let place = [column, row].map(|line| line.to_int());
                trigonometric::plane(place, seed)
            }
            _ => corner(column, row),
        }
    }

    /// What a step along an axis adds to a line.
    fn factor(&self, axis: usize) -> u32 {
        match self.kind {
            Kind::Materialx(_) | Kind::Materialmaker { .. } => 1,
            _ => AXES[axis],
        }
    }

    /// What the word is made of: lines of an axis differ by its factor from one to the next.
    fn line(&self, axis: usize, offset: Float<'b>) -> Uint<'b> {
        let cell = self.cells[axis];
        let place = match self.period {
            None => cell + offset.to_int(),
            Some(period) => {
                let period = along(axis, period, self.ratio);
                wrapped(cell.to_float() + offset, period).to_int()
            }
        };
        let line = place.to_uint() * self.factor(axis);
        match self.kind {
            Kind::Materialx(_) | Kind::Materialmaker { .. } => line,
            _ if axis == 1 => line + self.seed,
            _ => line,
        }
    }

    /// The hashes of the four corners of the cell: (0, 0), (1, 0), (0, 1), (1, 1).
    pub(super) fn corners(&self) -> [Uint<'b>; 4] {
        let b = self.seed.builder();
        let [columns, rows] = [0, 1].map(|axis| {
            let first = self.line(axis, b.float(0.0));
            let second = if self.period.is_some() {
                self.line(axis, b.float(1.0))
            } else {
                first + self.factor(axis)
            };
            [first, second].map(|line| self.mixed(line))
        });
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| self.corner(columns[i], rows[j]))
    }
}

impl<'b> Scalars<'b> for Grid<'b> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        (self.cells, self.seed, self.period).each(visit);
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        let (cells, seed, period) = (self.cells, self.seed, self.period).replaced(next);
        Self {
            cells,
            seed,
            period,
            ..self
        }
    }
}
