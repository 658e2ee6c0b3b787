//! Var T − α²v of a piecewise function, as a sum of squares over its pieces.
//!
//! D = Σ_j ∫_j (T(x) − E[T] − α(x − m))² over the Gaussian: each piece contributes a non-negative
//! part, so nothing cancels (RULES, transfers: √D within 3e-5 in f32).

use super::super::{Gaussian, Normal, curve::TEN};
use super::{
    Piecewise,
    segment::{Bump, probability},
};
use crate::ir::{Builder, Value};

/// Nodes and weights of Gauss–Legendre on [0, 1], degree 5.
const THREE: [(f32, f32); 3] = [
    (0.112_701_665, 0.277_777_78),
    (0.5, 0.444_444_44),
    (0.887_298_35, 0.277_777_78),
];
impl Piecewise {
    pub(super) fn distortion(
        &self,
        b: &mut Builder,
        x: &Gaussian,
        mean: Value,
        alpha: Value,
    ) -> Value {
        let zero = b.f32(0.0);
        if let [knot] = self.knots[..] {
            let distance = b.sub(x.mean, knot.at);
            let n = Normal::at(b, distance, x.inverse_sd);
            if b.is_zero(knot.bend) {
                // J² (PQ − φ²).
                let pq = b.mul(n.below, n.above);
                let bell = b.square(n.density);
                let d = b.sub(pq, bell);
                let d = b.max(d, zero);
                let square = b.square(knot.jump);
                return b.mul(square, d);
            }
            if b.is_zero(knot.jump) {
                // B² v d(z).
                let d = n.hinge_distortion(b);
                let square = b.square(knot.bend);
                let d = b.mul(square, d);
                return b.mul(d, x.variance);
            }
        }
        let normals: Vec<Normal> = (self.knots.iter())
            .map(|knot| {
                let distance = b.sub(x.mean, knot.at);
                Normal::at(b, distance, x.inverse_sd)
            })
            .collect();
        let mut sum = zero;
        // The line of the current piece: value at m and slope.
        let linear = b.mul(self.slope, x.mean);
        let mut value = b.add(self.offset, linear);
        let mut slope = self.slope;
        for piece in 0..=self.knots.len() {
            if piece > 0 {
                let knot = self.knots[piece - 1];
                let distance = b.sub(x.mean, knot.at);
                let rise = b.mul(knot.bend, distance);
                let rise = b.add(rise, knot.jump);
                value = b.add(value, rise);
                slope = b.add(slope, knot.bend);
            }
            // Within the piece the residual is e + f z.
            let e = b.sub(value, mean);
            let f = b.sub(slope, alpha);
            let f = b.mul(f, x.sd);
            let part = match (piece.checked_sub(1).map(|i| normals[i]), normals.get(piece)) {
                (Some(from), Some(&to)) => {
                    let bump = self.bump_on(b, piece - 1, x);
                    inner(b, &from, &to, e, f, bump)
                }
                (None, Some(to)) => {
                    // z from −∞ to −to.z.
                    let first = b.neg(to.density);
                    let edge = b.mul(to.z, to.density);
                    let second = b.add(to.above, edge);
                    closed(b, to.above, first, second, e, f)
                }
                (Some(from), None) => {
                    let edge = b.mul(from.z, from.density);
                    let second = b.sub(from.below, edge);
                    closed(b, from.below, from.density, second, e, f)
                }
                (None, None) => zero,
            };
            sum = b.add(sum, part);
        }
        sum
    }
}

/// A residual e + f z.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Residual {
    /// e.
    pub(in super::super) constant: Value,
    /// f.
    pub(in super::super) slope: Value,
}

impl Residual {
    /// ∫ (e + f z)² φ between two edges, at least 0.
    pub(in super::super) fn between(self, b: &mut Builder, from: &Normal, to: &Normal) -> Value {
        inner(b, from, to, self.constant, self.slope, None)
    }
}

/// ∫ (e + f z)² φ over a piece with truncated moments p, M₁, M₂: p[(e + fμ)² + f² ν].
fn closed(b: &mut Builder, p: Value, first: Value, second: Value, e: Value, f: Value) -> Value {
    let least = b.f32(1e-20);
    let p = b.max(p, least);
    let mu = b.div(first, p);
    let raw = b.div(second, p);
    let square = b.square(mu);
    let nu = b.sub(raw, square);
    let nu = b.clamp(nu, 0.0, 1.0);
    let shift = b.mul(f, mu);
    let centre = b.add(e, shift);
    let centre = b.square(centre);
    let f2 = b.square(f);
    let spread = b.mul(f2, nu);
    let total = b.add(centre, spread);
    b.mul(p, total)
}

/// A bump on a piece, and τ = at + gain · z. Standard scores of knots are limited, so τ does not
/// follow from them.
struct Placed {
    bump: Bump,
    at: Value,
    gain: Value,
}

impl Piecewise {
    /// The bump between knot `piece` and the next one, if there is one.
    fn bump_on(&self, b: &mut Builder, piece: usize, x: &Gaussian) -> Option<Placed> {
        let bump = self.bumps.get(piece).filter(|bump| !bump.is_flat(b))?;
        let bump = *bump;
        let (from, to) = (self.knots[piece].at, self.knots[piece + 1].at);
        let width = b.sub(to, from);
        let least = b.f32(1e-6);
        let width = b.max(width, least);
        let distance = b.sub(x.mean, from);
        Some(Placed {
            bump,
            at: b.div(distance, width),
            gain: b.div(x.sd, width),
        })
    }
}

/// The part of a piece between two knots, with a bump on it, if any.
fn inner(
    b: &mut Builder,
    from: &Normal,
    to: &Normal,
    e: Value,
    f: Value,
    bump: Option<Placed>,
) -> Value {
    let (a, end) = (b.neg(from.z), b.neg(to.z));
    let Some(Placed { bump, at, gain }) = bump else {
        let p = probability(b, from, to);
        let first = b.sub(from.density, to.density);
        let (left, right) = (b.mul(a, from.density), b.mul(end, to.density));
        let edge = b.sub(left, right);
        let second = b.add(p, edge);
        let wide = closed(b, p, first, second, e, f);
        let narrow = nodes(b, a, end, &THREE, |b, z, _| {
            let line = b.mul(f, z);
            b.add(e, line)
        });
        let width = b.sub(end, a);
        let least = b.f32(1.0);
        let is_wide = b.lt(least, width);
        return b.select(is_wide, wide, narrow);
    };
    // The density beyond ±4.5 adds nothing.
    let (low, high) = (b.clamp(a, -4.5, 4.5), b.clamp(end, -4.5, 4.5));
    nodes(b, low, high, &TEN, |b, z, _| {
        let t = b.mul(gain, z);
        let t = b.add(at, t);
        let t = b.clamp(t, 0.0, 1.0);
        let bump = bump.at(b, t);
        let line = b.mul(f, z);
        let line = b.add(e, line);
        b.add(line, bump)
    })
}

/// Σ w φ(z) r(z)² (end − start) over the nodes.
fn nodes(
    b: &mut Builder,
    start: Value,
    end: Value,
    rule: &[(f32, f32)],
    residual: impl Fn(&mut Builder, Value, f32) -> Value,
) -> Value {
    let width = b.sub(end, start);
    let mut sum = b.f32(0.0);
    for &(node, weight) in rule {
        let step = b.scale(width, node);
        let z = b.add(start, step);
        let square = b.square(z);
        let exponent = b.scale(square, -0.5);
        let density = b.exp(exponent);
        let density = b.scale(density, 0.398_942_3 * weight);
        let r = residual(b, z, node);
        let r = b.square(r);
        let part = b.mul(density, r);
        sum = b.add(sum, part);
    }
    b.mul(sum, width)
}
