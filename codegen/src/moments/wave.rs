//! Waves, filtered by whichever series converges; here the square one.

mod floor;
mod linear;

#[cfg(test)]
pub(super) use floor::Staircase;
pub use linear::{Corner, LinearWave};

use super::{Gaussian, Moments, Normal, SharedTransfer, Transfer};
use crate::ir::{Builder, Value};
use smallvec::smallvec;

/// 1 where the fraction of x is below `width`, else 0; x in periods.
///
/// For σ ≤ 0.2 periods the sum over the five edges within reach (error 3e-7), beyond it three
/// harmonics of the Fourier series, damped by e^{−2π²k²v} (error 2e-6). Exact for a Gaussian.
#[derive(Clone, Copy, Debug)]
pub struct SquareWave {
    /// The share of a period that is 1, in [0, 1].
    pub width: Value,
}

/// Where the two series meet, in periods.
const CROSSOVER: f32 = 0.2;

/// x less the whole number below it.
fn fraction(b: &mut Builder, x: Value) -> Value {
    let whole = b.floor(x);
    b.sub(x, whole)
}

impl SquareWave {
    /// The sum over edges: mean, slope, curvature, third.
    fn edges(&self, b: &mut Builder, u: Value, inverse: Value) -> [Value; 4] {
        let inverse2 = b.square(inverse);
        let inverse3 = b.mul(inverse2, inverse);
        let falling = b.sub(u, self.width);
        let mut out = [b.f32(1.0), b.f32(0.0), b.f32(0.0), b.f32(0.0)];
        // Rising edges at 0 and 1, falling ones at width − 1, width and width + 1; the rising edge
        // at −1 is the 1 that the sum starts from.
        for (from, shift, sign) in [
            (u, 0.0, 1.0),
            (u, -1.0, 1.0),
            (falling, 1.0, -1.0),
            (falling, 0.0, -1.0),
            (falling, -1.0, -1.0),
        ] {
            let distance = b.offset(from, shift);
            let n = Normal::at(b, distance, inverse);
            let density = b.mul(n.density, inverse);
            let curved = b.mul(n.z, n.density);
            let curved = b.mul(curved, inverse2);
            let square = b.square(n.z);
            let square = b.offset(square, -1.0);
            let third = b.mul(square, n.density);
            let third = b.mul(third, inverse3);
            for (sum, (part, sign)) in out.iter_mut().zip([
                (n.below, sign),
                (density, sign),
                (curved, -sign),
                (third, sign),
            ]) {
                let part = b.scale(part, sign);
                *sum = b.add(*sum, part);
            }
        }
        out
    }

    /// The damped Fourier series: mean, slope, curvature, third.
    fn harmonics(&self, b: &mut Builder, u: Value, variance: Value) -> [Value; 4] {
        use std::f32::consts::{PI, TAU};
        let limit = b.f32(4.0);
        let v = b.min(variance, limit);
        let half = b.scale(self.width, 0.5);
        let centred = b.sub(u, half);
        let zero = b.f32(0.0);
        let mut out = [self.width, zero, zero, zero];
        for k in 1..=3 {
            let k = k as f32;
            let angle = b.scale(self.width, PI * k);
            let amplitude = b.sin(angle);
            let exponent = b.scale(v, -2.0 * PI * PI * k * k);
            let exponent = b.clamp(exponent, -80.0, 0.0);
            let damping = b.exp(exponent);
            let amplitude = b.mul(amplitude, damping);
            let amplitude = b.scale(amplitude, 2.0 / (PI * k));
            let turns = b.scale(centred, k);
            let rounded = b.offset(turns, 0.5);
            let whole = b.floor(rounded);
            let turns = b.sub(turns, whole);
            let angle = b.scale(turns, TAU);
            let (sine, cosine) = (b.sin(angle), b.cos(angle));
            let w = TAU * k;
            for (i, (trig, factor)) in [
                (cosine, 1.0),
                (sine, -w),
                (cosine, -w * w),
                (sine, w * w * w),
            ]
            .into_iter()
            .enumerate()
            {
                let part = b.mul(amplitude, trig);
                let part = b.scale(part, factor);
                out[i] = b.add(out[i], part);
            }
        }
        out
    }
}

impl Transfer for SquareWave {
    fn value(&self, b: &mut Builder, x: Value) -> Value {
        let fraction = fraction(b, x);
        let (zero, one) = (b.f32(0.0), b.f32(1.0));
        let on = b.lt(fraction, self.width);
        b.select(on, one, zero)
    }

    fn moments(&self, b: &mut Builder, x: &Gaussian) -> Moments {
        let u = fraction(b, x.mean);
        let edges = self.edges(b, u, x.inverse_sd);
        let harmonics = self.harmonics(b, u, x.variance);
        let crossover = b.f32(CROSSOVER);
        let narrow = b.lt(x.sd, crossover);
        let pick = |b: &mut Builder, i: usize| b.select(narrow, edges[i], harmonics[i]);
        let mean = pick(b, 0);
        let mean = b.clamp(mean, 0.0, 1.0);
        let (slope, curvature, third) = (pick(b, 1), pick(b, 2), pick(b, 3));
        // The wave is 0 or 1: its variance is P(1 − P).
        let one = b.f32(1.0);
        let rest = b.sub(one, mean);
        let variance = b.mul(mean, rest);
        let square = b.square(slope);
        let linear = b.mul(square, x.variance);
        let distortion = b.sub(variance, linear);
        let zero = b.f32(0.0);
        let distortion = b.max(distortion, zero);
        Moments {
            mean,
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

    fn shared(&self, _: &mut Builder, _: [f32; 2]) -> Option<SharedTransfer> {
        Some(SharedTransfer {
            name: "square_wave",
            doc: "A square wave of a signal.",
            variant: 0,
            values: smallvec![self.width],
            rebuild: |_, values| Box::new(Self { width: values[0] }),
        })
    }

    fn binary(&self, _: &Builder) -> Option<[f32; 2]> {
        Some([0.0, 1.0])
    }
}
