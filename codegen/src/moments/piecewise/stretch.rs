//! The straight lines of a piecewise function, each from a knot of its own: sums over slopes and knots
//! would be differences of numbers that are as large as σ, where a stretch is as short as one likes.

use super::super::{Gaussian, Normal, normal::probability};
use super::{Knot, Piecewise};
use crate::ir::Float;

/// Below this width in σ an integral over a stretch is its ends' mean, corrected by Euler and Maclaurin:
/// to Δ⁴/720 of the fourth derivative, 1e-6 of the rise at this width. Above it the difference of the
/// antiderivatives is better.
const NARROW: f32 = 0.2;

/// The line between two neighbouring knots.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch<'b> {
    /// The slope.
    pub(super) slope: Float<'b>,
    /// The value where it begins.
    pub(super) start: Float<'b>,
    /// How long it is, at least 0.
    pub(super) width: Float<'b>,
    /// By how much it rises.
    pub(super) rise: Float<'b>,
}

/// All lines of a piecewise function.
#[derive(Clone, Debug)]
pub(super) struct Lines<'b> {
    /// Before the first knot: the slope, and the value there.
    pub(super) before: [Float<'b>; 2],
    /// From knot to knot.
    pub(super) between: Vec<Stretch<'b>>,
    /// After the last knot: the slope, and the value there.
    pub(super) after: [Float<'b>; 2],
}

impl<'b> Piecewise<'b> {
    /// The lines.
    pub(super) fn lines(&self) -> Lines<'b> {
        let mut slope = self.slope;
        let (Some(first), Some((last, others))) = (self.knots.first(), self.knots.split_last())
        else {
            // One line, through 0.
            let line = [slope, self.offset];
            return Lines {
                before: line,
                between: Vec::new(),
                after: line,
            };
        };
        let before = [slope, self.offset + slope * first.at];
        let mut start = before[1];
        let mut between = Vec::new();
        for (knot, next) in others.iter().zip(&self.knots[1..]) {
            slope += knot.bend;
            start += knot.jump;
            let width = (next.at - knot.at).max(0.0);
            let rise = slope * width;
            between.push(Stretch {
                slope,
                start,
                width,
                rise,
            });
            start += rise;
        }
        let level = slope.literal(0.0);
        let slope = if self.level { level } else { slope + last.bend };
        Lines {
            before,
            between,
            after: [slope, start + last.jump],
        }
    }
}

impl<'b> Lines<'b> {
    /// E[T] and its three derivatives by m, of T without its jumps: the value before the first knot,
    /// what lies before it, after the last one and between.
    pub(super) fn moments(
        &self,
        x: &Gaussian<'b>,
        knots: &[Knot<'b>],
        normals: &[Normal<'b>],
    ) -> [Float<'b>; 4] {
        let zero = x.mean.literal(0.0);
        let [before, value] = self.before;
        let ends = normals.first().zip(normals.last());
        let (Some((first, last)), [from, .., to] | [from @ to]) = (ends, knots) else {
            return [value + before * x.mean, before, zero, zero];
        };
        let mut sums = [value, zero, zero, zero];
        let mut add = |terms: [Float<'b>; 4]| {
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum += term;
            }
        };
        // min(x − t, 0) is −max(t − x, 0).
        let mirrored = hinge(x, from.at - x.mean, &first.mirrored());
        add(std::array::from_fn(|order| {
            let sign = if order % 2 == 0 { -1.0 } else { 1.0 };
            before * (mirrored[order] * sign)
        }));
        add(hinge(x, x.mean - to.at, last).map(|moment| self.after[0] * moment));
        for (i, stretch) in self.between.iter().enumerate() {
            let ends = [i, i + 1].map(|i| (x.mean - knots[i].at, normals[i]));
            add(stretch.moments(x, ends));
        }
        sums
    }
}

/// The mean of max(x − t, 0) and its derivatives, `distance` being m − t.
fn hinge<'b>(x: &Gaussian<'b>, distance: Float<'b>, n: &Normal<'b>) -> [Float<'b>; 4] {
    let density = n.density * x.inverse_sd;
    [
        n.hinge(distance, x.sd),
        n.below,
        density,
        -n.z * density * x.inverse_sd,
    ]
}

impl<'b> Stretch<'b> {
    /// The mean of what the stretch adds to all after it, s ∫ Φ((m − x)/σ) dx, and its derivatives.
    fn moments(&self, x: &Gaussian<'b>, ends: [(Float<'b>, Normal<'b>); 2]) -> [Float<'b>; 4] {
        if self.slope.is_zero() {
            return [self.slope; 4];
        }
        let Self {
            slope, rise, width, ..
        } = *self;
        let across = width * x.inverse_sd;
        let narrow = across.lt(NARROW);
        let [from, to] = ends.map(|(_, n)| n);
        // φ and its derivatives −zφ, (z² − 1)φ and z(3 − z²)φ at both ends.
        let densities = [from, to].map(|n| {
            let square = n.z.square();
            [
                n.density,
                -n.z * n.density,
                (square + -1.0) * n.density,
                n.z * (3.0 - square) * n.density,
            ]
        });
        // The mean of a function over the stretch, from its values and derivatives at both ends.
        let mean = |values: [Float<'b>; 2], derivatives: [Float<'b>; 2]| {
            0.5 * (values[0] + values[1])
                - across * (1.0 / 12.0) * (derivatives[0] - derivatives[1])
        };
        let of = |order: usize| densities.map(|derivatives| derivatives[order]);
        let difference = |[from, to]: [Float<'b>; 2]| from - to;

        let [above, below] = ends.map(|(distance, n)| n.hinge(distance, x.sd));
        let value = narrow.select(
            rise * mean([from.below, to.below], of(0)),
            slope * (above - below),
        );
        let wide = [
            probability(&from, &to),
            difference(of(0)),
            difference(of(1)),
        ];
        let mut unit = slope;
        let mut out = [value; 4];
        for (order, wide) in wide.into_iter().enumerate() {
            let near = across * mean(of(order), of(order + 1));
            out[order + 1] = unit * narrow.select(near, wide);
            unit *= x.inverse_sd;
        }
        out
    }
}
