//! The phase of a complex Gabor field, as a signal.
//!
//! Over a footprint the field Z turns at the rate of its filtered phase, ∇φ = Im(∇m/m), and is
//! otherwise a complex Gaussian around a mean: Z = e^{i∇φ·δ} Y. With q = ∇φᵀΣ∇φ the mean of Y is
//! |m| e^{q/2}, and its variance 2σ² is what E|Z|² holds beyond. For a noncentral complex Gaussian
//! with s = |E Y|²/2σ² (Gudbjartsson & Patz 1995; Abramowitz & Stegun 11.4.28)
//!
//! ```text
//! E[e^{i arg Y}] = √(πs)/2 · e^{−s/2} (I₀(s/2) + I₁(s/2)) = R(s)
//! ```
//!
//! so the phase is taken for a wrapped normal of variance q − 2 ln R(s): exact in the first harmonic
//! of what follows, and in all of them for large s.

use super::field::{Field, Spread};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Value};
use mipless_codegen::moments::{Mode, Signal};
use std::f32::consts::{PI, TAU};

/// atan on [0, 1], an odd polynomial: within 2.5e-7.
const ATAN: [f32; 7] = [
    0.999_996_1,
    -0.333_173_66,
    0.198_077_97,
    -0.132_332_7,
    0.079_622_31,
    -0.033_603_01,
    0.006_811_383,
];

/// −2 ln R(s) = ln(1 + c(s)/s), c = (4/π + 0.2169 s + 0.1507 s²/2)/(1 + 0.4454 s + 0.1507 s²): R is
/// within 4e-4.
const RATIONAL: [f32; 3] = [0.216_890_28, 0.150_680_1, 0.445_370_07];

/// The angle of (x, y), in radians; 0 at the origin.
fn angle(b: &mut Builder, x: Value, y: Value) -> Value {
    let zero = b.f32(0.0);
    let (ax, ay) = (b.abs(x), b.abs(y));
    let (high, low) = (b.max(ax, ay), b.min(ax, ay));
    let tiny = b.f32(1e-30);
    let high = b.max(high, tiny);
    let ratio = b.div(low, high);
    let square = b.square(ratio);
    let mut sum = b.f32(0.0);
    for coefficient in ATAN.into_iter().rev() {
        sum = b.mul(sum, square);
        sum = b.offset(sum, coefficient);
    }
    let first = b.mul(sum, ratio);
    let (quarter, half) = (b.f32(0.5 * PI), b.f32(PI));
    let other = b.sub(quarter, first);
    let steep = b.lt(ax, ay);
    let first = b.select(steep, other, first);
    let other = b.sub(half, first);
    let left = b.lt(x, zero);
    let first = b.select(left, other, first);
    let other = b.neg(first);
    let below = b.lt(y, zero);
    b.select(below, other, first)
}

/// vᵀΣv.
fn form(b: &mut Builder, v: [Value; 2], s: [Value; 3]) -> Value {
    let left = b.dot(&[s[0], s[1]], &v);
    let right = b.dot(&[s[1], s[2]], &v);
    b.dot(&v, &[left, right])
}

/// ½ tr (HΣ)².
fn second(b: &mut Builder, h: [Value; 3], s: [Value; 3]) -> Value {
    let xx = b.dot(&[h[0], h[1]], &[s[0], s[1]]);
    let xy = b.dot(&[h[0], h[1]], &[s[1], s[2]]);
    let yx = b.dot(&[h[1], h[2]], &[s[0], s[1]]);
    let yy = b.dot(&[h[1], h[2]], &[s[1], s[2]]);
    let squares = b.dot(&[xx, yy], &[xx, yy]);
    let half = b.scale(squares, 0.5);
    let cross = b.mul(xy, yx);
    b.add(half, cross)
}

/// −2 ln R(s) with s = power/variance.
fn scatter(b: &mut Builder, power: Value, variance: Value) -> Value {
    let s = b.div(power, variance);
    let least = b.f32(1e-30);
    let s = b.max(s, least);
    let bend = b.scale(s, 0.5 * RATIONAL[1]);
    let numerator = b.offset(bend, RATIONAL[0]);
    let numerator = b.mul(numerator, s);
    let numerator = b.offset(numerator, 4.0 / PI);
    let bend = b.scale(s, RATIONAL[1]);
    let denominator = b.offset(bend, RATIONAL[2]);
    let denominator = b.mul(denominator, s);
    let denominator = b.offset(denominator, 1.0);
    let c = b.div(numerator, denominator);
    let x = b.div(c, s);
    // ln(1 + x) of a small x is x − x²/2.
    let raised = b.offset(x, 1.0);
    let log = b.ln(raised);
    let square = b.square(x);
    let half = b.scale(square, 0.5);
    let small = b.sub(x, half);
    let limit = b.f32(1e-3);
    let near = b.lt(x, limit);
    b.select(near, small, log)
}

/// The phase in turns at a position, given the real and the imaginary field.
pub(crate) fn phase(lower: &mut Lower<'_>, re: &Field, im: &Field, position: &[Signal]) -> Signal {
    let mode = lower.mode();
    let spread = Spread::of(lower.b(), position);
    let s = spread.covariance;
    let b = lower.b();
    let zero = b.f32(0.0);
    let turns = angle(b, re.mean, im.mean);
    let mut field = Field {
        mean: b.scale(turns, 1.0 / TAU),
        gradient: [zero; 2],
        hessian: [zero; 3],
        rest: zero,
    };
    if mode.spreads() {
        let power = b.dot(&[re.mean, im.mean], &[re.mean, im.mean]);
        let tiny = b.f32(1e-12);
        let guarded = b.max(power, tiny);
        let one = b.f32(1.0);
        let inverse = b.div(one, guarded);
        // ∇φ, and ∇|m|²/2|m|.
        let mut turning = [zero; 2];
        let mut growing = [zero; 2];
        for i in 0..2 {
            let (p, q) = (re.gradient[i], im.gradient[i]);
            let (left, right) = (b.mul(re.mean, q), b.mul(im.mean, p));
            let across = b.sub(left, right);
            turning[i] = b.mul(across, inverse);
            let along = b.dot(&[re.mean, im.mean], &[p, q]);
            let root = b.sqrt(inverse);
            growing[i] = b.mul(along, root);
        }
        let q = form(b, turning, s);
        let limit = b.f32(30.0);
        let q = b.min(q, limit);
        // 2σ² = E|Z|² − |m|² e^q, of which |m|² (1 + q) is the mean and the turning.
        let radial = form(b, growing, s);
        let mut rest = b.add(re.rest, im.rest);
        rest = b.add(rest, radial);
        if mode == Mode::Quad {
            for h in [re.hessian, im.hessian] {
                let part = second(b, h, s);
                rest = b.add(rest, part);
            }
        }
        let grown = b.exp(q);
        let beyond = b.sub(grown, one);
        let beyond = b.sub(beyond, q);
        let square = b.square(q);
        let third = b.scale(q, 1.0 / 3.0);
        let third = b.offset(third, 1.0);
        let series = b.mul(square, third);
        let series = b.scale(series, 0.5);
        let small = b.f32(0.05);
        let near = b.lt(q, small);
        let beyond = b.select(near, series, beyond);
        let beyond = b.mul(beyond, power);
        let variance = b.sub(rest, beyond);
        let variance = b.max(variance, zero);
        let coherent = b.mul(power, grown);
        let slopes = b.mul(power, q);
        let total = b.add(power, slopes);
        let total = b.add(total, rest);
        let coherent = b.min(coherent, total);
        let floor = b.scale(coherent, 1e-8);
        let variance = b.add(variance, floor);
        let variance = b.offset(variance, 1e-30);
        let scattered = scatter(b, coherent, variance);
        field.rest = b.scale(scattered, 1.0 / (TAU * TAU));
        field.gradient = turning.map(|t| b.scale(t, 1.0 / TAU));
    }
    field.at(lower, position)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mipless_codegen::cpu::{Evaluator, Input, Scratch};
    use mipless_codegen::ir::Module;

    fn evaluated(build: impl Fn(&mut Builder, Value, Value) -> Value, x: f32, y: f32) -> f64 {
        let mut b = Builder::new("f", "A test.");
        let (p, q) = (b.param_f32("x"), b.param_f32("y"));
        let out = build(&mut b, p, q);
        b.result("out", out);
        let mut module = Module::default();
        b.finish(&mut module);
        let mut outputs = Vec::new();
        let inputs = [Input::Float(x), Input::Float(y)];
        Evaluator::<f64>::new(&module).evaluate(&mut Scratch::new(), &inputs, 1, &mut outputs);
        outputs[0][0]
    }

    #[test]
    fn angles_are_those_of_atan2() {
        for i in 0..200 {
            let turn = f64::from(i) * 0.0317 - 3.1;
            let (y, x) = turn.sin_cos();
            let (x, y) = ((2.5 * x) as f32, (2.5 * y) as f32);
            let found = evaluated(angle, x, y);
            let wanted = f64::from(y).atan2(f64::from(x));
            assert!(
                (found - wanted).abs() < 1e-6,
                "{x} {y}: {found}, not {wanted}"
            );
        }
        assert_eq!(evaluated(angle, 0.0, 0.0), 0.0);
    }

    /// R(s) by integrating cos arg(√s + z) over a complex Gaussian z of variance 1.
    #[test]
    fn the_scatter_of_a_phase_is_that_of_a_noncentral_gaussian() {
        for s in [1e-4f64, 0.01, 0.1, 0.4, 1.0, 3.0, 10.0, 40.0] {
            let (mut sum, mut total, n) = (0.0, 0.0, 400);
            for i in 0..n * n {
                let z = [i % n, i / n].map(|k| 9.0 * (f64::from(k) + 0.5) / f64::from(n) - 4.5);
                let weight = (-z[0] * z[0] - z[1] * z[1]).exp();
                let x = s.sqrt() + z[0];
                sum += weight * x / x.hypot(z[1]);
                total += weight;
            }
            let found = (-0.5 * evaluated(scatter, s as f32, 1.0)).exp();
            let wanted = sum / total;
            assert!((found - wanted).abs() < 6e-4, "{s}: {found}, not {wanted}");
        }
    }
}
