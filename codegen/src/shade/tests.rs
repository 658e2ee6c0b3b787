//! What needs no field.

use super::{Seen, VisibleHeight};
use crate::cpu::{Evaluator, Input, Scratch};
use crate::ir::{Builder, Float, Module, Sym2, Vec2};
use crate::moments::Normal;

/// A function of one number.
fn evaluated(of: impl for<'b> Fn(Float<'b>) -> Float<'b>, at: &[f32]) -> Vec<f32> {
    let b = &Builder::new("f", "A test.");
    b.result("y", of(b.float_param("x")));
    let mut module = Module::default();
    b.finish(&mut module);
    let mut outputs = Vec::new();
    let evaluator = Evaluator::<f32>::new(&module);
    let inputs = [Input::Floats(at)];
    evaluator.evaluate(&mut Scratch::new(), &inputs, at.len(), &mut outputs);
    outputs.remove(0)
}

/// Heitz & Neyret 2012 (eq. 3 of Heitz et al. 2014): of a colour c₀ + c₁ P_h(h) an eye and a light with
/// Λ_o + Λ_i = L see c₀ + c₁ (L + 1)/(L + 2). Here P_h is any function of the height, and the mean of it
/// over the heights that are seen is its transfer: Φ(μ/√(1 + σ²)).
#[test]
fn the_mean_of_c0_plus_c1_times_p_of_height_is_heitz_and_neyrets() {
    let exponents = [0.0, 0.1, 0.5, 1.0, 3.0, 10.0, 100.0, 1e4];
    let means = evaluated(
        |exponent| {
            let height = VisibleHeight::of(exponent);
            Normal::of(height.mean / (1.0 + height.sd.square()).sqrt()).below
        },
        &exponents,
    );
    for (exponent, mean) in exponents.into_iter().zip(means) {
        let wanted = (exponent + 1.0) / (exponent + 2.0);
        // The law of a largest number is no Gaussian: the rest is its shape.
        assert!(
            (mean - wanted).abs() <= 0.004,
            "{exponent}: {mean} {wanted}"
        );
    }
}

/// Smith's Λ by its integral, φ(z)/z − Φ(−z), from −z Φ(−z) + φ(z) = ∫_z^∞ (t − z) φ(t) dt.
#[test]
fn smiths_lambda_is_its_integral() {
    let scores = [0.05_f32, 0.2, 0.7, 1.5, 3.0];
    let found = evaluated(
        |z| {
            let [zero, one] = [0.0, 1.0].map(|x| z.literal(x));
            let (mean, covariance) = (Vec2::splat(zero), Sym2([one, zero, one]));
            Seen::of([one, zero, z], mean, covariance).lambda
        },
        &scores,
    );
    for (z, found) in scores.into_iter().zip(found) {
        let step = 1e-4;
        let density = |t: f64| (-0.5 * t * t).exp() / std::f64::consts::TAU.sqrt();
        let z = f64::from(z);
        let sum: f64 = (0..100_000)
            .map(|k| (f64::from(k) + 0.5) * step)
            .map(|t| t * density(z + t) * step)
            .sum();
        let wanted = sum / z;
        assert!(
            (f64::from(found) - wanted).abs() <= 2e-5 * (1.0 + wanted),
            "{z}: {found} {wanted}"
        );
    }
}
