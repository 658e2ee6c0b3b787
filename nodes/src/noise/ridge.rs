//! The ridge of a noise, (offset − |X|/4)², and what Musgrave's recursion shares between octaves.

use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Value};
use mipless_codegen::moments::{Gaussian, Moments, Normal, Signal, Symbol, Transfer};

/// The standard deviation of the noise under the ridge.
const SD: f32 = 0.25;

/// T(x) = (offset − |x|/4)².
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ridge {
    pub(crate) offset: Value,
}

impl Transfer for Ridge {
    fn value(&self, b: &mut Builder, x: Value) -> Value {
        let magnitude = b.abs(x);
        let magnitude = b.scale(magnitude, SD);
        let ridge = b.sub(self.offset, magnitude);
        b.square(ridge)
    }

    /// T = o² − ½o|x| + x²/16, of which both parts have closed forms. With z = m/σ: E|x| =
    /// m(P − Q) + 2σφ. The distortion is the square of the second Hermite coefficient,
    /// −½o√2 φσ + √2 v/16, and what |x| has beyond its own, ¼o² 2v(2d(z) − φ²).
    fn moments(&self, b: &mut Builder, x: &Gaussian) -> Moments {
        let normal = Normal::at(b, x.mean, x.inverse_sd);
        let half = b.scale(self.offset, 2.0 * SD);
        let rise = b.sub(normal.below, normal.above);
        let bell = b.mul(normal.density, x.sd);
        let odd = b.mul(x.mean, rise);
        let twice = b.add(bell, bell);
        let magnitude = b.add(odd, twice);
        let square = b.square(x.mean);
        let square = b.add(square, x.variance);
        let square = b.scale(square, SD * SD);
        let whole = b.square(self.offset);
        let part = b.mul(half, magnitude);
        let mean = b.sub(whole, part);
        let mean = b.add(mean, square);
        let zero = b.f32(0.0);
        let mean = b.max(mean, zero);

        let fall = b.mul(half, rise);
        let climb = b.scale(x.mean, 2.0 * SD * SD);
        let slope = b.sub(climb, fall);
        let sharp = b.mul(normal.density, x.inverse_sd);
        let sharp = b.mul(half, sharp);
        let sharp = b.add(sharp, sharp);
        let flat = b.f32(2.0 * SD * SD);
        let curvature = b.sub(flat, sharp);
        let tilted = b.mul(sharp, normal.z);
        let third = b.mul(tilted, x.inverse_sd);

        let dip = b.mul(half, bell);
        let bowl = b.scale(x.variance, SD * SD);
        let second = b.sub(bowl, dip);
        let second = b.square(second);
        let second = b.add(second, second);
        let kink = normal.hinge_distortion(b);
        let kink = b.add(kink, kink);
        let square = b.square(normal.density);
        let kink = b.sub(kink, square);
        let kink = b.max(kink, zero);
        let strength = b.square(half);
        let strength = b.mul(strength, x.variance);
        let kink = b.mul(strength, kink);
        let kink = b.add(kink, kink);
        Moments {
            mean,
            slope,
            curvature,
            third,
            distortion: b.add(second, kink),
        }
    }

    fn range(&self, b: &Builder, [low, high]: [f32; 2]) -> [f32; 2] {
        let Some(offset) = b.as_constant(self.offset) else {
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
pub(crate) fn couple(lower: &mut Lower<'_>, first: Symbol, x: &mut Signal, y: &mut Signal) {
    let symbol = lower.algebra.fresh_symbol();
    let b = lower.b();
    let zero = b.f32(0.0);
    let mut common = zero;
    for &(known, c) in x.shared.iter().filter(|&&(known, _)| known >= first) {
        if let Some(d) = y.coefficient(known) {
            let product = b.mul(c, d);
            common = b.add(common, product);
        }
    }
    for signal in [&mut *x, &mut *y] {
        settle(b, first, signal);
    }
    // y is the symbol; x has its share of it, and keeps the rest.
    let raised = b.offset(y.private, 1e-20);
    let sd = b.sqrt(raised);
    let share = b.div(common, sd);
    let square = b.square(share);
    let rest = b.sub(x.private, square);
    x.private = b.max(rest, zero);
    y.private = zero;
    x.shared.push((symbol, share));
    y.shared.push((symbol, sd));
}

/// Folds the symbols from `first` on into the private variance.
pub(crate) fn settle(b: &mut Builder, first: Symbol, signal: &mut Signal) {
    while let Some(&(symbol, _)) = signal.shared.last().filter(|&&(known, _)| known >= first) {
        signal.retire(b, symbol);
    }
}
