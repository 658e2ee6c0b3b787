//! The bump τ(1 − τ)(p(1 − τ) − qτ) that turns a straight segment into a cubic: p and q are by how
//! much the slopes at its ends, in units of the segment, differ from the straight one's. A smooth
//! step of height Δ is p = q = −Δ; p = −q is a parabola.

use super::super::{Gaussian, Moments, Normal};
use crate::ir::{Builder, Value};

/// The slopes p and q of a bump at the two ends of its segment, by τ.
#[derive(Clone, Copy, Debug)]
pub struct Bump {
    /// p: at τ = 0.
    pub start: Value,
    /// q: at τ = 1.
    pub end: Value,
}

impl Bump {
    /// p = q = −Δ: the straight segment of height Δ becomes 3τ² − 2τ³.
    pub(super) fn smooth(b: &mut Builder, height: Value) -> Self {
        let slope = b.neg(height);
        Self {
            start: slope,
            end: slope,
        }
    }

    /// a times it.
    pub(super) fn scale(self, b: &mut Builder, a: Value) -> Self {
        Self {
            start: b.mul(self.start, a),
            end: b.mul(self.end, a),
        }
    }

    /// The bump at τ in [0, 1].
    pub(super) fn at(self, b: &mut Builder, t: Value) -> Value {
        let one = b.f32(1.0);
        let back = b.sub(one, t);
        let (rise, fall) = (b.mul(self.start, back), b.mul(self.end, t));
        let slope = b.sub(rise, fall);
        let product = b.mul(t, back);
        b.mul(product, slope)
    }

    /// Whether it is the constant 0.
    pub(super) fn is_flat(self, b: &Builder) -> bool {
        b.is_zero(self.start) && b.is_zero(self.end)
    }
}

/// A bump between `from` and `to`, else 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    /// Where it begins.
    pub(super) from: Value,
    /// Where it ends.
    pub(super) to: Value,
    /// Its shape.
    pub(super) bump: Bump,
}

/// Nodes and weights of Gauss–Legendre on [0, 1], degree 7.
const NODES: [(f32, f32); 4] = [
    (0.069_431_844, 0.173_927_42),
    (0.330_009_48, 0.326_072_58),
    (0.669_990_52, 0.326_072_58),
    (0.930_568_16, 0.173_927_42),
];

impl Segment {
    fn inverse_width(&self, b: &mut Builder) -> Value {
        let width = b.sub(self.to, self.from);
        let least = b.f32(1e-6);
        let width = b.max(width, least);
        let one = b.f32(1.0);
        b.div(one, width)
    }

    /// The bump at x.
    pub(super) fn value(&self, b: &mut Builder, x: Value) -> Value {
        let inverse = self.inverse_width(b);
        let t = b.sub(x, self.from);
        let t = b.mul(t, inverse);
        let t = b.clamp(t, 0.0, 1.0);
        self.bump.at(b, t)
    }

    /// The moments of the bump; its distortion is not its own but the whole function's.
    pub(super) fn moments(&self, b: &mut Builder, x: &Gaussian) -> Moments {
        let inverse_width = self.inverse_width(b);
        // In units of the segment: mean m and spread s; ends at standard scores a and e.
        let m = b.sub(x.mean, self.from);
        let m = b.mul(m, inverse_width);
        let width = b.sub(self.to, self.from);
        let inverse = b.mul(width, x.inverse_sd);
        let s = b.mul(x.sd, inverse_width);
        let exact = self.truncated(b, x, m, s, inverse);
        let quadrature = quadrature(b, self.bump, m, inverse);
        // Below this width in σ the truncated moments cancel and the density is smooth.
        let least = b.f32(1.2);
        let wide = b.lt(least, inverse);
        let mut pick = |e: Value, q: Value, power: u32| {
            let mut value = b.select(wide, e, q);
            for _ in 0..power {
                value = b.mul(value, inverse_width);
            }
            value
        };
        Moments {
            mean: pick(exact.mean, quadrature.mean, 0),
            slope: pick(exact.slope, quadrature.slope, 1),
            curvature: pick(exact.curvature, quadrature.curvature, 2),
            third: pick(exact.third, quadrature.third, 3),
            distortion: exact.distortion,
        }
    }

    /// By truncated moments M_k = ∫ zᵏ φ dz over the segment and the Taylor series of the bump at m.
    fn truncated(
        &self,
        b: &mut Builder,
        x: &Gaussian,
        m: Value,
        s: Value,
        inverse: Value,
    ) -> Moments {
        let (from, to) = (b.sub(x.mean, self.from), b.sub(x.mean, self.to));
        let (n0, n1) = (
            Normal::at(b, from, x.inverse_sd),
            Normal::at(b, to, x.inverse_sd),
        );
        let (a, e) = (b.neg(n0.z), b.neg(n1.z));
        let (fa, fe) = (n0.density, n1.density);
        let m0 = probability(b, &n0, &n1);
        let m1 = b.sub(fa, fe);
        let (afa, efe) = (b.mul(a, fa), b.mul(e, fe));
        let edge = b.sub(afa, efe);
        let m2 = b.add(m0, edge);
        let (aafa, eefe) = (b.mul(a, afa), b.mul(e, efe));
        let edge2 = b.sub(aafa, eefe);
        let m3 = b.add(m1, m1);
        let m3 = b.add(m3, edge2);
        let s2 = b.square(s);
        // c(m), c′(m) = p − 2(2p + q)m + 3(p + q)m², c″/2 = 3(p + q)m − (2p + q), c‴/6 = p + q.
        let Bump { start: p, end: q } = self.bump;
        let cubic = b.add(p, q);
        let square = b.add(p, cubic);
        let value = self.bump.at(b, m);
        let cubic3 = b.scale(cubic, 3.0);
        let bent = b.mul(cubic3, m);
        let half_second = b.sub(bent, square);
        let first = b.sub(half_second, square);
        let first = b.mul(first, m);
        let first = b.add(p, first);
        let s3 = b.mul(s2, s);
        let c1 = b.mul(first, s);
        let c2 = b.mul(half_second, s2);
        let c3 = b.mul(cubic, s3);
        let mean = b.dot(&[value, c1, c2, c3], &[m0, m1, m2, m3]);
        let second = b.add(half_second, half_second);
        let d1 = b.mul(second, s);
        let d2 = b.mul(cubic3, s2);
        let slope = b.dot(&[first, d1, d2], &[m0, m1, m2]);
        // The ends bend by p and −q, and their bends by c″(0) = −2(2p + q) and −c″(1) = −2(p + 2q).
        let sixth = b.scale(cubic, 6.0);
        let e1 = b.mul(sixth, s);
        let curvature = b.dot(&[second, e1], &[m0, m1]);
        let ends = {
            let (left, right) = (b.mul(p, fa), b.mul(q, fe));
            b.sub(left, right)
        };
        let ends = b.mul(ends, inverse);
        let curvature = b.add(curvature, ends);
        let after = b.add(q, cubic);
        let sum = b.dot(&[square, after], &[fa, fe]);
        let sum = b.mul(sum, inverse);
        let sum = b.scale(sum, -2.0);
        let bulk = b.mul(sixth, m0);
        let third = b.add(bulk, sum);
        let inverse2 = b.square(inverse);
        let (left, right) = (b.mul(p, afa), b.mul(q, efe));
        let edge = b.sub(left, right);
        let edge = b.mul(edge, inverse2);
        let third = b.add(third, edge);
        let distortion = b.f32(0.0);
        Moments {
            mean,
            slope,
            curvature,
            third,
            distortion,
        }
    }
}

/// By Gauss–Legendre: derivatives by m act on the density.
fn quadrature(b: &mut Builder, bump: Bump, m: Value, inverse: Value) -> Moments {
    let zero = b.f32(0.0);
    let (mut mean, mut slope, mut curvature, mut third) = (zero, zero, zero, zero);
    for (node, weight) in NODES {
        let at = b.f32(node);
        let distance = b.sub(at, m);
        let z = b.mul(distance, inverse);
        let z = b.clamp(z, -12.0, 12.0);
        let z2 = b.square(z);
        let exponent = b.scale(z2, -0.5);
        let density = b.exp(exponent);
        let density = b.mul(density, inverse);
        let height = bump.at(b, at);
        let weighted = b.scale(density, 0.398_942_3 * weight);
        let weighted = b.mul(weighted, height);
        mean = b.add(mean, weighted);
        let first = b.mul(z, weighted);
        slope = b.add(slope, first);
        let second = b.offset(z2, -1.0);
        let second = b.mul(second, weighted);
        curvature = b.add(curvature, second);
        let cubic = b.offset(z2, -3.0);
        let cubic = b.mul(cubic, first);
        third = b.add(third, cubic);
    }
    let inverse2 = b.square(inverse);
    let inverse3 = b.mul(inverse2, inverse);
    Moments {
        mean,
        slope: b.mul(slope, inverse),
        curvature: b.mul(curvature, inverse2),
        third: b.mul(third, inverse3),
        distortion: zero,
    }
}

/// The probability between two knots, from the tails of the nearer side.
pub(in super::super) fn probability(b: &mut Builder, from: &Normal, to: &Normal) -> Value {
    let by_above = b.sub(to.above, from.above);
    let by_below = b.sub(from.below, to.below);
    let sum = b.add(from.z, to.z);
    let zero = b.f32(0.0);
    let right = b.lt(zero, sum);
    let p = b.select(right, by_above, by_below);
    b.max(p, zero)
}
