//! Spectral noise: a sum of cosines with random phases, exact in every moment.
//!
//! For a wave w (radians per period) and q = wᵀΣw, the filtered wave is a cos(w·p + φ) e^{−q/2};
//! the ensemble variance of its k-th derivative term is a²/2 · e^{−q} qᵏ/k! (MATH §1). Wave vectors
//! are multiples of 1/1024 of a period, so that whole cells change phases by exact integers.

mod steep;
mod waves;

pub(crate) use steep::steepness;
pub(crate) use waves::{Density, FARTHEST, Spectrum};

use super::bend::localized;
use super::cell::place::{declared, field};
use super::field::{Field, Spread};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Float, FunctionRef, Int, Module, Sym2, dot};
use mipless_codegen::moments::{Mode, Signal};
use std::f32::consts::TAU;
use waves::{GRID, Wave};

/// The parts of a field.
const PARTS: [&str; 7] = ["mean", "dx", "dy", "dxx", "dxy", "dyy", "rest"];

/// The filtered noise at a position in periods; unit variance.
pub(crate) fn filtered<'b>(
    lower: &mut Lower<'_, 'b>,
    position: &[Signal<'b>],
    spectrum: &Spectrum,
) -> Field<'b> {
    let (mode, b) = (lower.mode(), lower.b());
    let spread = Spread::of(position);
    lower.source_footprint(spread.eigenvalues[0].sqrt());
    let waves = spectrum.waves();
    let key = format!("spectral {mode:?} {spectrum:?}");
    let function = lower.function(&key, |module| build(module, mode, &waves));
    let places: Vec<(Int<'b>, Float<'b>)> = position.iter().map(Signal::place).collect();
    let arguments = (places, spread.covariance);
    let sums = if mode.filters() {
        // Where even the lowest wave is damped by e⁻²⁰ nothing but the variance is left.
        let lowest = (waves.iter().map(Wave::frequency)).fold(f32::INFINITY, f32::min) * TAU;
        let damping = spread.eigenvalues[1] * (0.5 * lowest * lowest);
        let count = damping.lt(20.0).select(1u32, 0u32);
        let mut gone = vec![b.float(0.0); PARTS.len()];
        gone[6] = b.float(if mode.spreads() { 1.0 } else { 0.0 });
        b.fold(&function, count, gone, arguments)
    } else {
        b.call(&function, arguments)
    };
    field(&sums[..6], sums.get(6).copied())
}

fn build(module: &mut Module, mode: Mode, waves: &[Wave]) -> FunctionRef {
    let b = &Builder::new("spectral", "A sum of filtered cosines with random phases.");
    if mode.filters() {
        // The body of a fold of at most one turn: the state is replaced.
        b.uint_param("index");
        for name in PARTS {
            b.float_param(format!("state_{name}"));
        }
    }
    let (cells, place) = declared(b);
    let covariance = Sym2(b.float_params(["s_xx", "s_xy", "s_yy"]));
    let zero = b.float(0.0);
    let mut sums = [zero; 6];
    let mut left = Energy::none(b);
    for wave in waves {
        let turns = turns(wave, cells, place);
        let f = wave.vector.map(|n| n as f32 / GRID as f32);
        let w = f.map(|f| f * TAU);
        let [mut cosine, mut sine] = if mode == Mode::Point {
            [(turns * TAU).cos(), zero]
        } else {
            turns.circle()
        };
        let mut amplitude = wave.amplitude;
        if mode.filters() {
            // −q/2. Beyond −30 nothing is left, and squares would have no normal numbers.
            let factors = [-0.5 * w[0] * w[0], -w[0] * w[1], -0.5 * w[1] * w[1]];
            let exponent = dot(factors.map(|f| b.float(f)), *covariance).max(-30.0);
            let damped = exponent.exp() * amplitude;
            left.add(mode, damped, exponent);
            cosine *= damped;
            sine *= damped;
            amplitude = 1.0;
        }
        // Derivatives by turns: these numbers are read for the phase already.
        let parts = [
            (cosine, 1.0),
            (sine, f[0]),
            (sine, f[1]),
            (cosine, f[0] * f[0]),
            (cosine, f[0] * f[1]),
            (cosine, f[1] * f[1]),
        ];
        for (sum, (wave, factor)) in sums.iter_mut().zip(parts) {
            *sum += wave * (factor * amplitude);
        }
    }
    let [_, slopes @ .., _, _, _] = &mut sums;
    for slope in slopes {
        *slope *= -TAU;
    }
    for bend in &mut sums[3..] {
        *bend *= -TAU * TAU;
    }
    let energy: f32 = waves.iter().map(|w| 0.5 * w.amplitude * w.amplitude).sum();
    let rest = left.removed(mode, energy, sums[0], covariance);
    b.results(PARTS, sums.into_iter().chain([rest]));
    b.finish(module)
}

/// The phase of a wave in turns, in [−½, ½].
fn turns<'b>(wave: &Wave, cells: [Int<'b>; 2], place: [Float<'b>; 2]) -> Float<'b> {
    let [nx, ny] = wave.vector;
    let whole = ((cells[0] * nx + cells[1] * ny) & (GRID - 1)).to_float() * (1.0 / GRID as f32);
    let [fx, fy] = wave.vector.map(|n| n as f32 / GRID as f32);
    let turns = place[0] * fx + place[1] * fy + whole + wave.phase;
    turns - (turns + 0.5).floor()
}

/// Sums over the waves of what the filter leaves of their energies e = a² e^{−q}/2.
struct Energy<'b> {
    /// Σ 2e.
    all: Float<'b>,
    /// Σ −eq.
    first: Float<'b>,
    /// Σ eq²/2.
    second: Float<'b>,
}

/// Below this a difference of shares of a variance is rounding.
const ROUNDING: f32 = 1e-6;

impl<'b> Energy<'b> {
    fn none(b: &'b Builder) -> Self {
        let [all, first, second] = [b.float(0.0); 3];
        Self { all, first, second }
    }

    /// One more wave: its amplitude under the filter and −q/2.
    fn add(&mut self, mode: Mode, damped: Float<'b>, exponent: Float<'b>) {
        let energy = damped.square();
        self.all += energy;
        self.first += energy * exponent;
        if mode == Mode::Quad {
            self.second += energy * exponent * exponent;
        }
    }

    /// The variance that the filter removes beyond what the mode carries: Σ a²/2 − e less the terms
    /// e qᵏ/k! that it does.
    fn removed(&self, mode: Mode, whole: f32, mean: Float<'b>, covariance: Sym2<'b>) -> Float<'b> {
        let zero = self.all.literal(0.0);
        let left = self.all * 0.5;
        let lost = whole - left;
        match mode {
            Mode::Point | Mode::Naive => zero,
            Mode::Ensemble => lost.max(0.0),
            Mode::Quad => (lost + self.first - self.second + -ROUNDING).max(0.0),
            Mode::Local => {
                // Σ eq²/2 ≥ (Σ eq)²/(2 Σ e), which rounding does not reach.
                let least = self.first.square() / self.all.max(1e-6);
                let rest = (lost + self.first + -ROUNDING).max(least);
                // E[∇M ∇Mᵀ] as if directions were even, which they are until the filter takes some.
                let trace = covariance[0] + covariance[2] + 1e-20;
                let slope = -(self.first / trace);
                localized(rest, mean, left, Sym2([slope, zero, slope]), covariance)
            }
        }
    }
}
