//! What two correlated coordinates share, taken apart.
//!
//! The two coordinates are Gaussians of covariance c. The mean of a product of functions of them is
//! Σ ρⁿ σ₁ⁿσ₂ⁿ/n! A⁽ⁿ⁾B⁽ⁿ⁾ with A and B the means of the factors and ρ = |c|/(σ₁σ₂) (Mehler), of which
//! four terms are within 1e-3 up to ρ = ½. Of a larger one r is taken apart: the coordinates are
//! m + w t + √(1 − r) (σ₁ε₁, ±σ₂ε₂), w = √r (σ₁, ±σ₂), with a standard t and with ε₁ and ε₂ of the
//! correlation ½. What is left is one integral over t of a function that is smooth at the scale
//! √((1 − r)/r): three nodes to r = 0.15, then the trapezoid rule at 1.6 of it, within ±3.7. Where the
//! rest alone covers the unit cell, one node is enough.
//!
//! Correlations are limited to [`MOST_CORRELATED`]: 10:1 at 45 degrees. A longer footprint keeps its
//! spread along both coordinates and is blurred across.

use super::pulse::{Axis, Derivatives};
use mipless_codegen::ir::{Builder, Float, Scalar, Scalars, Sym2, Uint};

/// The largest correlation of the coordinates that is followed.
const MOST_CORRELATED: f32 = 0.981;

/// The largest correlation whose effect is expanded.
const EXPANDED: f32 = 0.5;

/// How much of a correlation three nodes suffice for.
const THREE_NODES: f32 = 0.15;

/// Nodes are at most this far from each other, in standard deviations of t.
const WIDEST_STEP: f32 = 1.6;

/// … and in the scale at which the function of t is smooth.
const SMOOTH_STEP: f32 = 1.6;

/// From this standard deviation on, in unit cells, a coordinate leaves its mean of every pulse: the first
/// harmonic has 1.6e-3 left.
const SETTLED: f32 = 0.55;

/// Where the integral over t ends.
const REACH: f32 = 3.7;

/// What is known of each node of the integral over t.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nodes<'b> {
    /// w.
    pub(crate) along: [Float<'b>; 2],
    /// The standard deviations that are left, at least 1e-6.
    pub(crate) sd: [Float<'b>; 2],
    /// The first node.
    pub(crate) start: Float<'b>,
    /// From a node to the next.
    pub(crate) step: Float<'b>,
    /// The correlation that is left.
    pub(crate) correlation: Float<'b>,
}

/// The nodes of the integral over t.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Taps<'b> {
    /// All of them.
    pub(crate) nodes: Nodes<'b>,
    /// How many.
    pub(crate) count: Uint<'b>,
}

impl<'b> Taps<'b> {
    /// The nodes for this covariance.
    pub(crate) fn of(covariance: Sym2<'b>) -> Self {
        let [xx, xy, yy] = *covariance;
        let [sx, sy] = [xx, yy].map(|v| (v + 1e-12).sqrt());
        let rho = (xy.abs() / (sx * sy)).min(MOST_CORRELATED);
        let kept = rho.min(EXPANDED);
        let shared = (rho - kept) / (1.0 - kept);
        let left = 1.0 - shared;
        let (root, root_left) = (shared.sqrt(), left.sqrt());
        let sign = xy.lt(0.0).select(-1.0, 1.0);

        // 1/step² = 1/1.6² + r/(1.6² (1 − r)).
        let ratio = shared / left * (1.0 / (SMOOTH_STEP * SMOOTH_STEP));
        let inverse = (ratio + 1.0 / (WIDEST_STEP * WIDEST_STEP)).sqrt();
        // One node is always in the middle: as the footprint turns, nodes come and go where their
        // weight is next to nothing.
        let half = (inverse * REACH).floor();
        // Three nodes at the distance that gives them the variance 1 have nearly the weights of
        // Gauss–Hermite.
        let few = shared.lt(THREE_NODES);
        let half = few.select(1.0, half);
        let step = 1.0 / few.select(1.0 / 3f32.sqrt(), inverse);
        let along = root * few.select(1.039_3, 1.0);
        // Without a shared part there is nothing to integrate.
        let half = shared.le(0.0).select(0.0, half);
        Self {
            nodes: Nodes {
                along: [along * sx, sign * (along * sy)],
                sd: [sx * root_left, sy * root_left],
                start: -(half * step),
                step,
                correlation: sign * kept,
            },
            count: (half * 2.0 + 1.0).to_int().to_uint(),
        }
    }

    /// The same for a function that repeats after 1 along both coordinates: where what is left of both
    /// covers it, one node is all.
    pub(super) fn of_periodic(self) -> Self {
        let [x, y] = self.nodes.sd.map(|sd| sd.gt(SETTLED));
        let both = x & y;
        Self {
            nodes: Nodes {
                start: both.select(0.0, self.nodes.start),
                ..self.nodes
            },
            count: both.select(1, self.count),
        }
    }
}

impl<'b> Nodes<'b> {
    /// The parameters of a function that takes it over.
    pub(crate) fn declare(b: &'b Builder) -> Self {
        Self {
            along: b.float_params(["along_x", "along_y"]),
            sd: b.float_params(["sd_x", "sd_y"]),
            start: b.float_param("start"),
            step: b.float_param("step"),
            correlation: b.float_param("correlation"),
        }
    }

    /// The two coordinates at a node, and the node's weight.
    pub(crate) fn at(&self, index: Uint<'b>, place: [Float<'b>; 2]) -> ([Axis<'b>; 2], Float<'b>) {
        let t = self.start + index.to_float() * self.step;
        let axes = [0, 1].map(|k| Axis {
            mean: place[k] + self.along[k] * t,
            sd: self.sd[k],
        });
        (axes, (t.square() * -0.5).exp())
    }
}

impl<'b> Scalars<'b> for Nodes<'b> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        (self.along, self.sd, self.start, self.step, self.correlation).each(visit);
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        Self {
            along: self.along.replaced(next),
            sd: self.sd.replaced(next),
            start: self.start.replaced(next),
            step: self.step.replaced(next),
            correlation: self.correlation.replaced(next),
        }
    }
}

/// The mean of a product of functions of two Gaussians and its derivatives, each times as many σ, from
/// those of the factors: the first four terms of Mehler's series, as far as third derivatives go.
pub(super) fn joined<'b>(
    x: Derivatives<'b>,
    y: Derivatives<'b>,
    correlation: Float<'b>,
) -> [Float<'b>; 6] {
    let b = correlation.builder();
    let square = correlation.square();
    let sixth = square * correlation * (1.0 / 6.0);
    let series = [b.float(1.0), correlation, square * 0.5, sixth];
    // The derivatives of x from one order on times the series of y's derivatives from another.
    let of = |from: usize, order: usize| {
        let terms = series.iter().zip(&y[order..]).map(|(&c, &y)| c * y);
        b.sum(x[from..].iter().zip(terms).map(|(&x, term)| x * term))
    };
    [of(0, 0), of(1, 0), of(0, 1), of(2, 0), of(1, 1), of(0, 2)]
}

/// Derivatives times σ as derivatives.
pub(super) fn by_place<'b>(parts: &mut [Float<'b>], sd: [Float<'b>; 2]) {
    let [x, y] = sd.map(|sd| 1.0 / sd);
    let factors = [x, y, x.square(), x * y, y.square()];
    for (part, factor) in parts.iter_mut().skip(1).zip(factors) {
        *part *= factor;
    }
}
