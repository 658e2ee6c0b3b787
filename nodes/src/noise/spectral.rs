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
    let mut sums = [zero; 7];
    // E[M²] and E[∇M ∇Mᵀ].
    let (mut left, mut slopes) = (zero, [zero; 3]);
    for wave in waves {
        let amplitude = wave.amplitude;
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
            let power = 0.5 * amplitude * amplitude;
            let rest = b.scale(rest, power);
            sums[6] = b.add(sums[6], rest);
            if mode == Mode::Local {
                let energy = b.square(damping);
                let energy = b.scale(energy, power);
                left = b.add(left, energy);
                for (sum, factor) in
                    (slopes.iter_mut()).zip([w[0] * w[0], w[0] * w[1], w[1] * w[1]])
                {
                    let slope = b.scale(energy, factor);
                    *sum = b.add(*sum, slope);
                }
            }
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
    if mode == Mode::Local {
        sums[6] = localized(&mut b, sums[6], sums[0], left, slopes, covariance);
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
