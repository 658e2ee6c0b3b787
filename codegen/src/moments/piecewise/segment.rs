//! The bump τ(1 − τ)(p(1 − τ) − qτ) that turns a straight segment into a cubic: p and q are by how
//! much the slopes at its ends, in units of the segment, differ from the straight one's. A smooth
//! step of height Δ is p = q = −Δ; p = −q is a parabola.

use super::super::{Gaussian, Normal, normal::probability};
use super::CLOSEST;
use crate::ir::{Float, dot};

/// The slopes p and q of a bump at the two ends of its segment, by τ.
#[derive(Clone, Copy, Debug)]
pub struct Bump<'b> {
    /// p: at τ = 0.
    pub start: Float<'b>,
    /// q: at τ = 1.
    pub end: Float<'b>,
}

impl<'b> Bump<'b> {
    /// p = q = −Δ: the straight segment of height Δ becomes 3τ² − 2τ³.
    pub(super) fn smooth(height: Float<'b>) -> Self {
        Self {
            start: -height,
            end: -height,
        }
    }

    /// The bump at τ in [0, 1].
    pub(super) fn at(self, t: Float<'b>) -> Float<'b> {
        let back = 1.0 - t;
        t * back * (self.start * back - self.end * t)
    }

    /// Its derivative by τ.
    fn steepness(self, t: Float<'b>) -> Float<'b> {
        let back = 1.0 - t;
        let both = 2.0 * (t * back);
        self.start * (back.square() - both) - self.end * (both - t.square())
    }

    /// Whether it is the constant 0.
    pub(super) fn is_flat(self) -> bool {
        self.start.is_zero() && self.end.is_zero()
    }
}

/// A bump between `from` and `to`, else 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment<'b> {
    /// Where it begins.
    pub(super) from: Float<'b>,
    /// Where it ends.
    pub(super) to: Float<'b>,
    /// Its shape.
    pub(super) bump: Bump<'b>,
}

/// Nodes and weights of Gauss–Legendre on [0, 1], degree 7.
const NODES: [(f32, f32); 4] = [
    (0.069_431_844, 0.173_927_42),
    (0.330_009_48, 0.326_072_58),
    (0.669_990_52, 0.326_072_58),
    (0.930_568_16, 0.173_927_42),
];

impl<'b> Segment<'b> {
    fn inverse_width(&self) -> Float<'b> {
        1.0 / (self.to - self.from).max(CLOSEST)
    }

    /// The bump at x.
    pub(super) fn value(&self, x: Float<'b>) -> Float<'b> {
        let t = (x - self.from) * self.inverse_width();
        self.bump.at(t.clamp(0.0, 1.0))
    }

    /// The bump's derivative at x.
    pub(super) fn steepness(&self, x: Float<'b>) -> Float<'b> {
        let inverse = self.inverse_width();
        let t = (x - self.from) * inverse;
        let inside = t.ge(0.0).select(t.le(1.0).select(inverse, 0.0), 0.0);
        self.bump.steepness(t.clamp(0.0, 1.0)) * inside
    }

    /// The mean of the bump and its three derivatives by m; its distortion is not its own but the
    /// whole function's.
    pub(super) fn moments(&self, x: &Gaussian<'b>) -> [Float<'b>; 4] {
        let inverse_width = self.inverse_width();
        // In units of the segment: the mean, and 1/σ.
        let m = (x.mean - self.from) * inverse_width;
        let inverse = (self.to - self.from) * x.inverse_sd;
        let exact = self.truncated(x, m, x.sd * inverse_width, inverse);
        let quadrature = quadrature(self.bump, m, inverse);
        // Below this width in σ the truncated moments cancel and the density is smooth.
        let wide = inverse.gt(1.2);
        std::array::from_fn(|order| {
            let derivative = wide.select(exact[order], quadrature[order]);
            (0..order).fold(derivative, |derivative, _| derivative * inverse_width)
        })
    }

    /// By truncated moments M_k = ∫ zᵏ φ dz over the segment and the Taylor series of the bump at m,
    /// for a Gaussian of mean m and deviation s in units of the segment; `inverse` is 1/s.
    fn truncated(
        &self,
        x: &Gaussian<'b>,
        m: Float<'b>,
        s: Float<'b>,
        inverse: Float<'b>,
    ) -> [Float<'b>; 4] {
        let [left, right] = [self.from, self.to].map(|at| Normal::at(x.mean - at, x.inverse_sd));
        // zᵏφ at both ends.
        let [a, e] = [-left.z, -right.z];
        let [fa, fe] = [left.density, right.density];
        let [afa, efe] = [a * fa, e * fe];
        let m0 = probability(&left, &right);
        let m1 = fa - fe;
        let m2 = m0 + (afa - efe);
        let m3 = m1 + m1 + (a * afa - e * efe);

        // c(m), c′(m) = p − 2(2p + q)m + 3(p + q)m², c″/2 = 3(p + q)m − (2p + q), c‴/6 = p + q.
        let Bump { start: p, end: q } = self.bump;
        let cubic = p + q;
        let square = p + cubic;
        let cubic3 = cubic * 3.0;
        let half_second = cubic3 * m - square;
        let second = half_second + half_second;
        let first = p + (half_second - square) * m;
        let sixth = cubic * 6.0;

        // E[c] and E[c′] over the segment.
        let s2 = s.square();
        let terms = [
            self.bump.at(m),
            first * s,
            half_second * s2,
            cubic * (s2 * s),
        ];
        let mean = dot(terms, [m0, m1, m2, m3]);
        let slope = dot([first, second * s, cubic3 * s2], [m0, m1, m2]);
        // The ends bend by p and −q, and their bends by c″(0) = −2(2p + q) and −c″(1) = −2(p + 2q).
        let bends = (p * fa - q * fe) * inverse;
        let curvature = second * m0 + sixth * s * m1 + bends;
        let bends = (square * fa + (q + cubic) * fe) * inverse * -2.0;
        let third = sixth * m0 + bends + (p * afa - q * efe) * inverse.square();
        [mean, slope, curvature, third]
    }
}

/// By Gauss–Legendre: derivatives by m act on the density.
fn quadrature<'b>(bump: Bump<'b>, m: Float<'b>, inverse: Float<'b>) -> [Float<'b>; 4] {
    let mut sums = [m.literal(0.0); 4];
    for (node, weight) in NODES {
        let z = ((node - m) * inverse).clamp(-12.0, 12.0);
        let z2 = z.square();
        let density = (z2 * -0.5).exp() * inverse;
        let zeroth = density * (0.398_942_3 * weight) * bump.at(m.literal(node));
        let first = z * zeroth;
        let terms = [zeroth, first, (z2 + -1.0) * zeroth, (z2 + -3.0) * first];
        for (sum, term) in sums.iter_mut().zip(terms) {
            *sum += term;
        }
    }
    let inverse2 = inverse.square();
    let [mean, slope, curvature, third] = sums;
    [
        mean,
        slope * inverse,
        curvature * inverse2,
        third * (inverse2 * inverse),
    ]
}
