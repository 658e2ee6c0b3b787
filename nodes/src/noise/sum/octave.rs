//! The part of an octave's state that goes from octave to octave.

use super::Octaves;
use crate::noise::components::Hash;
use crate::noise::hash::NEXT_OCTAVE;
use crate::noise::tile::wrapped_cell;
use mipless_codegen::ir::{Builder, Float, Int, Scalar, Scalars, Uint};
use mipless_codegen::moments::Signal;
use std::array;

/// Position (of as many axes), frequency, amplitude and seed.
#[derive(Clone, Copy, Debug)]
pub(in crate::noise) struct Octave<'b, const AXES: usize> {
    pub(in crate::noise) cells: [Int<'b>; AXES],
    pub(in crate::noise) fractions: [Float<'b>; AXES],
    pub(in crate::noise) scale: Float<'b>,
    pub(in crate::noise) amplitude: Float<'b>,
    pub(in crate::noise) seed: Uint<'b>,
    /// In cells of this octave, a real.
    pub(in crate::noise) period: Option<Float<'b>>,
    /// By what it is multiplied along the second axis.
    pub(in crate::noise) ratio: f32,
}

const NAMES: [&str; 3] = ["x", "y", "z"];

/// The period along an axis.
pub(in crate::noise) fn along<'b>(axis: usize, period: Float<'b>, ratio: f32) -> Float<'b> {
    if axis == 1 && ratio != 1.0 {
        // Whole cells, whatever the quotient is rounded to.
        (period * ratio + 0.5).floor()
    } else {
        period
    }
}

impl<'b, const AXES: usize> Octave<'b, AXES> {
    /// The first octave at a position in cells of it.
    pub(in crate::noise) fn first(
        position: &[Signal<'b>],
        seed: Uint<'b>,
        octaves: Octaves,
    ) -> Self {
        let b = seed.builder();
        let places: [(Int<'b>, Float<'b>); AXES] = array::from_fn(|axis| position[axis].place());
        Self {
            cells: places.map(|(cell, _)| cell),
            fractions: places.map(|(_, fraction)| fraction),
            scale: b.float(1.0),
            amplitude: b.float(1.0),
            seed,
            period: octaves.tiles().then(|| b.float(octaves.period as f32)),
            ratio: octaves.ratio,
        }
    }

    /// The parameters of a function that takes it over.
    pub(in crate::noise) fn declare(b: &'b Builder, octaves: Octaves) -> Self {
        let places: [(Int<'b>, Float<'b>); AXES] = array::from_fn(|axis| {
            let name = NAMES[axis];
            (b.int_param(format!("cell_{name}")), b.float_param(name))
        });
        let mut state = Self {
            cells: places.map(|(cell, _)| cell),
            fractions: places.map(|(_, fraction)| fraction),
            scale: b.float_param("scale"),
            amplitude: b.float_param("amplitude"),
            seed: b.uint_param("seed"),
            period: octaves.tiles().then(|| b.float_param("period")),
            ratio: octaves.ratio,
        };
        if let Some(period) = state.period {
            // What repeats must be the same numbers from here on.
            for (axis, cell) in state.cells.iter_mut().enumerate() {
                let period = along(axis, period, octaves.ratio);
                *cell = wrapped_cell(*cell, period).to_int();
            }
        }
        state
    }

    /// The state of the next octave, as results.
    pub(in crate::noise) fn advance(&self, b: &'b Builder, octaves: Octaves) {
        let Octaves {
            lacunarity,
            diminish,
            ..
        } = octaves;
        for axis in 0..AXES {
            // Octaves must not share lattice points, where the variance of all is largest; those of
            // MaterialX do.
            let fraction = match octaves.hash {
                Hash::Mipless => self.fractions[axis] + 0.381_966 / lacunarity,
                Hash::Materialx => self.fractions[axis],
            };
            let start = Signal {
                cell: Some(self.cells[axis]),
                ..Signal::certain(fraction)
            };
            let (cell, fraction) = (start * lacunarity).place();
            b.result(format!("cell_{}", NAMES[axis]), cell);
            b.result(NAMES[axis], fraction);
        }
        b.result("scale", self.scale * lacunarity);
        b.result("amplitude", self.amplitude * diminish);
        let seed = match octaves.hash {
            Hash::Mipless => self.seed + NEXT_OCTAVE,
            Hash::Materialx => self.seed,
        };
        b.result("seed", seed);
        if let Some(period) = self.period {
            b.result("period", (period * lacunarity + 0.5).floor());
        }
    }
}

impl<'b, const AXES: usize> Scalars<'b> for Octave<'b, AXES> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        for axis in 0..AXES {
            (self.cells[axis], self.fractions[axis]).each(visit);
        }
        (self.scale, self.amplitude, self.seed, self.period).each(visit);
    }

    fn replaced(mut self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        for axis in 0..AXES {
            let place = (self.cells[axis], self.fractions[axis]);
            (self.cells[axis], self.fractions[axis]) = place.replaced(next);
        }
        let rest = (self.scale, self.amplitude, self.seed, self.period);
        (self.scale, self.amplitude, self.seed, self.period) = rest.replaced(next);
        self
    }
}
