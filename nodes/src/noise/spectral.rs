//! Spectral noise: a sum of cosines with random phases, exact in every moment.
//!
//! For a wave w (radians per period) and q = wᵀΣw, the filtered wave is a cos(w·p + φ) e^{−q/2};
//! the ensemble variance of its k-th derivative term is a²/2 · e^{−q} qᵏ/k! (MATH §1). Wave vectors
//! are multiples of 1/1024 of a period, so that whole cells change phases by exact integers.

mod waves;

pub(crate) use waves::{Density, FARTHEST, Spectrum};

use super::bend::localized;
use super::field::{Field, Spread};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::{Mode, Signal};
use std::f32::consts::TAU;
use waves::{GRID, Wave};

/// The parts of a field.
const PARTS: [&str; 7] = ["mean", "dx", "dy", "dxx", "dxy", "dyy", "rest"];

/// The filtered noise at a position in periods; unit variance.
pub(crate) fn filtered(lower: &mut Lower<'_>, position: &[Signal], spectrum: &Spectrum) -> Field {
    let mode = lower.mode();
    let spread = Spread::of(lower.b(), position);
    let size = lower.b().sqrt(spread.eigenvalues[0]);
    lower.source_footprint(size);
    let waves = spectrum.waves();
    let key = format!("spectral {mode:?} {spectrum:?}");
    let function = lower.function(&key, |module| build(module, mode, &waves));
    let b = lower.b();
    let mut arguments = Vec::new();
    for axis in position {
        arguments.push(axis.cell.unwrap_or_else(|| b.i32(0)));
        arguments.push(axis.mean);
    }
    arguments.extend(spread.covariance);
    let sums = if mode.filters() {
        // Where even the lowest wave is damped by e⁻²⁰ nothing but the variance is left.
        let lowest = (waves.iter().map(Wave::frequency)).fold(f32::INFINITY, f32::min) * TAU;
        let damping = b.scale(spread.eigenvalues[1], 0.5 * lowest * lowest);
        let (limit, none, once) = (b.f32(20.0), b.u32(0), b.u32(1));
        let is_left = b.lt(damping, limit);
        let count = b.select(is_left, once, none);
        let (zero, one) = (b.f32(0.0), b.f32(1.0));
        let rest = if mode.spreads() { one } else { zero };
        b.fold(
            &function,
            count,
            &[zero, zero, zero, zero, zero, zero, rest],
            &arguments,
        )
    } else {
        b.call(&function, &arguments)
    };
    let [mean, dx, dy, dxx, dxy, dyy, rest] = sums[..] else {
        panic!("a field has seven parts")
    };
    Field {
        mean,
        gradient: [dx, dy],
        hessian: [dxx, dxy, dyy],
        rest,
    }
}

fn build(module: &mut Module, mode: Mode, waves: &[Wave]) -> FunctionRef {
    let mut b = Builder::new("spectral", "A sum of filtered cosines with random phases.");
    if mode.filters() {
        // The body of a fold of at most one turn: the state is replaced.
        b.param("index", Type::U32);
        for name in PARTS {
            b.param_f32(format!("state_{name}"));
        }
    }
    let cell_x = b.param("cell_x", Type::I32);
    let x = b.param_f32("x");
    let cell_y = b.param("cell_y", Type::I32);
    let y = b.param_f32("y");
    let covariance = [
        b.param_f32("s_xx"),
        b.param_f32("s_xy"),
        b.param_f32("s_yy"),
    ];
    let zero = b.f32(0.0);
    let mut sums = [zero; 6];
    let mut left = Energy::none(&mut b);
    for wave in waves {
        let turns = turns(&mut b, wave, [cell_x, cell_y], [x, y]);
        let f = wave.vector.map(|n| n as f32 / GRID as f32);
        let w = f.map(|f| f * TAU);
        let [mut cosine, mut sine] = if mode == Mode::Point {
            let angle = b.scale(turns, TAU);
            [b.cos(angle), zero]
        } else {
            b.circle(turns)
        };
        let mut amplitude = wave.amplitude;
        if mode.filters() {
            // −q/2. Beyond −30 nothing is left, and squares would have no normal numbers.
            let factors = [-0.5 * w[0] * w[0], -w[0] * w[1], -0.5 * w[1] * w[1]];
            let factors = factors.map(|f| b.f32(f));
            let exponent = b.dot(&factors, &covariance);
            let least = b.f32(-30.0);
            let exponent = b.max(exponent, least);
            let damping = b.exp(exponent);
            let damped = b.scale(damping, amplitude);
            left.add(&mut b, mode, damped, exponent);
            cosine = b.mul(cosine, damped);
            sine = b.mul(sine, damped);
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
            let part = b.scale(wave, factor * amplitude);
            *sum = b.add(*sum, part);
        }
    }
    for (sum, factor) in sums[1..]
        .iter_mut()
        .zip([-TAU, -TAU, -TAU * TAU, -TAU * TAU, -TAU * TAU])
    {
        *sum = b.scale(*sum, factor);
    }
    let energy: f32 = waves.iter().map(|w| 0.5 * w.amplitude * w.amplitude).sum();
    let rest = left.removed(&mut b, mode, energy, sums[0], covariance);
    for (name, sum) in PARTS.into_iter().zip(sums.into_iter().chain([rest])) {
        b.result(name, sum);
    }
    b.finish(module)
}

/// The phase of a wave in turns, in [−½, ½].
fn turns(b: &mut Builder, wave: &Wave, [cell_x, cell_y]: [Value; 2], place: [Value; 2]) -> Value {
    let [nx, ny] = wave.vector;
    let (ix, iy, mask) = (b.i32(nx), b.i32(ny), b.i32(GRID - 1));
    let (cx, cy) = (b.mul_i(cell_x, ix), b.mul_i(cell_y, iy));
    let whole = b.add_i(cx, cy);
    let whole = b.and_i(whole, mask);
    let whole = b.float_i(whole);
    let whole = b.scale(whole, 1.0 / GRID as f32);
    let f = [nx, ny].map(|n| b.f32(n as f32 / GRID as f32));
    let turns = b.dot(&f, &place);
    let turns = b.add(turns, whole);
    let turns = b.offset(turns, wave.phase);
    let rounded = b.offset(turns, 0.5);
    let floor = b.floor(rounded);
    b.sub(turns, floor)
}

/// Sums over the waves of what the filter leaves of their energies e = a² e^{−q}/2.
struct Energy {
    /// Σ 2e.
    all: Value,
    /// Σ −eq.
    first: Value,
    /// Σ eq²/2.
    second: Value,
}

/// Below this a difference of shares of a variance is rounding.
const ROUNDING: f32 = 1e-6;

impl Energy {
    fn none(b: &mut Builder) -> Self {
        let zero = b.f32(0.0);
        Self {
            all: zero,
            first: zero,
            second: zero,
        }
    }

    /// One more wave: its amplitude under the filter and −q/2.
    fn add(&mut self, b: &mut Builder, mode: Mode, damped: Value, exponent: Value) {
        let energy = b.square(damped);
        self.all = b.add(self.all, energy);
        let part = b.mul(energy, exponent);
        self.first = b.add(self.first, part);
        if mode == Mode::Quad {
            let part = b.mul(part, exponent);
            self.second = b.add(self.second, part);
        }
    }

    /// The variance that the filter removes beyond what the mode carries: Σ a²/2 − e less the terms
    /// e qᵏ/k! that it does.
    fn removed(
        &self,
        b: &mut Builder,
        mode: Mode,
        whole: f32,
        mean: Value,
        covariance: [Value; 3],
    ) -> Value {
        let (zero, whole) = (b.f32(0.0), b.f32(whole));
        let left = b.scale(self.all, 0.5);
        let lost = b.sub(whole, left);
        match mode {
            Mode::Point | Mode::Naive => zero,
            Mode::Ensemble => b.max(lost, zero),
            Mode::Quad => {
                let lost = b.add(lost, self.first);
                let lost = b.sub(lost, self.second);
                let lost = b.offset(lost, -ROUNDING);
                b.max(lost, zero)
            }
            Mode::Local => {
                let lost = b.add(lost, self.first);
                let lost = b.offset(lost, -ROUNDING);
                // Σ eq²/2 ≥ (Σ eq)²/(2 Σ e), which rounding does not reach.
                let tiny = b.f32(1e-6);
                let divisor = b.max(self.all, tiny);
                let square = b.square(self.first);
                let least = b.div(square, divisor);
                let rest = b.max(lost, least);
                // E[∇M ∇Mᵀ] as if directions were even, which they are until the filter takes some.
                let [xx, xy, yy] = covariance;
                let trace = b.add(xx, yy);
                let trace = b.offset(trace, 1e-20);
                let slope = b.div(self.first, trace);
                let slope = b.neg(slope);
                localized(b, rest, mean, left, [slope, zero, slope], [xx, xy, yy])
            }
        }
    }
}
