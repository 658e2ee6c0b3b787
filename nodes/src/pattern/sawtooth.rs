//! A sawtooth: the fraction of a number that is spread over less than a period.

use mipless_codegen::ir::Float;
use mipless_codegen::moments::{Gaussian, Moments, Normal, Transfer};

/// x − ⌊x⌋, for σ of up to 0.3 periods (a uniform angle has 0.29).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sawtooth;

impl<'b> Transfer<'b> for Sawtooth {
    fn value(&self, x: Float<'b>) -> Float<'b> {
        x - x.floor()
    }

    fn is_steep(&self) -> bool {
        true
    }

    fn moments(&self, x: &Gaussian<'b>) -> Moments<'b> {
        // x − (x ≥ 1) + (x < 0).
        let u = self.value(x.mean);
        let [low, high] = [u, u + -1.0].map(|place| Normal::at(place, x.inverse_sd));
        let mean = (u - high.below + low.above).clamp(0.0, 1.0);
        let densities = low.density + high.density;
        let slope = 1.0 - densities * x.inverse_sd;
        let inverse2 = x.inverse_sd.square();
        let curvature = (low.z * low.density + high.z * high.density) * inverse2;
        let third = [low, high].map(|n| (1.0 - n.z.square()) * n.density);
        let third = (third[0] + third[1]) * (inverse2 * x.inverse_sd);

        // Var = v + Var(≥ 1) + Var(< 0) + 2 P(≥ 1) P(< 0) − 2σ(φ + φ); less slope² v, which is
        // v − 2σ(φ + φ) + (φ + φ)².
        let (p, q) = (high.below, low.above);
        let both = p * q;
        let sum = p * high.above + q * low.below + (both + both);
        let distortion = (sum - densities.square()).max(0.0);

        // An angle whose variance is that of a uniform number is uniform: its mean is ½.
        let kept = (x.variance * -48.0 + 4.0).clamp(0.0, 1.0);
        let faded = slope * kept;
        let lost = (slope.square() - faded.square()) * x.variance;
        Moments {
            mean: (mean + -0.5) * kept + 0.5,
            slope: faded,
            curvature: curvature * kept,
            third: third * kept,
            distortion: distortion + lost,
        }
    }

    fn range(&self, _: [f32; 2]) -> [f32; 2] {
        [0.0, 1.0]
    }

    fn period(&self) -> Option<f32> {
        Some(1.0)
    }
}
