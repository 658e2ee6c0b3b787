//! Var T − α²v of a piecewise function, as a sum of squares over its pieces.
//!
//! D = Σ_j ∫_j (T(x) − E[T] − α(x − m))² over the Gaussian: each piece contributes a non-negative
//! part, so nothing cancels (RULES, transfers: √D within 3e-5 in f32).

use super::super::{Gaussian, Normal, curve::TEN, normal::probability};
use super::{CLOSEST, Knot, Piecewise, segment::Bump, stretch::Lines};
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
        (lines, normals): (&Lines<'b>, &[Normal<'b>]),
        mean: Float<'b>,
        alpha: Float<'b>,
    ) -> Float<'b> {
        if let ([knot], [n]) = (&self.knots[..], normals) {
            if knot.bend.is_zero() {
                // J² (PQ − φ²).
                return knot.jump.square() * (n.below * n.above - n.density.square()).max(0.0);
            }
            if knot.jump.is_zero() {
                // B² v d(z).
                return knot.bend.square() * n.hinge_distortion() * x.variance;
            }
        }
        let (Some(first), Some(last)) = (normals.first(), normals.last()) else {
            return mean.literal(0.0);
        };
        // The residual of a line, from its value and slope at a knot.
        let residual = |[slope, value]: [Float<'b>; 2], knot: &Knot<'b>| Residual {
            constant: value - mean + slope * (x.mean - knot.at),
            slope: (slope - alpha) * x.sd,
        };
        let (from, to) = (&self.knots[0], &self.knots[self.knots.len() - 1]);
        let mut sum = residual(lines.before, from).below(first);
        for (i, stretch) in lines.between.iter().enumerate() {
            let on = Placed {
                start: stretch.start - mean,
                rise: stretch.rise,
                bump: self.bumps.get(i).filter(|bump| !bump.is_flat()).copied(),
                across: stretch.width * x.inverse_sd,
                tilt: alpha * x.sd,
            };
            let ends = [&normals[i], &normals[i + 1]];
            sum += match on.bump {
                None => {
                    let [from, to] = ends;
                    let line = residual([stretch.slope, stretch.start], &self.knots[i]);
                    // Narrow pieces, over which φ is nearly constant: the truncated moments cancel.
                    (on.across.gt(1.0)).select(line.wide(from, to), on.narrow(from, &THREE))
                }
                Some(_) => {
                    let width = stretch.width.max(CLOSEST);
                    let at = (x.mean - self.knots[i].at) / width;
                    on.bent(ends, [at, x.sd / width])
                }
            };
        }
        sum + residual(lines.after, to).above(last)
    }
}

/// What a stretch is less E[T] + α (x − m), in terms of τ along it.
struct Placed<'b> {
    /// Where it begins, less E[T].
    start: Float<'b>,
    rise: Float<'b>,
    bump: Option<Bump<'b>>,
    /// How long it is in σ.
    across: Float<'b>,
    /// ασ.
    tilt: Float<'b>,
}

impl<'b> Placed<'b> {
    /// The residual at τ and z. Standard scores of knots are limited, so τ and z do not follow from each
    /// other.
    fn at(&self, t: Float<'b>, z: Float<'b>) -> Float<'b> {
        let straight = self.start + self.rise * t - self.tilt * z;
        (self.bump).map_or(straight, |bump| straight + bump.at(t))
    }

    /// z at τ, counted from the end whose score is not limited where the other one's is.
    fn score(&self, from: &Normal<'b>, t: Float<'b>) -> Float<'b> {
        self.across * t - from.z
    }

    /// ∫ r² φ over the stretch, by nodes in τ.
    fn narrow(&self, from: &Normal<'b>, rule: &[(f32, f32)]) -> Float<'b> {
        let nodes = rule.iter().map(|&(node, weight)| {
            let t = self.rise.literal(node);
            let z = self.score(from, t);
            weighted(z, weight) * self.at(t, z).square()
        });
        self.across * self.rise.builder().sum(nodes)
    }

    /// The same with a bump; `place` is τ at m, and τ per σ.
    fn bent(&self, ends: [&Normal<'b>; 2], [at, gain]: [Float<'b>; 2]) -> Float<'b> {
        // The density beyond ±4.5 adds nothing to a wide stretch; τ of a narrow one is exact.
        let [start, end] = ends.map(|edge| (-edge.z).clamp(-4.5, 4.5));
        let wide = self.across.gt(1.0);
        let width = wide.select(end - start, self.across);
        let nodes = TEN.iter().map(|&(node, weight)| {
            let t = self.rise.literal(node);
            let z = start + width * node;
            let z = wide.select(z, self.score(ends[0], t));
            let t = wide.select((at + gain * z).clamp(0.0, 1.0), t);
            weighted(z, weight) * self.at(t, z).square()
        });
        width * self.rise.builder().sum(nodes)
    }
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
        let width = end - start;
        // Narrow pieces, over which φ is nearly constant: the truncated moments cancel.
        let nodes = THREE.iter().map(|&(node, weight)| {
            let z = start + width * node;
            weighted(z, weight) * self.at(z).square()
        });
        let narrow = width * width.builder().sum(nodes);
        width.gt(1.0).select(self.wide(from, to), narrow)
    }

    /// The same between edges that are more than 1 apart.
    fn wide(self, from: &Normal<'b>, to: &Normal<'b>) -> Float<'b> {
        let (start, end) = (-from.z, -to.z);
        let p = probability(from, to);
        let second = p + (start * from.density - end * to.density);
        self.over(p, from.density - to.density, second)
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

/// φ(z) times a weight.
fn weighted(z: Float<'_>, weight: f32) -> Float<'_> {
    (z.square() * -0.5).exp() * (0.398_942_3 * weight)
}
