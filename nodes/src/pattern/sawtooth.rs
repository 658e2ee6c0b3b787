//! A sawtooth: the fraction of a number that is spread over less than a period.

use mipless_codegen::ir::{Builder, Value};
use mipless_codegen::moments::{Gaussian, Moments, Normal, Transfer};

/// x − ⌊x⌋, for σ of up to 0.3 periods (a uniform angle has 0.29).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sawtooth;

fn fraction(b: &mut Builder, x: Value) -> Value {
    let whole = b.floor(x);
    b.sub(x, whole)
}

impl Transfer for Sawtooth {
    fn value(&self, b: &mut Builder, x: Value) -> Value {
        fraction(b, x)
    }

    fn moments(&self, b: &mut Builder, x: &Gaussian) -> Moments {
        // x − (x ≥ 1) + (x < 0).
        let u = fraction(b, x.mean);
        let over = b.offset(u, -1.0);
        let (low, high) = (
            Normal::at(b, u, x.inverse_sd),
            Normal::at(b, over, x.inverse_sd),
        );
        let mean = b.sub(u, high.below);
        let mean = b.add(mean, low.above);
        let mean = b.clamp(mean, 0.0, 1.0);
        let densities = b.add(low.density, high.density);
        let drop = b.mul(densities, x.inverse_sd);
        let one = b.f32(1.0);
        let slope = b.sub(one, drop);
        let inverse2 = b.square(x.inverse_sd);
        let curvature = b.dot(&[low.z, high.z], &[low.density, high.density]);
        let curvature = b.mul(curvature, inverse2);
        let mut third = b.f32(0.0);
        for n in [low, high] {
            let square = b.square(n.z);
            let rest = b.sub(one, square);
            let part = b.mul(rest, n.density);
            third = b.add(third, part);
        }
        let inverse3 = b.mul(inverse2, x.inverse_sd);
        let third = b.mul(third, inverse3);
        // Var = v + Var(≥ 1) + Var(< 0) + 2 P(≥ 1) P(< 0) − 2σ(φ + φ); less slope² v, which is
        // v − 2σ(φ + φ) + (φ + φ)².
        let (p, q) = (high.below, low.above);
        let (upper, lower) = (b.mul(p, high.above), b.mul(q, low.below));
        let both = b.mul(p, q);
        let both = b.add(both, both);
        let sum = b.add(upper, lower);
        let sum = b.add(sum, both);
        let square = b.square(densities);
        let distortion = b.sub(sum, square);
        let zero = b.f32(0.0);
        let distortion = b.max(distortion, zero);
        // An angle whose variance is that of a uniform number is uniform: its mean is ½.
        let kept = b.scale(x.variance, -48.0);
        let kept = b.offset(kept, 4.0);
        let kept = b.clamp(kept, 0.0, 1.0);
        let centred = b.offset(mean, -0.5);
        let centred = b.mul(centred, kept);
        let faded = b.mul(slope, kept);
        let (before, after) = (b.square(slope), b.square(faded));
        let lost = b.sub(before, after);
        let lost = b.mul(lost, x.variance);
        Moments {
            mean: b.offset(centred, 0.5),
            slope: faded,
            curvature: b.mul(curvature, kept),
            third: b.mul(third, kept),
            distortion: b.add(distortion, lost),
        }
    }

    fn range(&self, _: &Builder, _: [f32; 2]) -> [f32; 2] {
        [0.0, 1.0]
    }

    fn period(&self) -> Option<f32> {
        Some(1.0)
    }
}
