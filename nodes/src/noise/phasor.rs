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
use mipless_codegen::ir::{Float, Sym2, Vec2, dot};
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
fn angle<'b>(x: Float<'b>, y: Float<'b>) -> Float<'b> {
    let (ax, ay) = (x.abs(), y.abs());
    let ratio = ax.min(ay) / ax.max(ay).max(1e-30);
    let square = ratio.square();
    let polynomial = (ATAN.iter().rev()).fold(x.literal(0.0), |sum, &c| sum * square + c);
    let octant = polynomial * ratio;
    let quadrant = ax.lt(ay).select(0.5 * PI - octant, octant);
    let half = x.lt(0.0).select(PI - quadrant, quadrant);
    y.lt(0.0).select(-half, half)
}

/// vᵀΣv.
fn form<'b>(v: Vec2<'b>, s: Sym2<'b>) -> Float<'b> {
    v.dot(s.times(v))
}

/// ½ tr (HΣ)².
fn second<'b>(h: Sym2<'b>, s: Sym2<'b>) -> Float<'b> {
    let ([h11, h12, h22], [s11, s12, s22]) = (h.0, s.0);
    let xx = dot([h11, h12], [s11, s12]);
    let xy = dot([h11, h12], [s12, s22]);
    let yx = dot([h12, h22], [s11, s12]);
    let yy = dot([h12, h22], [s12, s22]);
    (xx * xx + yy * yy) * 0.5 + xy * yx
}

/// −2 ln R(s) with s = power/variance.
fn scatter<'b>(power: Float<'b>, variance: Float<'b>) -> Float<'b> {
    let s = (power / variance).max(1e-30);
    let [linear, bend, below] = RATIONAL;
    let numerator = (s * (0.5 * bend) + linear) * s + 4.0 / PI;
    let denominator = (s * bend + below) * s + 1.0;
    let x = numerator / denominator / s;
    // ln(1 + x) of a small x is x − x²/2.
    let small = x - x.square() * 0.5;
    x.lt(1e-3).select(small, (x + 1.0).ln())
}

/// The phase in turns at a position, given the real and the imaginary field.
pub(crate) fn phase<'b>(
    lower: &mut Lower<'_, 'b>,
    re: &Field<'b>,
    im: &Field<'b>,
    position: &[Signal<'b>],
) -> Signal<'b> {
    let (mode, zero) = (lower.mode(), lower.b().float(0.0));
    let mut field = Field {
        mean: angle(re.mean, im.mean) * (1.0 / TAU),
        gradient: Vec2::splat(zero),
        hessian: Sym2::splat(zero),
        rest: zero,
    };
    if mode.spreads() {
        let s = Spread::of(position).covariance;
        let power = re.mean * re.mean + im.mean * im.mean;
        let inverse = 1.0 / power.max(1e-12);
        // ∇φ, and ∇|m|²/2|m|.
        let turning = (im.gradient * re.mean - re.gradient * im.mean) * inverse;
        let growing = (re.gradient * re.mean + im.gradient * im.mean) * inverse.sqrt();
        let q = form(turning, s).min(30.0);

        // 2σ² = E|Z|² − |m|² e^q, of which |m|² (1 + q) is the mean and the turning.
        let mut rest = re.rest + im.rest + form(growing, s);
        if mode == Mode::Quad {
            for h in [re.hessian, im.hessian] {
                rest += second(h, s);
            }
        }
        let grown = q.exp();
        let series = q.square() * (q * (1.0 / 3.0) + 1.0) * 0.5;
        let beyond = q.lt(0.05).select(series, grown - 1.0 - q) * power;
        let variance = (rest - beyond).max(0.0);
        let coherent = (power * grown).min(power + power * q + rest);
        let variance = variance + coherent * 1e-8 + 1e-30;

        field.rest = scatter(coherent, variance) * (1.0 / (TAU * TAU));
        field.gradient = turning * (1.0 / TAU);
    }
    field.at(lower, position)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mipless_codegen::cpu::{Evaluator, Input, Scratch};
    use mipless_codegen::ir::{Builder, Module};

    fn evaluated(build: impl for<'c> Fn(Float<'c>, Float<'c>) -> Float<'c>, x: f32, y: f32) -> f64 {
        let b = &Builder::new("f", "A test.");
        b.result("out", build(b.float_param("x"), b.float_param("y")));
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
