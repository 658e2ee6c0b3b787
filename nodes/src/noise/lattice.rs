//! Lattice noise with the quadrupole kernel: a random second-order kernel at every lattice point,
//! filtered exactly by any Gaussian footprint (RULES, lattice noise).
//!
//! With T = a²I + Σ, d the offset to the lattice point, u = T⁻¹d, E = e^{−d·u/2}, θ a random angle
//! and B = [[cos θ, sin θ], [sin θ, −cos θ]]: k = uᵀBu − tr(BT⁻¹), M = Σ κ E k with
//! κ = a³/(√π √det T). The unfiltered noise has variance 1 (over random lattices).

mod address;
mod energy;
mod filtered;
mod point;
mod row;

use super::field::{Field, Spread};
use super::hash::NEXT_OCTAVE;
use address::{Address, wrapped_cell};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Type, Value};
use mipless_codegen::moments::{Mode, Signal};

/// a: the width of the kernel, in cells.
const WIDTH: f32 = 0.3854;

/// The wavelength of the dominant detail, in cells: the spectrum k⁵ e^{−a²k²} has its peak at
/// k = √2.5/a.
const WAVELENGTH: f32 = std::f32::consts::TAU * WIDTH / 1.581_138_8;

/// The most lattice rows that are summed; footprints that need more fade.
const MOST_ROWS: f32 = 32.0;

/// What a sum of octaves is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Octaves {
    /// How many, at least 1.
    pub(crate) count: u32,
    /// By how much the frequency grows.
    pub(crate) lacunarity: f32,
    /// By how much the amplitude falls.
    pub(crate) diminish: f32,
    /// Selects the lattice.
    pub(crate) seed: i32,
    /// After how many cells of the first octave the lattice repeats; 0 if it does not.
    pub(crate) period: u32,
}

impl Octaves {
    /// Whether the lattice repeats.
    fn tiles(self) -> bool {
        self.period > 0
    }

    /// The standard deviation of the sum.
    pub(crate) fn sd(self) -> f32 {
        (0..self.count as i32)
            .map(|k| self.diminish.powi(2 * k))
            .sum::<f32>()
            .sqrt()
    }
}

/// The filtered sum of octaves at a position in cells of the first octave; unit variance of the
/// first octave.
pub(crate) fn filtered(lower: &mut Lower<'_>, position: &[Signal], octaves: Octaves) -> Field {
    let mode = lower.mode();
    let spread = Spread::of(lower.b(), position);
    let b = lower.b();
    let size = b.sqrt(spread.eigenvalues[0]);
    // The first octave dominates: it decides what the footprint is to the source.
    let wavelengths = lower.b().scale(size, 1.0 / WAVELENGTH);
    lower.source_footprint(wavelengths);
    let Octaves {
        lacunarity,
        diminish,
        ..
    } = octaves;
    let key = format!(
        "lattice {mode:?} {lacunarity} {diminish} {}",
        octaves.tiles()
    );
    let octave = lower.function(&key, |module| match mode {
        Mode::Point => point::octave(module, octaves),
        _ => filtered::octave(module, mode, octaves),
    });
    let b = lower.b();
    let derivatives = filtered::derivatives(mode);
    let parts = (derivatives + 1) * (derivatives + 2) / 2;
    let mut init = vec![b.f32(0.0); parts + usize::from(mode.spreads())];
    for axis in position {
        // The lattice needs a cell and a fraction, whatever the position carries.
        let (cell, fraction) = match axis.cell {
            Some(cell) => (cell, axis.mean),
            None => {
                let whole = b.floor(axis.mean);
                let fraction = b.sub(axis.mean, whole);
                (b.trunc_i(whole), fraction)
            }
        };
        init.push(cell);
        init.push(fraction);
    }
    let seed = b.u32(octaves.seed as u32);
    let seed = b.scramble(seed);
    init.extend([b.f32(1.0), b.f32(1.0), seed]);
    if octaves.tiles() {
        init.push(b.f32(octaves.period as f32));
    }
    let mut captures = Vec::new();
    if mode != Mode::Point {
        captures.extend(spread.covariance);
        let [major, minor] = spread
            .eigenvalues
            .map(|s| b.scale(s, 1.0 / (WIDTH * WIDTH)));
        captures.extend([b.add(major, minor), b.mul(major, minor)]);
    }
    let count = b.u32(octaves.count);
    let sums = b.fold(&octave, count, &init, &captures);
    let zero = b.f32(0.0);
    let at = |i: usize| if i < parts { sums[i] } else { zero };
    Field {
        mean: at(0),
        gradient: [at(1), at(2)],
        hessian: [at(3), at(4), at(5)],
        rest: if mode.spreads() { sums[parts] } else { zero },
    }
}

/// The part of an octave's state that goes from octave to octave: position, frequency, amplitude
/// and seed.
struct Octave {
    cells: [Value; 2],
    fractions: [Value; 2],
    scale: Value,
    amplitude: Value,
    seed: Value,
    /// In cells of this octave.
    period: Option<Value>,
}

impl Octave {
    fn declare(b: &mut Builder, octaves: Octaves) -> Self {
        let cell_x = b.param("cell_x", Type::I32);
        let x = b.param_f32("x");
        let cell_y = b.param("cell_y", Type::I32);
        let y = b.param_f32("y");
        let mut state = Self {
            cells: [cell_x, cell_y],
            fractions: [x, y],
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

    fn address(&self, b: &mut Builder) -> Address {
        Address::new(b, self.cells, self.seed, self.period)
    }

    /// The state of the next octave, as results.
    fn advance(&self, b: &mut Builder, octaves: Octaves) {
        let lacunarity = b.f32(octaves.lacunarity);
        // Octaves must not share lattice points, where the variance of all is largest.
        let shift = b.f32(0.381_966);
        for (i, name) in ["x", "y"].iter().enumerate() {
            let start = Signal::certain(b, self.fractions[i]);
            let start = Signal {
                cell: Some(self.cells[i]),
                ..start
            };
            let next = start.scale(b, lacunarity).offset(b, shift);
            b.result(
                format!("cell_{name}"),
                next.cell.expect("a position keeps its cell"),
            );
            b.result(*name, next.mean);
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
