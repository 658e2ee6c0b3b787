//! Spectral noise: a sum of cosines with random phases, exact in every moment.
//!
//! For a wave w (radians per period) and q = wᵀΣw, the filtered wave is a cos(w·p + φ) e^{−q/2};
//! the ensemble variance of its k-th derivative term is a²/2 · e^{−q} qᵏ/k! (MATH §1). Wave vectors
//! are multiples of 1/1024 of a period, so that whole cells change phases by exact integers.

use super::field::{Field, Spread};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::{Mode, Signal};
use std::f32::consts::TAU;

/// Wave vectors are integers over this.
const GRID: i32 = 1024;

/// The parts of a field.
const PARTS: [&str; 7] = ["mean", "dx", "dy", "dxx", "dxy", "dyy", "rest"];

/// What a spectral noise is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spectrum {
    /// How many cosines.
    pub(crate) waves: u32,
    /// The band, in octaves, around one cycle per period.
    pub(crate) bandwidth: f32,
    /// Selects directions, frequencies and phases.
    pub(crate) seed: i32,
}

/// A cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Wave {
    /// Cycles per period, times [`GRID`].
    pub(crate) vector: [i32; 2],
    /// Turns.
    pub(crate) phase: f32,
}

/// A number of [0, 1) from three integers.
fn uniform(seed: i32, wave: u32, stream: u32) -> f64 {
    let mut x = (seed as u32) ^ wave.wrapping_mul(0x9e37_79b1) ^ stream.wrapping_mul(0x85eb_ca77);
    for _ in 0..2 {
        x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
        x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
        x ^= x >> 16;
    }
    f64::from(x) / 4_294_967_296.0
}

impl Spectrum {
    /// The waves: directions stratified over the half circle, frequencies over the band (log
    /// uniform). Of eight candidates each wave is the one whose sums and differences with pairs of
    /// earlier ones stay farthest from another wave: three waves that nearly close a triangle lock
    /// their phases, and their sum is not Gaussian (MATH §2).
    pub(crate) fn waves(self) -> Vec<Wave> {
        let count = self.waves;
        let mut waves: Vec<Wave> = Vec::new();
        for i in 0..count {
            let candidate = |attempt: u32| {
                let turn = (f64::from(i) + uniform(self.seed, i, 3 * attempt)) / f64::from(count);
                // The golden ratio orders frequencies independently of directions.
                let stratum = (f64::from(i) * 0.618_033_988_749_895).fract();
                let within = uniform(self.seed, i, 3 * attempt + 1) / f64::from(count);
                let share = (stratum + within).fract();
                let frequency = (f64::from(self.bandwidth) * (share - 0.5)).exp2();
                let angle = std::f64::consts::PI * turn;
                let grid = f64::from(GRID) * frequency;
                Wave {
                    vector: [
                        (grid * angle.cos()).round() as i32,
                        (grid * angle.sin()).round() as i32,
                    ],
                    phase: uniform(self.seed, i, 3 * attempt + 2) as f32,
                }
            };
            // Beyond this many waves no triad stands out.
            let attempts = if i < 48 { 8 } else { 1 };
            let best = (0..attempts)
                .map(candidate)
                .max_by_key(|wave| nearest_triad(&waves, wave.vector))
                .expect("there are candidates");
            waves.push(best);
        }
        waves
    }
}

/// The smallest squared length of a sum ±w ± u ± v over pairs of waves.
fn nearest_triad(waves: &[Wave], w: [i32; 2]) -> i64 {
    let mut least = i64::MAX;
    for (i, u) in waves.iter().enumerate() {
        for v in &waves[..i] {
            for (p, q) in [(1, 1), (1, -1), (-1, 1), (-1, -1)] {
                let x = i64::from(w[0] + p * u.vector[0] + q * v.vector[0]);
                let y = i64::from(w[1] + p * u.vector[1] + q * v.vector[1]);
                least = least.min(x * x + y * y);
            }
        }
    }
    least
}

/// The filtered noise at a position in periods; unit variance.
pub(crate) fn filtered(lower: &mut Lower<'_>, position: &[Signal], spectrum: Spectrum) -> Field {
    let mode = lower.mode();
    let spread = Spread::of(lower.b(), position);
    let size = lower.b().sqrt(spread.eigenvalues[0]);
    lower.source_footprint(size);
    let Spectrum {
        waves,
        bandwidth,
        seed,
    } = spectrum;
    let key = format!("spectral {mode:?} {waves} {bandwidth} {seed}");
    let function = lower.function(&key, |module| build(module, mode, spectrum));
    let b = lower.b();
    let mut arguments = Vec::new();
    for axis in position {
        arguments.push(axis.cell.unwrap_or_else(|| b.i32(0)));
        arguments.push(axis.mean);
    }
    arguments.extend(spread.covariance);
    let sums = if mode.filters() {
        // Where even the lowest wave is damped by e⁻²⁰ nothing but the variance is left.
        let lowest = TAU * (-0.5 * bandwidth).exp2();
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

fn build(module: &mut Module, mode: Mode, spectrum: Spectrum) -> FunctionRef {
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
    let mut sums = [zero; 7];
    let amplitude = (2.0 / spectrum.waves as f32).sqrt();
    for wave in spectrum.waves() {
        let [nx, ny] = wave.vector;
        let (ix, iy, mask) = (b.i32(nx), b.i32(ny), b.i32(GRID - 1));
        let (cx, cy) = (b.mul_i(cell_x, ix), b.mul_i(cell_y, iy));
        let whole = b.add_i(cx, cy);
        let whole = b.and_i(whole, mask);
        let whole = b.float_i(whole);
        let whole = b.scale(whole, 1.0 / GRID as f32);
        let f = [nx as f32 / GRID as f32, ny as f32 / GRID as f32];
        let (fx, fy) = (b.f32(f[0]), b.f32(f[1]));
        let turns = b.dot(&[fx, fy], &[x, y]);
        let turns = b.add(turns, whole);
        let turns = b.offset(turns, wave.phase);
        let rounded = b.offset(turns, 0.5);
        let floor = b.floor(rounded);
        let turns = b.sub(turns, floor);
        let angle = b.scale(turns, TAU);
        let (mut cosine, mut sine) = (b.cos(angle), b.sin(angle));
        let w = f.map(|f| f * TAU);
        if mode.filters() {
            let factors = [w[0] * w[0], 2.0 * w[0] * w[1], w[1] * w[1]].map(|f| b.f32(f));
            let q = b.dot(&factors, &covariance);
            // Beyond, nothing is left, and squares would have no normal numbers.
            let q = b.clamp(q, 0.0, 60.0);
            let half = b.scale(q, -0.5);
            let damping = b.exp(half);
            cosine = b.mul(cosine, damping);
            sine = b.mul(sine, damping);
            let rest = remainder(&mut b, mode, q, damping);
            let rest = b.scale(rest, 0.5 * amplitude * amplitude);
            sums[6] = b.add(sums[6], rest);
        }
        let parts = [
            (cosine, 1.0),
            (sine, -w[0]),
            (sine, -w[1]),
            (cosine, -w[0] * w[0]),
            (cosine, -w[0] * w[1]),
            (cosine, -w[1] * w[1]),
        ];
        for (sum, (wave, factor)) in sums.iter_mut().zip(parts) {
            let part = b.scale(wave, factor * amplitude);
            *sum = b.add(*sum, part);
        }
    }
    for (name, sum) in PARTS.into_iter().zip(sums) {
        b.result(name, sum);
    }
    b.finish(module)
}

/// The share of a wave's variance that the filter removes beyond what the mode carries: 1 − e^{−q}
/// less the terms e^{−q} qᵏ/k! that it does. Below 2e-7 the difference is rounding.
fn remainder(b: &mut Builder, mode: Mode, q: Value, damping: Value) -> Value {
    let (one, zero) = (b.f32(1.0), b.f32(0.0));
    let energy = b.square(damping);
    let lost = b.sub(one, energy);
    let first = b.mul(energy, q);
    let second = b.mul(first, q);
    let second = b.scale(second, 0.5);
    match mode {
        Mode::Ensemble => lost,
        Mode::Local => {
            let left = b.sub(lost, first);
            let left = b.offset(left, -2e-7);
            b.max(left, second)
        }
        Mode::Quad => {
            let left = b.sub(lost, first);
            let left = b.sub(left, second);
            let left = b.offset(left, -2e-7);
            b.max(left, zero)
        }
        Mode::Point | Mode::Naive => zero,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_three_waves_nearly_close() {
        for seed in 0..5 {
            let waves = Spectrum {
                waves: 32,
                bandwidth: 1.0,
                seed,
            }
            .waves();
            let least = (0..32)
                .map(|i| nearest_triad(&waves[..i], waves[i].vector))
                .min();
            // A sum shorter than 0.004 cycles per period locks phases over 250 periods.
            assert!(least.is_some_and(|d| d > 16), "seed {seed}: {least:?}");
        }
    }
}
