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

use super::pulse::Axis;
use mipless_codegen::ir::{Builder, Value};

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

/// The nodes of the integral over t.
pub(crate) struct Taps {
    /// w.
    pub(crate) along: [Value; 2],
    /// The standard deviations that are left, at least 1e-6.
    pub(crate) sd: [Value; 2],
    /// Their correlation.
    pub(crate) correlation: Value,
    /// The first node.
    pub(crate) start: Value,
    /// From a node to the next.
    pub(crate) step: Value,
    /// How many, as u32.
    pub(crate) count: Value,
}

impl Taps {
    /// The nodes for this covariance.
    pub(crate) fn of(b: &mut Builder, [xx, xy, yy]: [Value; 3]) -> Self {
        let (one, zero) = (b.f32(1.0), b.f32(0.0));
        let [sx, sy] = [xx, yy].map(|v| {
            let v = b.offset(v, 1e-12);
            b.sqrt(v)
        });
        let both = b.mul(sx, sy);
        let magnitude = b.abs(xy);
        let rho = b.div(magnitude, both);
        let most = b.f32(MOST_CORRELATED);
        let rho = b.min(rho, most);
        let expanded = b.f32(EXPANDED);
        let kept = b.min(rho, expanded);
        let (beyond, rest) = (b.sub(rho, kept), b.sub(one, kept));
        let shared = b.div(beyond, rest);
        let left = b.sub(one, shared);
        let (root, root_left) = (b.sqrt(shared), b.sqrt(left));
        let negative = b.lt(xy, zero);
        let minus = b.f32(-1.0);
        let sign = b.select(negative, minus, one);
        let sd = [sx, sy].map(|s| b.mul(s, root_left));
        // 1/step² = 1/1.6² + r/(1.6² (1 − r)).
        let ratio = b.div(shared, left);
        let ratio = b.scale(ratio, 1.0 / (SMOOTH_STEP * SMOOTH_STEP));
        let inverse = b.offset(ratio, 1.0 / (WIDEST_STEP * WIDEST_STEP));
        let inverse = b.sqrt(inverse);
        // One node is always in the middle: as the footprint turns, nodes come and go where their
        // weight is next to nothing.
        let half = b.scale(inverse, REACH);
        let half = b.floor(half);
        // Three nodes at the distance that gives them the variance 1 have nearly the weights of
        // Gauss–Hermite.
        let few = b.f32(THREE_NODES);
        let few = b.lt(shared, few);
        let (three, inverse_three) = (b.f32(1.039_3), b.f32(1.0 / 3f32.sqrt()));
        let half = b.select(few, one, half);
        let inverse = b.select(few, inverse_three, inverse);
        let stretch = b.select(few, three, one);
        let along = b.mul(root, stretch);
        let (wx, wy) = (b.mul(along, sx), b.mul(along, sy));
        let wy = b.mul(sign, wy);
        // Without a shared part there is nothing to integrate.
        let alone = b.le(shared, zero);
        let half = b.select(alone, zero, half);
        let step = b.div(one, inverse);
        let start = b.mul(half, step);
        let start = b.neg(start);
        let count = b.scale(half, 2.0);
        let count = b.offset(count, 1.0);
        let count = b.trunc_i(count);
        let count = b.cast_u(count);
        Self {
            along: [wx, wy],
            sd,
            correlation: b.mul(sign, kept),
            start,
            step,
            count,
        }
    }

    /// The same for a function that repeats after 1 along both coordinates: where what is left of both
    /// covers it, one node is all.
    pub(super) fn of_periodic(self, b: &mut Builder) -> Self {
        let settled = b.f32(SETTLED);
        let [x, y] = self.sd.map(|sd| b.lt(settled, sd));
        let both = b.and(x, y);
        let (zero, once) = (b.f32(0.0), b.u32(1));
        Self {
            start: b.select(both, zero, self.start),
            count: b.select(both, once, self.count),
            ..self
        }
    }

    /// The numbers that the body of the fold takes, by [`Self::NAMES`].
    pub(crate) fn captures(&self) -> [Value; 7] {
        let ([wx, wy], [sx, sy]) = (self.along, self.sd);
        [wx, wy, sx, sy, self.start, self.step, self.correlation]
    }

    /// Names of the captures.
    pub(crate) const NAMES: [&str; 7] = [
        "along_x",
        "along_y",
        "sd_x",
        "sd_y",
        "start",
        "step",
        "correlation",
    ];

    /// Inside the body: the two coordinates at this node, and the node's weight.
    pub(crate) fn node(
        b: &mut Builder,
        index: Value,
        [x, y]: [Value; 2],
        captures: [Value; 7],
    ) -> ([Axis; 2], Value) {
        let [wx, wy, sx, sy, start, step, _] = captures;
        let number = b.float_u(index);
        let t = b.mul(number, step);
        let t = b.add(start, t);
        let square = b.square(t);
        let exponent = b.scale(square, -0.5);
        let weight = b.exp(exponent);
        let axes = [(x, wx, sx), (y, wy, sy)].map(|(mean, along, sd)| {
            let shift = b.mul(along, t);
            let mean = b.add(mean, shift);
            Axis { mean, sd }
        });
        (axes, weight)
    }
}

/// The mean of a product of functions of two Gaussians and its derivatives, each times as many σ, from
/// those of the factors: the first four terms of Mehler's series, as far as third derivatives go.
pub(super) fn joined(
    b: &mut Builder,
    x: [Value; 4],
    y: [Value; 4],
    correlation: Value,
) -> [Value; 6] {
    let square = b.square(correlation);
    let cube = b.mul(square, correlation);
    let (half, sixth) = (b.scale(square, 0.5), b.scale(cube, 1.0 / 6.0));
    let series = [b.f32(1.0), correlation, half, sixth];
    // The series of y's derivatives of order k.
    let [value, slope, bend] = [0, 1, 2].map(|k| {
        let terms = series.iter().zip(&y[k..]);
        terms.map(|(&c, &y)| b.mul(c, y)).collect::<Vec<Value>>()
    });
    [
        b.dot(&x, &value),
        b.dot(&x[1..], &value),
        b.dot(&x, &slope),
        b.dot(&x[2..], &value),
        b.dot(&x[1..], &slope),
        b.dot(&x, &bend),
    ]
}

/// Derivatives times σ as derivatives.
pub(super) fn by_place(b: &mut Builder, parts: &mut [Value], sd: [Value; 2]) {
    let one = b.f32(1.0);
    let [x, y] = sd.map(|sd| b.div(one, sd));
    let factors = [x, y, b.square(x), b.mul(x, y), b.square(y)];
    for (part, factor) in parts.iter_mut().skip(1).zip(factors) {
        *part = b.mul(*part, factor);
    }
}
