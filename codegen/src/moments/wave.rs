//! Waves, filtered by whichever series converges; here the square one.

mod floor;
mod linear;

#[cfg(test)]
pub(super) use floor::Staircase;
pub(crate) use floor::Wholes;
pub use linear::{Corner, LinearWave};

use super::{Gaussian, Moments, Normal, SharedTransfer, Transfer};
use crate::ir::{Float, multiples};
use smallvec::smallvec;

/// 1 where the fraction of x is below `width`, else 0; x in periods.
///
/// For σ ≤ 0.11 periods the nearest rising and the nearest falling edge (the others are half a period
/// away: 3e-6), beyond it six harmonics of the Fourier series, damped by e^{−2π²k²v} (error 1e-6).
/// Exact for a Gaussian.
#[derive(Clone, Copy, Debug)]
pub struct SquareWave<'b> {
    /// The share of a period that is 1, in [0, 1].
    pub width: Float<'b>,
}

/// Where the two series meet, in periods.
const CROSSOVER: f32 = 0.2;

/// The same for a square wave, of which two edges and six harmonics are summed.
const SQUARE_CROSSOVER: f32 = 0.11;

/// How many harmonics of a square wave.
const HARMONICS: usize = 6;

/// x less the whole number below it.
fn fraction(x: Float<'_>) -> Float<'_> {
    x - x.floor()
}

/// The nearest whole number, and x less that: in [−½, ½].
pub(super) fn nearest(x: Float<'_>) -> [Float<'_>; 2] {
    let whole = (x + 0.5).floor();
    [whole, x - whole]
}

impl<'b> SquareWave<'b> {
    /// The sum over edges: mean, slope, curvature, third.
    fn edges(&self, u: Float<'b>, inverse: Float<'b>) -> [Float<'b>; 4] {
        let inverse2 = inverse.square();
        let inverse3 = inverse2 * inverse;
        let [(rises, risen, up), (falls, fallen, down)] = [u, u - self.width].map(|x| {
            let [whole, distance] = nearest(x);
            let n = Normal::at(distance, inverse);
            let slope = n.density * inverse;
            let curvature = n.z * n.density * inverse2;
            let third = (n.z.square() + -1.0) * n.density * inverse3;
            (whole, n.below, [slope, curvature, third])
        });
        // The wave is ⌊u⌋ − ⌊u − width⌋, and ⌊x⌋ next to a whole number is that or one less.
        [
            rises - falls + risen - fallen,
            up[0] - down[0],
            down[1] - up[1],
            up[2] - down[2],
        ]
    }

    /// The damped Fourier series: mean, slope, curvature, third.
    fn harmonics(&self, u: Float<'b>, variance: Float<'b>) -> [Float<'b>; 4] {
        use std::f32::consts::{PI, TAU};
        let half = self.width * 0.5;
        let [_, turns] = nearest(u - half);
        let places = multiples::<HARMONICS>(turns.circle());
        // sin(kπ width).
        let edges = multiples::<HARMONICS>(half.circle());
        // qᵏ² from q = e^{−2π²v}: each is the one before times q²ᵏ⁺¹.
        let first = (variance * (-2.0 * PI * PI)).clamp(-40.0, 0.0).exp();
        let square = first.square();
        let (mut damping, mut step) = (first, square * first);
        let zero = u.literal(0.0);
        let mut sums = [self.width, zero, zero, zero];
        for (k, ([cosine, sine], [_, edge])) in (1..).zip(places.into_iter().zip(edges)) {
            let k = k as f32;
            let (w, of) = (TAU * k, 2.0 / (PI * k));
            let amplitude = edge * damping;
            let (along, across) = (amplitude * cosine, amplitude * sine);
            let terms = [
                along * of,
                across * (-w * of),
                along * (-w * w * of),
                across * (w * w * w * of),
            ];
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum += term;
            }
            damping *= step;
            step *= square;
        }
        sums
    }
}

impl<'b> Transfer<'b> for SquareWave<'b> {
    fn value(&self, x: Float<'b>) -> Float<'b> {
        fraction(x).lt(self.width).select(1.0, 0.0)
    }

    fn is_steep(&self) -> bool {
        true
    }

    fn moments(&self, x: &Gaussian<'b>) -> Moments<'b> {
        let u = fraction(x.mean);
        let edges = self.edges(u, x.inverse_sd);
        let harmonics = self.harmonics(u, x.variance);
        let narrow = x.sd.lt(SQUARE_CROSSOVER);
        let [mean, slope, curvature, third] =
            std::array::from_fn(|i| narrow.select(edges[i], harmonics[i]));
        let mean = mean.clamp(0.0, 1.0);
        // The wave is 0 or 1: its variance is P(1 − P).
        let distortion = mean * (1.0 - mean) - slope.square() * x.variance;
        Moments::of([mean, slope, curvature, third], distortion.max(0.0))
    }

    fn range(&self, _: [f32; 2]) -> [f32; 2] {
        [0.0, 1.0]
    }

    fn period(&self) -> Option<f32> {
        Some(1.0)
    }

    fn shared(&self, _: [f32; 2]) -> Option<SharedTransfer<'b>> {
        Some(SharedTransfer {
            name: "square_wave",
            doc: "A square wave of a signal.",
            variant: 0,
            values: smallvec![self.width],
            rebuild: |_, values| Box::new(SquareWave { width: values[0] }),
        })
    }

    fn binary(&self) -> Option<[f32; 2]> {
        Some([0.0, 1.0])
    }
}
