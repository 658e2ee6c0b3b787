//! From the rows and columns around a position to the keys of their lattice points, wrapped where
//! the lattice tiles.

use crate::noise::hash::{key, steps, walked};
use crate::noise::sum::Octave;
use crate::noise::tile::wrapped;
use mipless_codegen::ir::{Bool, Builder, Float, Scalar, Scalars, Uint};

/// The lattice around a position, seen along rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Address<'b> {
    key: Uint<'b>,
    /// What a step along x and y adds to the key.
    steps: [Uint<'b>; 2],
    tile: Option<Tile<'b>>,
}

/// A lattice that repeats: the key is then the seed's.
#[derive(Clone, Copy, Debug)]
struct Tile<'b> {
    /// The cell of the position in the period, as reals.
    origin: [Float<'b>; 2],
    period: Float<'b>,
}

impl<'b> Address<'b> {
    /// With x and y exchanged where `swapped`.
    pub(super) fn swapped(self, swapped: Bool<'b>) -> Self {
        let [step_x, step_y] = self.steps;
        Self {
            steps: [
                swapped.select(step_y, step_x),
                swapped.select(step_x, step_y),
            ],
            tile: self.tile.map(|tile| Tile {
                origin: exchanged(swapped, tile.origin),
                ..tile
            }),
            ..self
        }
    }

    /// With rows counted from `row` (a real, relative to the cell).
    pub(super) fn rows_counted_from(mut self, row: Float<'b>) -> Self {
        match &mut self.tile {
            Some(tile) => tile.origin[1] += row,
            None => self.key = walked(self.key, row.to_int(), self.steps[1]),
        }
        self
    }

    /// The parameters of a function that takes it over.
    pub(super) fn declare(b: &'b Builder, tiles: bool) -> Self {
        Self {
            key: b.uint_param("key"),
            steps: ["step_x", "step_y"].map(|name| b.uint_param(name)),
            tile: tiles.then(|| Tile {
                origin: b.float_params(["origin_x", "origin_y"]),
                period: b.float_param("period"),
            }),
        }
    }

    /// The keys of `count` lattice points of row `index`, from the column `start` (a real, relative to
    /// the cell) on.
    pub(super) fn keys(&self, index: Uint<'b>, start: Float<'b>, count: usize) -> Vec<Uint<'b>> {
        let [step_x, step_y] = self.steps;
        match self.tile {
            Some(Tile { origin, period }) => {
                let row = wrapped(origin[1] + index.to_float(), period);
                let key = walked(self.key, row.to_int(), step_y);
                let start = origin[0] + start;
                (0..count)
                    .map(|i| {
                        let column = wrapped(start + i as f32, period);
                        walked(key, column.to_int(), step_x)
                    })
                    .collect()
            }
            None => {
                let first = walked(self.key + index * step_y, start.to_int(), step_x);
                std::iter::successors(Some(first), |&key| Some(key + step_x))
                    .take(count)
                    .collect()
            }
        }
    }
}

/// x and y exchanged where `swapped`.
pub(super) fn exchanged<'b>(swapped: Bool<'b>, [x, y]: [Float<'b>; 2]) -> [Float<'b>; 2] {
    [swapped.select(y, x), swapped.select(x, y)]
}

impl<'b> Scalars<'b> for Address<'b> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        let tile = self.tile.map(|tile| (tile.origin, tile.period));
        (self.key, self.steps, tile).each(visit);
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        let tile = self.tile.map(|tile| (tile.origin, tile.period));
        let (key, steps, tile) = (self.key, self.steps, tile).replaced(next);
        Self {
            key,
            steps,
            tile: tile.map(|(origin, period)| Tile { origin, period }),
        }
    }
}

impl<'b> Octave<'b, 2> {
    /// The lattice around the position.
    pub(super) fn address(&self) -> Address<'b> {
        let tile = self.period.map(|period| Tile {
            origin: self.cells.map(|cell| cell.to_float()),
            period,
        });
        Address {
            key: tile.map_or_else(|| key(self.cells, self.seed), |_| self.seed),
            steps: steps(self.seed.builder()),
            tile,
        }
    }
}
