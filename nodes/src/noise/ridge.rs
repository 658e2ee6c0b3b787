//! The ridge of a noise, (offset − |X|/4)², and what Musgrave's recursion shares between octaves.

use mipless_codegen::Lower;
use mipless_codegen::ir::Float;
use mipless_codegen::moments::{Gaussian, Moments, Normal, Signal, Symbol, Transfer};

/// The standard deviation of the noise under the ridge.
const SD: f32 = 0.25;

/// T(x) = (offset − |x|/4)².
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ridge<'b> {
    pub(crate) offset: Float<'b>,
}

impl<'b> Transfer<'b> for Ridge<'b> {
    fn value(&self, x: Float<'b>) -> Float<'b> {
        (self.offset - x.abs() * SD).square()
    }

    /// T = o² − ½o|x| + x²/16, of which both parts have closed forms. With z = m/σ: E|x| =
    /// m(P − Q) + 2σφ. The distortion is the square of the second Hermite coefficient,
    /// −½o√2 φσ + √2 v/16, and what |x| has beyond its own, ¼o² 2v(2d(z) − φ²).
    fn moments(&self, x: &Gaussian<'b>) -> Moments<'b> {
        let normal = Normal::at(x.mean, x.inverse_sd);
        let half = self.offset * (2.0 * SD);
        let rise = normal.below - normal.above;
        let bell = normal.density * x.sd;

        // The mean and its derivatives.
        let magnitude = x.mean * rise + (bell + bell);
        let square = (x.mean.square() + x.variance) * (SD * SD);
        let mean = self.offset.square() - half * magnitude + square;
        let slope = x.mean * (2.0 * SD * SD) - half * rise;
        let sharp = half * (normal.density * x.inverse_sd);
        let sharp = sharp + sharp;

        // The distortion.
        let second = (x.variance * (SD * SD) - half * bell).square();
        let kink = normal.hinge_distortion();
        let kink = (kink + kink - normal.density.square()).max(0.0);
        let kink = half.square() * x.variance * kink;
        Moments {
            mean: mean.max(0.0),
            slope,
            curvature: 2.0 * SD * SD - sharp,
            third: sharp * normal.z * x.inverse_sd,
            distortion: (second + second) + (kink + kink),
        }
    }

    fn range(&self, [low, high]: [f32; 2]) -> [f32; 2] {
        let Some(offset) = self.offset.as_constant() else {
            return [0.0, f32::INFINITY];
        };
        let farthest = low.abs().max(high.abs()) * SD;
        let nearest = if low <= 0.0 && high >= 0.0 {
            0.0
        } else {
            low.abs().min(high.abs()) * SD
        };
        let ends = [nearest, farthest].map(|x| (offset - x).powi(2));
        let least = if (nearest..=farthest).contains(&offset) {
            0.0
        } else {
            ends[0].min(ends[1])
        };
        [least, ends[0].max(ends[1])]
    }
}

/// Writes what `x` and `y` share beyond the footprint's own coordinates, by symbols from `first` on
/// and private parts, with a single symbol: variances and the covariance stay.
pub(crate) fn couple<'b>(
    lower: &mut Lower<'_, 'b>,
    first: Symbol,
    x: &mut Signal<'b>,
    y: &mut Signal<'b>,
) {
    let symbol = lower.algebra.fresh_symbol();
    let fresh = x.shared.iter().filter(|&&(known, _)| known >= first);
    let products = fresh.filter_map(|&(known, c)| Some(c * y.coefficient(known)?));
    let common = lower.b().sum(products);
    for signal in [&mut *x, &mut *y] {
        settle(first, signal);
    }
    // y is the symbol; x has its share of it, and keeps the rest.
    let sd = (y.private + 1e-20).sqrt();
    let share = common / sd;
    x.private = (x.private - share.square()).max(0.0);
    y.private = lower.b().float(0.0);
    x.shared.push((symbol, share));
    y.shared.push((symbol, sd));
}

/// Folds the symbols from `first` on into the private variance.
pub(crate) fn settle(first: Symbol, signal: &mut Signal<'_>) {
    while let Some(&(symbol, _)) = signal.shared.last().filter(|&&(known, _)| known >= first) {
        signal.retire(symbol);
    }
}
