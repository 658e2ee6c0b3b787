//! Colour that goes with slope and with height.

use super::slopes::positive;
use super::specular::{mirroring, regression};
use super::{Color, Direction, Hiding, Seen, Surface, VisibleHeight};
use crate::ir::{Float, Sym2, Vec2};

/// The reflectance of what is no metal, of a refractive index of 1.5.
const DIELECTRIC: f32 = 0.04;

/// (1 − cos)⁵: the share of Fresnel's rise (Schlick 1994).
pub(super) fn schlick(cosine: Float<'_>) -> Float<'_> {
    let rest = (1.0 - cosine).clamp(0.0, 1.0);
    rest.square().square() * rest
}

/// The slopes of the facets, each counted as much as one channel of its colour: the coloured
/// distribution of normals. Its moments are E[C s]/E[C] and E[C s sᵀ]/E[C], so that C·f(s) has the mean
/// E[C] times that of f over it.
#[derive(Clone, Copy, Debug)]
pub struct Tint<'b> {
    /// Its mean slope.
    pub mean: Vec2<'b>,
    /// Its covariance.
    pub covariance: Sym2<'b>,
}

impl<'b> Tint<'b> {
    /// Of one channel of the base colour.
    ///
    /// Weights that are nowhere negative move a mean by a few standard deviations at most; four are
    /// allowed, which bounds what dark colours divide by.
    pub fn of(surface: &Surface<'b>, channel: usize) -> Self {
        let (m, s) = (surface.slope, surface.covariance);
        let by = 1.0 / surface.base_color[channel].max(1e-3);
        let [xx, _, yy] = s.0;
        let limits = [xx, yy].map(|v| 4.0 * v.sqrt());
        let shift = surface.color_slope[channel] * by;
        let shift = Vec2(std::array::from_fn(|k| {
            shift[k].clamp(-limits[k], limits[k])
        }));
        let spread = s + surface.color_slope_square[channel] * by - shift.outer();
        Self {
            mean: m + shift,
            covariance: positive(spread),
        }
    }

    /// The surface with these slopes.
    pub(super) fn surface(&self, surface: &Surface<'b>) -> Surface<'b> {
        Surface {
            slope: self.mean,
            covariance: self.covariance,
            ..surface.clone()
        }
    }
}

/// The base colour of what is seen: C goes with the height by its covariance, and the heights that the
/// eye sees and the light reaches lie higher: E[C | visible] = E[C] + cov(C, h)/σ_h μ.
pub(super) fn of_height<'b>(surface: &Surface<'b>, height: &VisibleHeight<'b>) -> Color<'b> {
    let by = height.mean / surface.height_sd.max(1e-9);
    std::array::from_fn(|channel| {
        let raised = surface.base_color[channel] + surface.color_height[channel] * by;
        raised.clamp(0.0, 1.0)
    })
}

/// Of each channel the reflectance of what is matt, and that of mirrors head on.
pub(super) fn of_light<'b>(
    surface: &Surface<'b>,
    view: Direction<'b>,
    light: Direction<'b>,
    half: Direction<'b>,
    hiding: Hiding,
) -> [[Float<'b>; 2]; 3] {
    let colors = match hiding {
        Hiding::Nothing => surface.base_color,
        Hiding::Facets => {
            let seen = [view, light].map(|d| Seen::of(d, surface.slope, surface.covariance));
            let height = VisibleHeight::of_both(&seen[0], &seen[1], [view, light]);
            of_height(surface, &height)
        }
    };
    let (metallic, alpha) = (surface.metallic, surface.alpha());
    let offset = mirroring(half) - surface.slope;
    std::array::from_fn(|channel| {
        let base = colors[channel];
        let there = regression(
            surface.color_slope[channel],
            surface.covariance,
            alpha,
            offset,
        );
        let mirror = (base + there).clamp(0.0, 1.0);
        [
            (1.0 - metallic) * base,
            DIELECTRIC + metallic * (mirror - DIELECTRIC),
        ]
    })
}

/// Of each channel the reflectance of what is matt, and that of mirrors head on, under a light from all
/// sides: of the heights that the eye sees.
pub(super) fn of_sky<'b>(
    surface: &Surface<'b>,
    view: &Seen<'b>,
    hiding: Hiding,
) -> [[Float<'b>; 2]; 3] {
    let colors = match hiding {
        Hiding::Nothing => surface.base_color,
        Hiding::Facets => of_height(surface, &VisibleHeight::of(view.lambda)),
    };
    let metallic = surface.metallic;
    colors.map(|base| {
        [
            (1.0 - metallic) * base,
            DIELECTRIC + metallic * (base - DIELECTRIC),
        ]
    })
}
