//! A triangle wave: 0 at whole numbers, 1 halfway between.

use mipless_codegen::ir::Float;
use mipless_codegen::moments::{Gaussian, Moments, Normal, Transfer};

/// 2|x − ⌊x + ½⌋|.
///
/// Kinks one by one for σ ≤ 0.16 periods, four damped harmonics beyond (error 1e-4).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle;

/// Where the two series meet, in periods.
const CROSSOVER: f32 = 0.16;

/// The signed distance from the nearest whole number.
fn folded(x: Float<'_>) -> Float<'_> {
    x - (x + 0.5).floor()
}

/// Mean, slope, curvature, third and distortion from the kinks, for x in [−½, ½].
fn kinks<'b>(u: Float<'b>, x: &Gaussian<'b>) -> [Float<'b>; 5] {
    // 2|u| continued: from the left, the slope is 2 at −½ and turns at −½, 0, ½.
    let zero = u.literal(0.0);
    let mut out = [u * 2.0 + 2.0, u.literal(2.0), zero, zero, zero];
    for (at, bend) in [(-0.5, -4.0), (0.0, 4.0), (0.5, -4.0)] {
        let distance = u + -at;
        let n = Normal::at(distance, x.inverse_sd);
        let density = n.density * x.inverse_sd;
        let parts = [
            n.hinge(distance, x.sd) * bend,
            n.below * bend,
            density * bend,
            n.z * density * x.inverse_sd * -bend,
            n.hinge_distortion() * (x.variance * 16.0),
        ];
        for (sum, part) in out.iter_mut().zip(parts) {
            *sum += part;
        }
    }
    out
}

/// The same from the Fourier series ½ − Σ 4/(π²k²) cos 2πkx over odd k, and that of its square,
/// 1/3 + Σ (−1)ᵏ 4/(π²k²) cos 2πkx, each damped by e^{−2π²k²v}.
fn harmonics<'b>(u: Float<'b>, variance: Float<'b>) -> [Float<'b>; 5] {
    use std::f32::consts::{PI, TAU};
    let v = variance.min(4.0);
    let [mut mean, mut slope, mut curvature, mut third] =
        [0.5, 0.0, 0.0, 0.0].map(|x| u.literal(x));
    let mut square = u.literal(1.0 / 3.0);
    for k in 1..=4 {
        let odd = k % 2 == 1;
        let k = k as f32;
        let damping = (v * (-2.0 * PI * PI * k * k)).clamp(-80.0, 0.0).exp();
        let amplitude = damping * (4.0 / (PI * PI * k * k));
        let angle = u * (TAU * k);
        let (sine, cosine) = (amplitude * angle.sin(), amplitude * angle.cos());
        if !odd {
            square += cosine;
            continue;
        }
        let w = TAU * k;
        square -= cosine;
        mean += cosine * -1.0;
        slope += sine * w;
        curvature += cosine * (w * w);
        third += sine * (-w * w * w);
    }
    // At these footprints the spread is that of the whole wave: nothing cancels.
    let distortion = (square - mean.square() - slope.square() * variance).max(0.0);
    [mean, slope, curvature, third, distortion]
}

impl<'b> Transfer<'b> for Triangle {
    fn value(&self, x: Float<'b>) -> Float<'b> {
        folded(x).abs() * 2.0
    }

    fn moments(&self, x: &Gaussian<'b>) -> Moments<'b> {
        let u = folded(x.mean);
        let near = kinks(u, x);
        let far = harmonics(u, x.variance);
        let narrow = x.sd.lt(CROSSOVER);
        let [mean, slope, curvature, third, distortion] =
            std::array::from_fn(|i| narrow.select(near[i], far[i]));
        Moments {
            mean: mean.clamp(0.0, 1.0),
            slope,
            curvature,
            third,
            distortion,
        }
    }

    fn range(&self, _: [f32; 2]) -> [f32; 2] {
        [0.0, 1.0]
    }

    fn period(&self) -> Option<f32> {
        Some(1.0)
    }
}
