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
/// For σ ≤ 0.11 periods the nearest rising and the nearest falling edge (the others are half a period
/// away: 3e-6), beyond it six harmonics of the Fourier series, damped by e^{−2π²k²v} (error 1e-6).
/// Exact for a Gaussian.
#[derive(Clone, Copy, Debug)]
pub struct SquareWave {
    /// The share of a period that is 1, in [0, 1].
    pub width: Value,
}

/// Where the two series meet, in periods.
const CROSSOVER: f32 = 0.2;

/// The same for a square wave, of which two edges and six harmonics are summed.
const SQUARE_CROSSOVER: f32 = 0.11;

/// How many harmonics of a square wave.
const HARMONICS: usize = 6;

/// x less the whole number below it.
fn fraction(b: &mut Builder, x: Value) -> Value {
    let whole = b.floor(x);
    b.sub(x, whole)
}

/// The nearest whole number, and x less that: in [−½, ½].
fn nearest(b: &mut Builder, x: Value) -> [Value; 2] {
    let raised = b.offset(x, 0.5);
    let whole = b.floor(raised);
    [whole, b.sub(x, whole)]
}

impl SquareWave {
    /// The sum over edges: mean, slope, curvature, third.
    fn edges(&self, b: &mut Builder, u: Value, inverse: Value) -> [Value; 4] {
        let inverse2 = b.square(inverse);
        let inverse3 = b.mul(inverse2, inverse);
        let falling = b.sub(u, self.width);
        let ([rises, up], [falls, down]) = (nearest(b, u), nearest(b, falling));
        // The wave is ⌊u⌋ − ⌊u − width⌋, and ⌊x⌋ next to a whole number is that or one less.
        let zero = b.f32(0.0);
        let mut out = [b.sub(rises, falls), zero, zero, zero];
        for (distance, sign) in [(up, 1.0), (down, -1.0)] {
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
        let half = b.scale(self.width, 0.5);
        let centred = b.sub(u, half);
        let [_, turns] = nearest(b, centred);
        let place = b.circle(turns);
        let place = b.multiples::<HARMONICS>(place);
        // sin(kπ width).
        let edge = b.circle(half);
        let edge = b.multiples::<HARMONICS>(edge);
        // qᵏ² from q = e^{−2π²v}: each is the one before times q²ᵏ⁺¹.
        let exponent = b.scale(variance, -2.0 * PI * PI);
        let exponent = b.clamp(exponent, -40.0, 0.0);
        let first = b.exp(exponent);
        let square = b.square(first);
        let (mut damping, mut step) = (first, b.mul(square, first));
        let zero = b.f32(0.0);
        let mut out = [self.width, zero, zero, zero];
        for (k, ([cosine, sine], [_, edge])) in (1..).zip(place.into_iter().zip(edge)) {
            let k = k as f32;
            let amplitude = b.mul(edge, damping);
            let w = TAU * k;
            let of = 2.0 / (PI * k);
            let along = b.mul(amplitude, cosine);
            let across = b.mul(amplitude, sine);
            for (sum, (part, factor)) in out.iter_mut().zip([
                (along, of),
                (across, -w * of),
                (along, -w * w * of),
                (across, w * w * w * of),
            ]) {
                let part = b.scale(part, factor);
                *sum = b.add(*sum, part);
            }
            damping = b.mul(damping, step);
            step = b.mul(step, square);
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
        let crossover = b.f32(SQUARE_CROSSOVER);
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
