//! From steps along the axes to the keys of lattice points in space, wrapped where the lattice
//! tiles.

use crate::noise::sum::Octave;
use crate::noise::tile::wrapped;
use mipless_codegen::ir::{Builder, Float, Scalar, Scalars, Uint};

/// What a step along x, y and z adds to the key of a lattice point.
const STEPS: [u32; 3] = [0x9e37_79b1, 0x27d4_eb2f, 0x1656_67b1];

/// A lattice point, from which others are steps away.
#[derive(Clone, Copy, Debug)]
pub(super) struct Points<'b> {
    pub(super) key: Uint<'b>,
    tile: Option<Tile<'b>>,
}

/// A lattice that repeats: the key holds the axes alone along which a step was taken.
#[derive(Clone, Copy, Debug)]
struct Tile<'b> {
    /// Where steps are counted from, in cells of the period, as reals.
    origin: [Float<'b>; 3],
    period: Float<'b>,
}

impl<'b> Points<'b> {
    /// The lattice point at the position's cell.
    pub(super) fn of(state: &Octave<'b, 3>) -> Self {
        let tile = state.period.map(|period| Tile {
            origin: state.cells.map(|cell| cell.to_float()),
            period,
        });
        let mut key = state.seed;
        if tile.is_none() {
            for (cell, step) in state.cells.into_iter().zip(STEPS) {
                key += cell.to_uint() * step;
            }
        }
        Self { key, tile }
    }

    /// Counted from `offset` (an integer as a real) steps further along an axis; a step along it
    /// must follow.
    pub(super) fn moved(mut self, axis: usize, offset: Float<'b>) -> Self {
        match &mut self.tile {
            Some(tile) => tile.origin[axis] += offset,
            None => self = self.stepped(axis, offset),
        }
        self
    }

    /// After `offset` (an integer as a real) steps along an axis, the last ones along it.
    pub(super) fn stepped(mut self, axis: usize, offset: Float<'b>) -> Self {
        let place = match self.tile {
            Some(Tile { origin, period }) => wrapped(origin[axis] + offset, period),
            None => offset,
        };
        self.key += place.to_int().to_uint() * STEPS[axis];
        self
    }

    /// The parameters of a function that takes it over.
    pub(super) fn declare(b: &'b Builder, tiles: bool) -> Self {
        Self {
            key: b.uint_param("key"),
            tile: tiles.then(|| Tile {
                origin: ["x", "y", "z"].map(|axis| b.float_param(format!("origin_{axis}"))),
                period: b.float_param("period"),
            }),
        }
    }
}

impl<'b> Scalars<'b> for Points<'b> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        let tile = self.tile.map(|tile| (tile.origin, tile.period));
        (self.key, tile).each(visit);
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        let tile = self.tile.map(|tile| (tile.origin, tile.period));
        let (key, tile) = (self.key, tile).replaced(next);
        Self {
            key,
            tile: tile.map(|(origin, period)| Tile { origin, period }),
        }
    }
}
