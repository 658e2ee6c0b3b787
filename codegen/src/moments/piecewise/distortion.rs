//! Var T − α²v of a piecewise function, as a sum of squares over its pieces.
//!
//! D = Σ_j ∫_j (T(x) − E[T] − α(x − m))² over the Gaussian: each piece contributes a non-negative
//! part, so nothing cancels (RULES, transfers: √D within 3e-5 in f32).

use super::super::{Gaussian, Normal, curve::TEN};
use super::{
    CLOSEST, Piecewise,
    segment::{Bump, probability},
};
use crate::ir::Float;

/// Nodes and weights of Gauss–Legendre on [0, 1], degree 5.
const THREE: [(f32, f32); 3] = [
    (0.112_701_665, 0.277_777_78),
    (0.5, 0.444_444_44),
    (0.887_298_35, 0.277_777_78),
];

impl<'b> Piecewise<'b> {
    pub(super) fn distortion(
        &self,
        x: &Gaussian<'b>,
        mean: Float<'b>,
        alpha: Float<'b>,
    ) -> Float<'b> {
        let normals: Vec<Normal<'b>> = (self.knots.iter())
            .map(|knot| Normal::at(x.mean - knot.at, x.inverse_sd))
            .collect();
        if let ([knot], [n]) = (&self.knots[..], &normals[..]) {
            if knot.bend.is_zero() {
                // J² (PQ − φ²).
                return knot.jump.square() * (n.below * n.above - n.density.square()).max(0.0);
            }
            if knot.jump.is_zero() {
                // B² v d(z).
                return knot.bend.square() * n.hinge_distortion() * x.variance;
            }
        }
        let mut sum = mean.literal(0.0);
        // The line of the current piece: value at m and slope.
        let mut value = self.offset + self.slope * x.mean;
        let mut slope = self.slope;
        for piece in 0..=self.knots.len() {
            let before = piece.checked_sub(1);
            if let Some(knot) = before.map(|i| self.knots[i]) {
                value += knot.bend * (x.mean - knot.at) + knot.jump;
                slope += knot.bend;
            }
            let residual = Residual {
                constant: value - mean,
                slope: (slope - alpha) * x.sd,
            };
            sum += match (before.map(|i| normals[i]), normals.get(piece)) {
                (Some(from), Some(to)) => match self.bump_on(piece - 1, x) {
                    None => residual.between(&from, to),
                    Some(bump) => residual.between_bent(&from, to, &bump),
                },
                (None, Some(to)) => residual.below(to),
                (Some(from), None) => residual.above(&from),
                (None, None) => mean.literal(0.0),
            };
        }
        sum
    }

    /// The bump between knot `piece` and the next one, if there is one.
    fn bump_on(&self, piece: usize, x: &Gaussian<'b>) -> Option<Placed<'b>> {
        let bump = *self.bumps.get(piece).filter(|bump| !bump.is_flat())?;
        let (from, to) = (self.knots[piece].at, self.knots[piece + 1].at);
        let width = (to - from).max(CLOSEST);
        Some(Placed {
            bump,
            at: (x.mean - from) / width,
            gain: x.sd / width,
        })
    }
}

/// A bump on a piece, and τ = at + gain · z. Standard scores of knots are limited, so τ does not
/// follow from them.
struct Placed<'b> {
    bump: Bump<'b>,
    at: Float<'b>,
    gain: Float<'b>,
}

/// The residual e + f z within a piece.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Residual<'b> {
    /// e.
    pub(in super::super) constant: Float<'b>,
    /// f.
    pub(in super::super) slope: Float<'b>,
}

impl<'b> Residual<'b> {
    fn at(self, z: Float<'b>) -> Float<'b> {
        self.constant + self.slope * z
    }

    /// ∫ (e + f z)² φ between two edges, at least 0.
    pub(in super::super) fn between(self, from: &Normal<'b>, to: &Normal<'b>) -> Float<'b> {
        let (start, end) = (-from.z, -to.z);
        let p = probability(from, to);
        let second = p + (start * from.density - end * to.density);
        let wide = self.over(p, from.density - to.density, second);
        // Narrow pieces, over which φ is nearly constant: the truncated moments cancel.
        let narrow = integrated(start, end, &THREE, |z| self.at(z));
        (end - start).gt(1.0).select(wide, narrow)
    }

    /// The same with a bump on the piece.
    fn between_bent(self, from: &Normal<'b>, to: &Normal<'b>, on: &Placed<'b>) -> Float<'b> {
        // The density beyond ±4.5 adds nothing.
        let [start, end] = [from, to].map(|edge| (-edge.z).clamp(-4.5, 4.5));
        integrated(start, end, &TEN, |z| {
            self.at(z) + on.bump.at((on.at + on.gain * z).clamp(0.0, 1.0))
        })
    }

    /// The same before an edge.
    fn below(self, to: &Normal<'b>) -> Float<'b> {
        self.over(to.above, -to.density, to.above + to.z * to.density)
    }

    /// The same after an edge.
    fn above(self, from: &Normal<'b>) -> Float<'b> {
        let second = from.below - from.z * from.density;
        self.over(from.below, from.density, second)
    }

    /// The same over a piece with truncated moments p, M₁, M₂: p[(e + fμ)² + f² ν].
    fn over(self, p: Float<'b>, first: Float<'b>, second: Float<'b>) -> Float<'b> {
        let p = p.max(1e-20);
        let mu = first / p;
        let nu = (second / p - mu.square()).clamp(0.0, 1.0);
        p * (self.at(mu).square() + self.slope.square() * nu)
    }
}

/// ∫ r(z)² φ from `start` to `end`: Σ w φ(z) r(z)² (end − start) over the nodes.
fn integrated<'b>(
    start: Float<'b>,
    end: Float<'b>,
    rule: &[(f32, f32)],
    residual: impl Fn(Float<'b>) -> Float<'b>,
) -> Float<'b> {
    let width = end - start;
    let parts = rule.iter().map(|&(node, weight)| {
        let z = start + width * node;
        let density = (z.square() * -0.5).exp() * (0.398_942_3 * weight);
        density * residual(z).square()
    });
    width.builder().sum(parts) * width
}
