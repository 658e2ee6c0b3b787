//! On what share of a footprint a slope is one: cracks, plateaus and bevels are flat elsewhere.
//!
//! A signal that is Gaussian on a share p and 0 elsewhere has E[X⁴] = 3 E[X²]²/p; one that hardly differs
//! has a share of up to 3. Of a product of
//! independent factors, E[X²]²/E[X⁴] is the product of theirs; of a sum, fourth cumulants add.

use super::Signal;
use crate::ir::{Bool, Float};

/// The least second moment that another is divided by.
const NARROWEST: f32 = 1e-20;

impl<'b> Signal<'b> {
    /// E[X²].
    pub fn second_moment(&self) -> Float<'b> {
        self.flat_mean().square() + self.variance()
    }

    /// E[X²]²/E[X⁴] of a factor: of its two values, where it has no others, else of a Gaussian.
    pub(in crate::moments) fn evenness(&self) -> Float<'b> {
        if let Some(share) = self.share {
            return share * (1.0 / 3.0);
        }
        let mean = self.flat_mean();
        if let Some([low, high]) = self.binary {
            let distinct = (high - low).abs().gt(0.0);
            let at_high = (mean - low) / distinct.select(high - low, 1.0);
            let at_high = at_high.clamp(0.0, 1.0);
            let [p, q] = [low.square(), high.square()];
            let second = p + at_high * (q - p);
            let fourth = p * p + at_high * (q * q - p * p);
            return ratio(second.square(), fourth);
        }
        let (square, variance) = (mean.square(), self.variance());
        let second = square + variance;
        let fourth = square.square() + variance * (variance + square + square) * 3.0;
        ratio(second.square(), fourth.max(second.square()))
    }

    /// The share of a term of a sum: a factor of this evenness times this slope.
    pub(in crate::moments) fn share_times(&self, evenness: Float<'b>) -> Float<'b> {
        self.share.map_or(evenness, |share| share * evenness)
    }

    /// The share of the footprint that has these slopes, that of each by its second moment.
    pub fn share_of([u, v]: [&Self; 2]) -> Float<'b> {
        let one = u.mean.literal(1.0);
        if u.share.is_none() && v.share.is_none() {
            return one;
        }
        let [of_u, of_v] = [u, v].map(|slope| slope.second_moment());
        let [p, q] = [u, v].map(|slope| slope.share.unwrap_or(one));
        ratio(of_u * p + of_v * q, of_u + of_v).clamp(0.0, 1.0)
    }
}

/// Scores of a normal deviate with their weights, close enough for what is a fifth of a deviation wide.
const SCORES: i32 = 24;
const STEP: f32 = 0.125;

/// The share of a function of a Gaussian, by the means of its square over parts of it that are narrower.
pub(in crate::moments) fn of_function<'b>(
    mean: Float<'b>,
    sd: Float<'b>,
    square_over: impl Fn(Float<'b>, f32) -> Float<'b>,
) -> Float<'b> {
    let b = mean.builder();
    let squares: Vec<[Float<'b>; 2]> = (-SCORES..=SCORES)
        .map(|i| {
            let z = STEP * i as f32;
            let weight = STEP * (-0.5 * z * z).exp() / (2.0 * std::f32::consts::PI).sqrt();
            let square = square_over(mean + sd * z, 0.5 * STEP);
            [square * weight, square.square() * weight]
        })
        .collect();
    let [second, fourth] = [0, 1].map(|k| b.sum(squares.iter().map(|terms| terms[k])));
    ratio(second.square(), fourth) * 3.0
}

/// p/q, and 1 where both are next to nothing.
fn ratio<'b>(p: Float<'b>, q: Float<'b>) -> Float<'b> {
    (p + NARROWEST) / (q + NARROWEST)
}

/// The share of a sum of terms of these second moments and shares: with m = Σ m_k,
/// p = m²/(m² + Σ m_k² (1/p_k − 1)).
pub(in crate::moments) fn of_terms<'b>(terms: &[[Float<'b>; 2]]) -> Option<Float<'b>> {
    let b = terms.first()?[0].builder();
    let second = b.sum(terms.iter().map(|&[moment, _]| moment));
    let beyond = terms.iter().map(|&[moment, share]| {
        let share = share.max(1e-6);
        moment.square() * ((1.0 - share) / share)
    });
    let square = second.square();
    Some(ratio(square, square + b.sum(beyond)))
}

/// The share of X + Y.
pub(super) fn of_sum<'b>(x: &Signal<'b>, y: &Signal<'b>) -> Option<Float<'b>> {
    if x.share.is_none() && y.share.is_none() {
        return None;
    }
    let one = x.mean.literal(1.0);
    let term = |z: &Signal<'b>| [z.second_moment(), z.share.unwrap_or(one)];
    of_terms(&[term(x), term(y)])
}

/// The share of the one or the other.
pub(super) fn either<'b>(x: &Signal<'b>, y: &Signal<'b>, condition: Bool<'b>) -> Option<Float<'b>> {
    if x.share.is_none() && y.share.is_none() {
        return None;
    }
    let one = x.mean.literal(1.0);
    let [p, q] = [x, y].map(|signal| signal.share.unwrap_or(one));
    Some(condition.select(q, p))
}
