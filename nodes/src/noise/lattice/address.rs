//! From the rows and columns around a position to the keys of their lattice points, wrapped where
//! the lattice tiles.

use crate::noise::hash::{key, steps, walked};
use crate::noise::octave::Octave;
use crate::noise::tile::wrapped;
use mipless_codegen::ir::{Builder, Type, Value};

/// The lattice around a position, seen along rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Address {
    key: Value,
    /// What a step along x and y adds to the key.
    steps: [Value; 2],
    tile: Option<Tile>,
}

/// A lattice that repeats: the key is then the seed's.
#[derive(Clone, Copy, Debug)]
struct Tile {
    /// The cell of the position in the period, as reals.
    origin: [Value; 2],
    period: Value,
}

impl Address {
    /// The lattice around a position in these cells (i32), with a period (a real) if it tiles.
    pub(super) fn new(
        b: &mut Builder,
        cells: [Value; 2],
        seed: Value,
        period: Option<Value>,
    ) -> Self {
        let steps = steps(b);
        let tile = period.map(|period| Tile {
            origin: cells.map(|cell| b.float_i(cell)),
            period,
        });
        let key = match tile {
            Some(_) => seed,
            None => key(b, cells, seed),
        };
        Self { key, steps, tile }
    }

    /// With x and y exchanged where `swapped`.
    pub(super) fn swapped(mut self, b: &mut Builder, swapped: Value) -> Self {
        let mut turn = |[x, y]: [Value; 2]| [b.select(swapped, y, x), b.select(swapped, x, y)];
        self.steps = turn(self.steps);
        if let Some(tile) = &mut self.tile {
            tile.origin = turn(tile.origin);
        }
        self
    }

    /// With rows counted from `row` (a real, relative to the cell).
    pub(super) fn rows_counted_from(mut self, b: &mut Builder, row: Value) -> Self {
        match &mut self.tile {
            Some(tile) => tile.origin[1] = b.add(tile.origin[1], row),
            None => {
                let row = b.trunc_i(row);
                self.key = walked(b, self.key, row, self.steps[1]);
            }
        }
        self
    }

    /// The parameters of a function that take it over, in the order of [`Address::captures`].
    pub(super) fn declare(b: &mut Builder, tiles: bool) -> Self {
        Self {
            key: b.param("key", Type::U32),
            steps: [b.param("step_x", Type::U32), b.param("step_y", Type::U32)],
            tile: tiles.then(|| Tile {
                origin: [b.param_f32("origin_x"), b.param_f32("origin_y")],
                period: b.param_f32("period"),
            }),
        }
    }

    pub(super) fn captures(&self) -> Vec<Value> {
        let mut all = vec![self.key];
        all.extend(self.steps);
        if let Some(tile) = self.tile {
            all.extend(tile.origin);
            all.push(tile.period);
        }
        all
    }

    /// The keys of `count` lattice points of row `index` (a u32), from the column `start` (a real,
    /// relative to the cell) on.
    pub(super) fn keys(
        &self,
        b: &mut Builder,
        index: Value,
        start: Value,
        count: usize,
    ) -> Vec<Value> {
        match self.tile {
            Some(Tile { origin, period }) => {
                let row = b.float_u(index);
                let row = b.add(origin[1], row);
                let row = wrapped(b, row, period);
                let row = b.trunc_i(row);
                let key = walked(b, self.key, row, self.steps[1]);
                let start = b.add(origin[0], start);
                let keys = (0..count).map(|i| {
                    let column = b.offset(start, i as f32);
                    let column = wrapped(b, column, period);
                    let column = b.trunc_i(column);
                    walked(b, key, column, self.steps[0])
                });
                keys.collect()
            }
            None => {
                let rows = b.mul_u(index, self.steps[1]);
                let key = b.add_u(self.key, rows);
                let start = b.trunc_i(start);
                let mut keys = vec![walked(b, key, start, self.steps[0])];
                for _ in 1..count {
                    keys.push(b.add_u(keys[keys.len() - 1], self.steps[0]));
                }
                keys
            }
        }
    }
}

impl Octave<2> {
    pub(super) fn address(&self, b: &mut Builder) -> Address {
        Address::new(b, self.cells, self.seed, self.period)
    }
}
