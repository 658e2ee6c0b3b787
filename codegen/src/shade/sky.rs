//! A light from all sides: a sky as a polynomial of the second degree.

use super::color::{self, Tint, schlick};
use super::slopes::{nodes, normal, parts};
use super::{Color, Direction, Hiding, Seen, Surface, above, dot3};
use crate::ir::Float;

/// The radiance of a sky by direction, a polynomial of the tangent frame: of each channel the
/// coefficients of 1, x, y, z, xy, yz, zx, z² − ⅓ and x² − y², which span spherical harmonics to the
/// second degree.
#[derive(Clone, Debug)]
pub struct Sky<'b>(pub [[Float<'b>; 9]; 3]);

impl<'b> Sky<'b> {
    /// The radiance around a direction, where a lobe leaves so much of the first and of the second
    /// degree.
    fn around(&self, [x, y, z]: Direction<'b>, keep: [Float<'b>; 2]) -> Color<'b> {
        let second = [
            x * y,
            y * z,
            z * x,
            z.square() - 1.0 / 3.0,
            x.square() - y.square(),
        ];
        std::array::from_fn(|channel| {
            let c = &self.0[channel];
            let b = x.builder();
            let first = b.sum([c[1] * x, c[2] * y, c[3] * z]);
            let second = b.sum((0..5).map(|k| c[4 + k] * second[k]));
            (c[0] + keep[0] * first + keep[1] * second).max(0.0)
        })
    }
}

/// The share of the sky that slopes of this variance leave: 1/(1 + .173 σ^1.444), a fit of Smith's mean
/// over the cosine within .006 to σ = 2.
fn occlusion(variance: Float<'_>) -> Float<'_> {
    let power = (0.722 * variance.max(1e-12).ln()).exp();
    1.0 / (1.0 + 0.173 * power)
}

/// The light of a sky that the surface sends to the eye, without what it emits.
///
/// Matt facets see irradiance, whose first degree is ⅔ and whose second ¼ of the radiance's (Ramamoorthi
/// & Hanrahan 2001). Mirrors see the radiance around the reflected direction, of which GGX leaves
/// 1 − α²/3 and 1 − ¾ α²: all for a mirror, and for α = 1 what a matt facet sees.
fn under<'b>(
    surface: &Surface<'b>,
    view: Direction<'b>,
    sky: &Sky<'b>,
    hiding: Hiding,
) -> Color<'b> {
    let view = above(view);
    let whole = Seen::of(view, surface.slope, surface.covariance);
    let colors = color::of_sky(surface, &whole, hiding);
    let b = surface.roughness.builder();
    let a = surface.alpha().square();
    let cosine = [b.float(2.0 / 3.0), b.float(0.25)];
    let lobe = [1.0 - a / 3.0, 1.0 - 0.75 * a];
    // What is rough mirrors less at grazing angles than Fresnel's law says of one facet.
    let grazing = 1.0 - 0.5 * surface.alpha();

    let parts_of = |surface: &Surface<'b>| {
        parts(surface).map(|part| (part, Seen::of(view, part.mean, part.covariance)))
    };
    let plain = parts_of(surface);
    let area = b.sum(plain.iter().map(|(part, seen)| part.share * seen.area));
    let matt: Color<'b> = std::array::from_fn(|channel| {
        let tint = Tint::of(surface, channel).surface(surface);
        let terms = parts_of(&tint).into_iter().flat_map(|(part, seen)| {
            nodes(seen.mean, seen.covariance).map(move |(slope, weight)| {
                let irradiance = sky.around(normal(slope), cosine)[channel];
                part.share * seen.area * weight * irradiance
            })
        });
        b.sum(terms) / area
    });
    let mut mirrored = colors.map(|_| b.float(0.0));
    for (part, seen) in &plain {
        for (slope, weight) in nodes(seen.mean, seen.covariance) {
            let n = normal(slope);
            let facing = dot3(n, view).max(0.0);
            let reflected = std::array::from_fn(|k| 2.0 * facing * n[k] - view[k]);
            let radiance = sky.around(reflected, lobe);
            let rise = schlick(facing);
            let share = part.share * seen.area * weight / area;
            for (channel, sum) in mirrored.iter_mut().enumerate() {
                let head_on = colors[channel][1];
                let fresnel = head_on + (grazing - head_on).max(0.0) * rise;
                *sum += share * fresnel * radiance[channel];
            }
        }
    }
    let [xx, _, yy] = surface.covariance.0;
    let open = match hiding {
        Hiding::Facets => surface.occlusion * occlusion(0.5 * (xx + yy)),
        Hiding::Nothing => surface.occlusion,
    };
    std::array::from_fn(|channel| {
        let [albedo, _] = colors[channel];
        (open * (albedo * matt[channel] + mirrored[channel])).max(0.0)
    })
}

/// The same of a surface whose numbers may be anything.
pub fn shade_sky<'b>(
    surface: Surface<'b>,
    view: Direction<'b>,
    sky: &Sky<'b>,
    hiding: Hiding,
) -> Color<'b> {
    under(&surface.sane(), view, sky, hiding)
}
