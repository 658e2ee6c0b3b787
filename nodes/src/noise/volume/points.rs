//! From steps along the axes to the keys of lattice points in space, wrapped where the lattice
//! tiles.

use crate::noise::octave::Octave;
use crate::noise::tile::wrapped;
use mipless_codegen::ir::{Builder, Type, Value};

/// What a step along x, y and z adds to the key of a lattice point.
const STEPS: [u32; 3] = [0x9e37_79b1, 0x27d4_eb2f, 0x1656_67b1];

/// A lattice point, from which others are steps away.
#[derive(Clone, Copy, Debug)]
pub(super) struct Points {
    pub(super) key: Value,
    tile: Option<Tile>,
}

/// A lattice that repeats: the key holds the axes alone along which a step was taken.
#[derive(Clone, Copy, Debug)]
struct Tile {
    /// Where steps are counted from, in cells of the period, as reals.
    origin: [Value; 3],
    period: Value,
}

impl Points {
    /// The lattice point at the position's cell.
    pub(super) fn of(b: &mut Builder, state: &Octave<3>) -> Self {
        if let Some(period) = state.period {
            let origin = state.cells.map(|cell| b.float_i(cell));
            return Self {
                key: state.seed,
                tile: Some(Tile { origin, period }),
            };
        }
        let mut key = state.seed;
        for (cell, step) in state.cells.into_iter().zip(STEPS) {
            let cell = b.cast_u(cell);
            key = walked(b, key, cell, step);
        }
        Self { key, tile: None }
    }

    /// Counted from `offset` (an integer as a real) steps further along an axis; a step along it
    /// must follow.
    pub(super) fn moved(mut self, b: &mut Builder, axis: usize, offset: Value) -> Self {
        match &mut self.tile {
            Some(tile) => tile.origin[axis] = b.add(tile.origin[axis], offset),
            None => self = self.stepped(b, axis, offset),
        }
        self
    }

    /// After `offset` (an integer as a real) steps along an axis, the last ones along it.
    pub(super) fn stepped(mut self, b: &mut Builder, axis: usize, offset: Value) -> Self {
        let place = match self.tile {
            Some(Tile { origin, period }) => {
                let place = b.add(origin[axis], offset);
                wrapped(b, place, period)
            }
            None => offset,
        };
        let place = b.trunc_i(place);
        let place = b.cast_u(place);
        self.key = walked(b, self.key, place, STEPS[axis]);
        self
    }

    /// The parameters of a function that takes it over, in the order of [`Points::captures`].
    pub(super) fn declare(b: &mut Builder, tiles: bool) -> Self {
        Self {
            key: b.param("key", Type::U32),
            tile: tiles.then(|| Tile {
                origin: ["x", "y", "z"].map(|axis| b.param_f32(format!("origin_{axis}"))),
                period: b.param_f32("period"),
            }),
        }
    }

    pub(super) fn captures(&self) -> Vec<Value> {
        let mut all = vec![self.key];
        if let Some(Tile { origin, period }) = self.tile {
            all.extend(origin);
            all.push(period);
        }
        all
    }
}

fn walked(b: &mut Builder, key: Value, cells: Value, step: u32) -> Value {
    let step = b.u32(step);
    let walked = b.mul_u(cells, step);
    b.add_u(key, walked)
}
