//! From steps along the axes to the keys of lattice points in space, wrapped where the lattice
//! tiles.

use super::Kind;
use crate::noise::jenkins;
use crate::noise::sum::Octave;
use crate::noise::tile::wrapped;
use mipless_codegen::ir::{Builder, Float, Scalar, Scalars, Uint};

/// What a step along x, y and z adds to the key of a lattice point.
const STEPS: [u32; 3] = [0x9e37_79b1, 0x27d4_eb2f, 0x1656_67b1];

/// A lattice point, from which others are steps away.
#[derive(Clone, Copy, Debug)]
pub(super) struct Points<'b> {
    /// What is scrambled to its random number; with MaterialX's hash, the seed.
    pub(super) key: Uint<'b>,
    tile: Option<Tile<'b>>,
    /// Where it is, which MaterialX hashes.
    place: Option<[Uint<'b>; 3]>,
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
    pub(super) fn of(state: &Octave<'b, 3>, kind: Kind) -> Self {
        let tile = state.period.map(|period| Tile {
            origin: state.cells.map(|cell| cell.to_float()),
            period,
        });
        let zero = state.seed.literal(0);
        let mut point = Self {
            key: state.seed,
            tile,
            place: matches!(kind, Kind::Materialx(_)).then_some([zero; 3]),
        };
        if tile.is_none() {
            for (axis, cell) in state.cells.into_iter().enumerate() {
                point.step(axis, cell.to_uint());
            }
        }
        point
    }

    /// Moves it so many steps along an axis.
    fn step(&mut self, axis: usize, steps: Uint<'b>) {
        match &mut self.place {
            Some(place) => place[axis] += steps,
            None => self.key += steps * STEPS[axis],
        }
    }

    /// MaterialX's hash of the point.
    pub(super) fn hash(&self) -> Uint<'b> {
        let place = self.place.expect("points that are hashed have a place");
        jenkins::space(place, self.key)
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
        self.step(axis, place.to_int().to_uint());
        self
    }

    /// The parameters of a function that takes it over.
    pub(super) fn declare(b: &'b Builder, kind: Kind, tiles: bool) -> Self {
        let places = ["x", "y", "z"].map(|axis| format!("place_{axis}"));
        Self {
            key: b.uint_param("key"),
            tile: tiles.then(|| Tile {
                origin: ["x", "y", "z"].map(|axis| b.float_param(format!("origin_{axis}"))),
                period: b.float_param("period"),
            }),
            place: matches!(kind, Kind::Materialx(_))
                .then(|| places.map(|name| b.uint_param(name))),
        }
    }
}

impl<'b> Scalars<'b> for Points<'b> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        let tile = self.tile.map(|tile| (tile.origin, tile.period));
        (self.key, tile, self.place).each(visit);
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        let tile = self.tile.map(|tile| (tile.origin, tile.period));
        let (key, tile, place) = (self.key, tile, self.place).replaced(next);
        Self {
            key,
            place,
            tile: tile.map(|(origin, period)| Tile { origin, period }),
        }
    }
}
