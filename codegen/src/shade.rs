//! `shade`: the light that a filtered surface sends to the eye.
//!
//! A host that knows nothing of filtering shades the mean normal with a widened roughness. This function
//! takes what the footprint knows besides: the covariance of its slopes, the share of it that slopes at
//! all, and how colour goes with slope and height. All formulas are expressions of the IR, so that the
//! CPU evaluator and every shading language compute the same.
//!
//! # Frame and units
//! Directions are unit vectors of the tangent frame: x along u, y along v, z along the normal of the
//! mesh. A slope is the gradient of the height: a facet of slope s has the normal (−s, 1)/√(1 + |s|²).
//! A white matt surface that faces a light is as bright as that light's colour (it is the irradiance
//! over π).
//!
//! # What is averaged
//! A pixel is the mean of its facets by the area that they show to the eye (Heitz et al. 2014, eq. 1).
//! The facets are a mixture: a share 1 − p lies flat, and a share p slopes, with a Gaussian of slopes
//! ([`slopes::Part`]). Of each part the numerators of [`diffuse`] and [`specular`] are summed, over the area
//! of both.

mod color;
mod diffuse;
mod module;
mod sky;
mod slopes;
mod specular;
#[cfg(test)]
mod tests;
mod visibility;

pub use color::Tint;
pub use module::{FIELDS, Lighting, SKY_TERMS, absent, terms_module};
pub use sky::{Sky, shade_sky};
pub use visibility::{Seen, VisibleHeight, visible};

use crate::ir::{Builder, Float, Sym2, Vec2};
use color::schlick;
use slopes::parts;

/// A direction of the tangent frame, of unit length.
pub type Direction<'b> = [Float<'b>; 3];
/// Linear Rec. 709.
pub type Color<'b> = [Float<'b>; 3];

/// What is known of a surface over a footprint.
#[derive(Clone, Debug)]
pub struct Surface<'b> {
    /// The mean of the base colour.
    pub base_color: Color<'b>,
    /// The mean of the roughness, from 0.01 to 1; GGX's α is its square.
    pub roughness: Float<'b>,
    /// The mean of the metallic share, from 0 to 1.
    pub metallic: Float<'b>,
    /// The share of the sky that what is no slope leaves, from 0 to 1.
    pub occlusion: Float<'b>,
    /// The light that the surface sends out by itself.
    pub emission: Color<'b>,
    /// The mean slope m.
    pub slope: Vec2<'b>,
    /// The covariance S of the slopes.
    pub covariance: Sym2<'b>,
    /// The share p of the footprint that is not flat, from 0 to 1: 1 for Gaussian slopes.
    pub share: Float<'b>,
    /// cov(C, s) of each channel of the base colour.
    pub color_slope: [Vec2<'b>; 3],
    /// E[(C − E C)(s − m)(s − m)ᵀ] of each channel; 0 where colour and slope are jointly Gaussian.
    pub color_slope_square: [Sym2<'b>; 3],
    /// cov(C, h) of each channel, of what the place inside the footprint does not explain.
    pub color_height: Color<'b>,
    /// The standard deviation of the height, of the same.
    pub height_sd: Float<'b>,
}

/// The terms of [`shade`] by one light, for a white surface of reflectance 1; for tests and benchmarks.
#[derive(Clone, Debug)]
pub struct Terms<'b> {
    /// Of matt facets, without visibility: E[(n·i)⁺] over what the eye sees, for each channel.
    pub diffuse: Color<'b>,
    /// Of mirrors of GGX: π D G₂/(4 n·o), over what the eye sees.
    pub specular: Float<'b>,
    /// The share of what the eye sees that the light reaches.
    pub lit: Float<'b>,
}

impl<'b> Surface<'b> {
    /// GGX's α of the roughness: the mean of the roughness, squared. Of a mixture it is nearer than the
    /// root of the mean of α² (Hellinger .41 against .48 for α = .1 and .5).
    pub fn alpha(&self) -> Float<'b> {
        self.roughness.clamp(0.01, 1.0).square()
    }

    /// The same with every number inside its domain: slopes to 10³, shares and reflectances to [0, 1], a
    /// covariance that is one.
    fn sane(self) -> Self {
        let share = |x: Float<'b>| x.clamp(0.0, 1.0);
        Self {
            base_color: self.base_color.map(share),
            roughness: self.roughness.clamp(0.01, 1.0),
            metallic: share(self.metallic),
            occlusion: share(self.occlusion),
            emission: self.emission.map(|x| x.max(0.0)),
            slope: self.slope.map(|x| x.clamp(-1e3, 1e3)),
            covariance: slopes::positive(self.covariance),
            share: share(self.share),
            ..self
        }
    }
}

/// Whether facets hide each other from the eye and from the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hiding {
    /// They do, as facets of a height do.
    Facets,
    /// They do not: what a host sees that shades points one by one without shadows, and what pictures of
    /// such points are compared with.
    Nothing,
}

/// The terms of one light, of a surface that is sane.
fn terms<'b>(
    surface: &Surface<'b>,
    view: Direction<'b>,
    light: Direction<'b>,
    hiding: Hiding,
) -> Terms<'b> {
    let (m, s) = (surface.slope, surface.covariance);
    let lit = match hiding {
        Hiding::Nothing => surface.roughness.literal(1.0),
        Hiding::Facets => {
            let seen = [view, light].map(|d| Seen::of(d, m, s));
            visible(&seen[0], &seen[1], [view, light])
        }
    };
    let [flat, ramp] = parts(surface);
    let seen = [&flat, &ramp].map(|part| Seen::of(view, part.mean, part.covariance));
    let area = flat.share * seen[0].area + ramp.share * seen[1].area;

    let tinted = std::array::from_fn(|channel| {
        let tint = Tint::of(surface, channel);
        let [flat, ramp] = parts(&tint.surface(surface));
        let sum = diffuse::numerator(&flat, view, light) + diffuse::numerator(&ramp, view, light);
        sum / area
    });
    let alpha = surface.alpha();
    let mirrored = specular::numerator(&flat, alpha, view, light, hiding)
        + specular::numerator(&ramp, alpha, view, light, hiding);
    let shown = match hiding {
        Hiding::Facets => flat.share * flat.area(view) + ramp.share * ramp.area(view),
        Hiding::Nothing => area,
    };
    Terms {
        diffuse: tinted,
        specular: mirrored / shown.max(1e-4),
        lit,
    }
}

/// The light of one distant source that the surface sends to the eye, with what it emits.
///
/// A light below the mesh's horizon gives nothing, an eye below it sees what one at the horizon would:
/// no direction gives less than 0, or no number.
pub fn shade<'b>(
    surface: Surface<'b>,
    view: Direction<'b>,
    light: Direction<'b>,
    light_color: Color<'b>,
    hiding: Hiding,
) -> Color<'b> {
    let surface = surface.sane();
    let view = above(view);
    let shines = light[2].gt(0.0);
    let light = above(light);
    let terms = terms(&surface, view, light, hiding);
    let half = half_vector(view, light);
    let fresnel = schlick(dot3(half, view));
    let colors = color::of_light(&surface, view, light, half, hiding);
    std::array::from_fn(|channel| {
        let [albedo, mirror] = colors[channel];
        let reflected = mirror + (1.0 - mirror) * fresnel;
        let matt = (1.0 - fresnel) * albedo * terms.diffuse[channel] * terms.lit;
        let light = (matt + reflected * terms.specular) * light_color[channel].max(0.0);
        shines.select(light.max(0.0), 0.0) + surface.emission[channel]
    })
}

/// The direction, at least a hundredth of a degree above the horizon.
fn above(direction: Direction<'_>) -> Direction<'_> {
    let [x, y, z] = direction;
    [x, y, z.max(2e-4)]
}

/// The unit vector halfway between two directions above the horizon.
fn half_vector<'b>(view: Direction<'b>, light: Direction<'b>) -> Direction<'b> {
    let sum: Direction<'b> = std::array::from_fn(|k| view[k] + light[k]);
    let length = dot3(sum, sum).sqrt().max(1e-6);
    sum.map(|x| x / length)
}

/// The scalar product.
fn dot3<'b>(a: Direction<'b>, b: Direction<'b>) -> Float<'b> {
    crate::ir::dot(a, b)
}

/// The constant 0 of a function.
fn zero(b: &Builder) -> Float<'_> {
    b.float(0.0)
}
