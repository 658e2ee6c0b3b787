//! The slopes of a footprint as a mixture: what lies flat, and a Gaussian of what slopes.

use super::{Direction, Surface, zero};
use crate::ir::{Float, Sym2, Vec2};

/// A part of the facets, with Gaussian slopes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part<'b> {
    /// Its share of the area of the mesh.
    pub(super) share: Float<'b>,
    /// The mean slope.
    pub(super) mean: Vec2<'b>,
    /// The covariance of the slopes.
    pub(super) covariance: Sym2<'b>,
}

impl<'b> Part<'b> {
    /// The area that the mean facet shows to a direction: with what hides facets it is that of all of
    /// them, whatever their slopes are.
    pub(super) fn area(&self, [x, y, z]: Direction<'b>) -> Float<'b> {
        (z - Vec2([x, y]).dot(self.mean)).max(0.0)
    }
}

/// A covariance that is one: its entries limited to 10⁶, the one off the diagonal by the others.
pub(super) fn positive<'b>(s: Sym2<'b>) -> Sym2<'b> {
    let [xx, xy, yy] = s.0;
    let (xx, yy) = (xx.clamp(0.0, 1e6), yy.clamp(0.0, 1e6));
    let most = (xx * yy).sqrt();
    Sym2([xx, xy.clamp(-most, most), yy])
}

/// The least share that slopes, which bounds what is divided by it.
const LEAST: f32 = 0.02;

/// What lies flat, and what slopes: a share p has the mean m/p and the covariance
/// (S + m mᵀ)/p − (m/p)(m/p)ᵀ, which leaves the first two moments of all as they are.
///
/// It holds at every size of the footprint, to the point, if p is that of a closed form: over plateaus at
/// a twentieth of a wavelength it has a fourth of the error of one Gaussian.
pub(super) fn parts<'b>(surface: &Surface<'b>) -> [Part<'b>; 2] {
    let (m, s) = (surface.slope, surface.covariance);
    let share = surface.share.max(LEAST);
    let mean = m * (1.0 / share);
    let second = (s + m.outer()) * (1.0 / share);
    let b = surface.roughness.builder();
    let flat = Part {
        share: 1.0 - share,
        mean: Vec2::splat(zero(b)),
        covariance: Sym2::splat(zero(b)),
    };
    let ramp = Part {
        share,
        mean,
        covariance: positive(second - mean.outer()),
    };
    [flat, ramp]
}

/// Seven nodes for means over a Gaussian of two numbers: exact to the fifth degree (Stroud 1971,
/// E₂^{r²} 5-1). x, y and the weight.
pub(super) const NODES: [[f32; 3]; 7] = {
    const W: f32 = 1.0 / 12.0;
    const R: f32 = 1.732_050_8;
    [
        [0.0, 0.0, 0.5],
        [2.0, 0.0, W],
        [1.0, R, W],
        [-1.0, R, W],
        [-2.0, 0.0, W],
        [-1.0, -R, W],
        [1.0, -R, W],
    ]
};

/// The slopes of the nodes of N(m, S), by Cholesky's factor.
pub(super) fn nodes<'b>(m: Vec2<'b>, s: Sym2<'b>) -> [(Vec2<'b>, f32); 7] {
    let [xx, xy, yy] = positive(s).0;
    let x = xx.sqrt();
    let tilt = xy / x.max(1e-9);
    let y = (yy - tilt.square()).max(0.0).sqrt();
    NODES.map(|[u, v, weight]| (m + Vec2([x * u, tilt * u + y * v]), weight))
}

/// The unit normal of a slope.
pub(super) fn normal<'b>(s: Vec2<'b>) -> Direction<'b> {
    let length = (1.0 + s.norm2()).sqrt();
    let [u, v] = s.0;
    [-u / length, -v / length, 1.0 / length]
}
