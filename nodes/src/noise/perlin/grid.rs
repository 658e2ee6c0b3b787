//! From the columns and rows around a position to the hashes of their lattice points.

use crate::noise::hash::{COLUMN_FACTOR, ROW_FACTOR, corner};
use crate::noise::octave::Octave;
use crate::noise::tile::wrapped;
use mipless_codegen::ir::{Builder, Type, Value};

const FACTORS: [u32; 2] = [COLUMN_FACTOR, ROW_FACTOR];

/// The lattice around a position.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    cells: [Value; 2],
    seed: Value,
    /// After how many cells (a real) it repeats; the position's cell then lies in the period.
    period: Option<Value>,
}

impl Grid {
    pub(super) fn of(state: &Octave<2>) -> Self {
        Self {
            cells: state.cells,
            seed: state.seed,
            period: state.period,
        }
    }

    /// The parameters of a function that takes it over, in the order of [`Grid::captures`].
    pub(super) fn declare(b: &mut Builder, tiles: bool) -> Self {
        Self {
            cells: [b.param("cell_x", Type::I32), b.param("cell_y", Type::I32)],
            seed: b.param("seed", Type::U32),
            period: tiles.then(|| b.param_f32("period")),
        }
    }

    pub(super) fn captures(&self) -> Vec<Value> {
        let mut all = self.cells.to_vec();
        all.push(self.seed);
        all.extend(self.period);
        all
    }

    /// The word of the column (axis 0) or row (axis 1) at `offset`, an integer as a real, from the
    /// position's cell. Words of an axis differ by its factor from one to the next.
    pub(super) fn word(&self, b: &mut Builder, axis: usize, offset: Value) -> Value {
        let cell = self.cells[axis];
        let place = match self.period {
            None => {
                let offset = b.trunc_i(offset);
                b.add_i(cell, offset)
            }
            Some(period) => {
                let cell = b.float_i(cell);
                let place = b.add(cell, offset);
                let place = wrapped(b, place, period);
                b.trunc_i(place)
            }
        };
        let factor = b.u32(FACTORS[axis]);
        let place = b.cast_u(place);
        let word = b.mul_u(place, factor);
        if axis == 1 {
            b.add_u(word, self.seed)
        } else {
            word
        }
    }

    /// The hashes of the four corners of the cell: (0, 0), (1, 0), (0, 1), (1, 1).
    pub(super) fn corners(&self, b: &mut Builder) -> [Value; 4] {
        let [columns, rows] = [0, 1].map(|axis| {
            let (zero, one) = (b.f32(0.0), b.f32(1.0));
            let first = self.word(b, axis, zero);
            let second = if self.period.is_some() {
                self.word(b, axis, one)
            } else {
                let factor = b.u32(FACTORS[axis]);
                b.add_u(first, factor)
            };
            [first, second]
        });
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| corner(b, columns[i], rows[j]))
    }
}
