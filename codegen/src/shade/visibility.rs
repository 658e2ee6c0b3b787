//! Which facets a direction sees: Smith's visibility of Gaussian slopes and heights.

use super::Direction;
use crate::ir::{Float, Sym2, Vec2};
use crate::moments::Normal;
use std::f32::consts::PI;

/// What one direction sees of facets with Gaussian slopes.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'b> {
    /// Their mean slope.
    pub mean: Vec2<'b>,
    /// The covariance of their slopes.
    pub covariance: Sym2<'b>,
    /// E[(w·(−s, 1))⁺]: the area that facets show to the direction, over that of the mesh, were none of
    /// them hidden by others.
    pub area: Float<'b>,
    /// Smith's Λ: the facets that face the direction are hidden so often that 1/(1 + Λ) of their area is
    /// seen.
    pub lambda: Float<'b>,
}

impl<'b> Seen<'b> {
    /// Of facets with slopes N(m, S), by the area that they show to `w`.
    ///
    /// With a = w_z − w_xy·m, b² = w_xyᵀ S w_xy, z = a/b and Z = a Φ(z) + b φ(z), the first two moments
    /// are exact (the truncated Gaussian, weighted by its own distance from the cut):
    /// E[s] = m − w Φ/Z, Cov[s] = S − w wᵀ (Φ² − φ Z/b)/Z², with w = S w_xy. Z/a − 1 is Smith's Λ
    /// (Heitz et al. 2014 eq. 2, in which a = cos θ and b = σ sin θ).
    ///
    /// A mean that faces away by more than three standard deviations is taken at three.
    pub fn of([x, y, z]: Direction<'b>, m: Vec2<'b>, s: Sym2<'b>) -> Self {
        let across = Vec2([x, y]);
        let w = s.times(across);
        let b = across.dot(w).max(1e-12).sqrt();
        let a = (z - across.dot(m)).max(-3.0 * b);
        let normal = Normal::at(a, 1.0 / b);
        let area = normal.hinge(a, b).max(1e-7);
        let drawn = normal.below / area;
        let narrowed = drawn.square() - normal.density / (b * area);
        Self {
            mean: m - w * drawn,
            covariance: s - w.outer() * narrowed.max(0.0),
            area,
            lambda: (area / a.max(1e-4) - 1.0).clamp(0.0, 1e4),
        }
    }
}

/// arccos c, |error| ≤ 7e-5 (Abramowitz & Stegun 4.4.45).
fn arccos(c: Float<'_>) -> Float<'_> {
    let x = c.abs().min(1.0);
    let series = 1.570_728_8 + x * (-0.212_114_4 + x * (0.074_261 - 0.018_729_3 * x));
    let angle = (1.0 - x).sqrt() * series;
    c.lt(0.0).select(PI - angle, angle)
}

/// How independent the shadows of two azimuths are, from 0 to 1: 4.41 Δφ/(4.41 Δφ + 1), Δφ in radians
/// (the form and the number of Ashikhmin, Premože & Shirley's correlation as van Ginneken et al. 1998
/// measured it).
fn independence<'b>(view: Direction<'b>, light: Direction<'b>) -> Float<'b> {
    let [o, i] = [view, light].map(|d| Vec2([d[0], d[1]]));
    let lengths = (o.norm2() * i.norm2()).max(1e-20).sqrt();
    let between = 4.41 * arccos(o.dot(i) / lengths);
    between / (between + 1.0)
}

/// 1 + the exponent of the distribution of heights that both directions see.
fn both<'b>(view: &Seen<'b>, light: &Seen<'b>, directions: [Direction<'b>; 2]) -> Float<'b> {
    let x = independence(directions[0], directions[1]);
    let (most, least) = (view.lambda.max(light.lambda), view.lambda.min(light.lambda));
    1.0 + most + x * least
}

/// The share of what the eye sees that the light reaches:
/// (1 + Λ_o)/(1 + max(Λ_o, Λ_i) + x min(Λ_o, Λ_i)), where x blends from the same azimuth, in which the
/// lower direction decides, to azimuths that are independent (Heitz et al. 2014 eq. 12 is x = 1).
pub fn visible<'b>(view: &Seen<'b>, light: &Seen<'b>, directions: [Direction<'b>; 2]) -> Float<'b> {
    (1.0 + view.lambda) / both(view, light, directions)
}

/// The heights that are seen, in standard deviations from the mean.
#[derive(Clone, Copy, Debug)]
pub struct VisibleHeight<'b> {
    /// The mean.
    pub mean: Float<'b>,
    /// The standard deviation.
    pub sd: Float<'b>,
}

impl<'b> VisibleHeight<'b> {
    /// Where a height h is seen with probability Φ(h)^L (Heitz et al. 2014 eq. 15): the law of the largest
    /// of L + 1 normal numbers, whose moments these fit within .0008 for L to 10⁴.
    pub fn of(exponent: Float<'b>) -> Self {
        let exponent = exponent.clamp(0.0, 1e4);
        let l = (1.0 + 0.803_96 * exponent).ln();
        let mean = 1.128_75 * l / (1.0 + 0.661_39 * l).sqrt();
        let l = (1.0 + 0.609_32 * exponent).ln();
        let sd = (-0.558_18 * (1.0 + 0.857_99 * l).ln()).exp();
        Self { mean, sd }
    }

    /// Of what the eye sees and the light reaches.
    pub fn of_both(view: &Seen<'b>, light: &Seen<'b>, directions: [Direction<'b>; 2]) -> Self {
        Self::of(both(view, light, directions) - 1.0)
    }
}
