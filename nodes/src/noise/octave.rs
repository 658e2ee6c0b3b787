//! The part of an octave's state that goes from octave to octave.

use super::hash::NEXT_OCTAVE;
use super::sum::Octaves;
use super::tile::wrapped_cell;
use mipless_codegen::ir::{Builder, Type, Value};
use mipless_codegen::moments::Signal;

/// Position (of as many axes), frequency, amplitude and seed.
pub(super) struct Octave<const AXES: usize> {
    pub(super) cells: [Value; AXES],
    pub(super) fractions: [Value; AXES],
    pub(super) scale: Value,
    pub(super) amplitude: Value,
    pub(super) seed: Value,
    /// In cells of this octave, a real.
    pub(super) period: Option<Value>,
}

const NAMES: [&str; 3] = ["x", "y", "z"];

impl<const AXES: usize> Octave<AXES> {
    pub(super) fn declare(b: &mut Builder, octaves: Octaves) -> Self {
        let places: [_; AXES] = std::array::from_fn(|axis| {
            let name = NAMES[axis];
            let cell = b.param(format!("cell_{name}"), Type::I32);
            (cell, b.param_f32(name))
        });
        let mut state = Self {
            cells: places.map(|(cell, _)| cell),
            fractions: places.map(|(_, fraction)| fraction),
            scale: b.param_f32("scale"),
            amplitude: b.param_f32("amplitude"),
            seed: b.param("seed", Type::U32),
            period: octaves.tiles().then(|| b.param_f32("period")),
        };
        if let Some(period) = state.period {
            // What repeats must be the same numbers from here on.
            state.cells = state.cells.map(|cell| {
                let cell = wrapped_cell(b, cell, period);
                b.trunc_i(cell)
            });
        }
        state
    }

    /// The state of the next octave, as results.
    pub(super) fn advance(&self, b: &mut Builder, octaves: Octaves) {
        let lacunarity = b.f32(octaves.lacunarity);
        for (i, name) in NAMES[..AXES].iter().copied().enumerate() {
            // Octaves must not share lattice points, where the variance of all is largest.
            let shifted = b.offset(self.fractions[i], 0.381_966 / octaves.lacunarity);
            let start = Signal {
                cell: Some(self.cells[i]),
                ..Signal::certain(b, shifted)
            };
            let next = start.scale(b, lacunarity);
            let cell = next.cell.expect("a position keeps its cell");
            b.result(format!("cell_{name}"), cell);
            b.result(name, next.mean);
        }
        let scale = b.scale(self.scale, octaves.lacunarity);
        let amplitude = b.scale(self.amplitude, octaves.diminish);
        let step = b.u32(NEXT_OCTAVE);
        let seed = b.add_u(self.seed, step);
        b.result("scale", scale);
        b.result("amplitude", amplitude);
        b.result("seed", seed);
        if let Some(period) = self.period {
            let next = b.scale(period, octaves.lacunarity);
            let next = b.offset(next, 0.5);
            let next = b.floor(next);
            b.result("period", next);
        }
    }
}
