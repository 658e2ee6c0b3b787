//! A triangle wave: 0 at whole numbers, 1 halfway between.

use mipless_codegen::ir::{Builder, Value};
use mipless_codegen::moments::{Gaussian, Moments, Normal, Transfer};

/// 2|x − ⌊x + ½⌋|.
///
/// Kinks one by one for σ ≤ 0.16 periods, four damped harmonics beyond (error 1e-4).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Triangle;

/// Where the two series meet, in periods.
const CROSSOVER: f32 = 0.16;

fn folded(b: &mut Builder, x: Value) -> Value {
    let rounded = b.offset(x, 0.5);
    let rounded = b.floor(rounded);
    b.sub(x, rounded)
}

/// Mean, slope, curvature, third and distortion from the kinks, for x in [−½, ½].
fn kinks(b: &mut Builder, u: Value, x: &Gaussian) -> [Value; 5] {
    let four_v = b.scale(x.variance, 16.0);
    let zero = b.f32(0.0);
    // 2|u| continued: from the left, the slope is 2 at −½ and turns at −½, 0, ½.
    let rise = b.scale(u, 2.0);
    let mut out = [b.offset(rise, 2.0), b.f32(2.0), zero, zero, zero];
    for (at, bend) in [(-0.5, -4.0), (0.0, 4.0), (0.5, -4.0)] {
        let distance = b.offset(u, -at);
        let n = Normal::at(b, distance, x.inverse_sd);
        let hinge = n.hinge(b, distance, x.sd);
        let density = b.mul(n.density, x.inverse_sd);
        let third = b.mul(n.z, density);
        let third = b.mul(third, x.inverse_sd);
        let distortion = n.hinge_distortion(b);
        let distortion = b.mul(distortion, four_v);
        let parts = [
            b.scale(hinge, bend),
            b.scale(n.below, bend),
            b.scale(density, bend),
            b.scale(third, -bend),
            distortion,
        ];
        for (sum, part) in out.iter_mut().zip(parts) {
            *sum = b.add(*sum, part);
        }
    }
    out
}

/// The same from the Fourier series ½ − Σ 4/(π²k²) cos 2πkx over odd k, and that of its square,
/// 1/3 + Σ (−1)ᵏ 4/(π²k²) cos 2πkx, each damped by e^{−2π²k²v}.
fn harmonics(b: &mut Builder, u: Value, variance: Value) -> [Value; 5] {
    use std::f32::consts::{PI, TAU};
    let limit = b.f32(4.0);
    let v = b.min(variance, limit);
    let zero = b.f32(0.0);
    let mut out = [b.f32(0.5), zero, zero, zero];
    let mut square = b.f32(1.0 / 3.0);
    for k in 1..=4 {
        let odd = k % 2 == 1;
        let k = k as f32;
        let exponent = b.scale(v, -2.0 * PI * PI * k * k);
        let exponent = b.clamp(exponent, -80.0, 0.0);
        let damping = b.exp(exponent);
        let amplitude = b.scale(damping, 4.0 / (PI * PI * k * k));
        let angle = b.scale(u, TAU * k);
        let (sine, cosine) = (b.sin(angle), b.cos(angle));
        let part = b.mul(amplitude, cosine);
        square = if odd {
            b.sub(square, part)
        } else {
            b.add(square, part)
        };
        if odd {
            let w = TAU * k;
            for (sum, (trig, factor)) in out.iter_mut().zip([
                (cosine, -1.0),
                (sine, w),
                (cosine, w * w),
                (sine, -w * w * w),
            ]) {
                let part = b.mul(amplitude, trig);
                let part = b.scale(part, factor);
                *sum = b.add(*sum, part);
            }
        }
    }
    // At these footprints the spread is that of the whole wave: nothing cancels.
    let mean = b.square(out[0]);
    let slope = b.square(out[1]);
    let linear = b.mul(slope, variance);
    let distortion = b.sub(square, mean);
    let distortion = b.sub(distortion, linear);
    let distortion = b.max(distortion, zero);
    [out[0], out[1], out[2], out[3], distortion]
}

impl Transfer for Triangle {
    fn value(&self, b: &mut Builder, x: Value) -> Value {
        let u = folded(b, x);
        let distance = b.abs(u);
        b.scale(distance, 2.0)
    }

    fn moments(&self, b: &mut Builder, x: &Gaussian) -> Moments {
        let u = folded(b, x.mean);
        let near = kinks(b, u, x);
        let far = harmonics(b, u, x.variance);
        let crossover = b.f32(CROSSOVER);
        let narrow = b.lt(x.sd, crossover);
        let [mean, slope, curvature, third, distortion] =
            [0, 1, 2, 3, 4].map(|i| b.select(narrow, near[i], far[i]));
        Moments {
            mean: b.clamp(mean, 0.0, 1.0),
            slope,
            curvature,
            third,
            distortion,
        }
    }

    fn range(&self, _: &Builder, _: [f32; 2]) -> [f32; 2] {
        [0.0, 1.0]
    }

    fn period(&self) -> Option<f32> {
        Some(1.0)
    }
}
