//! The functions of [`shade`](super) as modules: for the CPU evaluator, and to be written as shaders.

use super::{Color, Hiding, Sky, Surface, above, shade, shade_sky, terms};
use crate::ir::{Builder, Float, Module, Sym2, Vec2};

/// The numbers of a surface by name, in the order in which functions take them, with how many each has:
/// the names are those of a material's parts. Covariances of colour have one vector of the three channels
/// for each component of the slope.
pub const FIELDS: [(&str, usize); 15] = [
    ("base_color", 3),
    ("mean_roughness", 1),
    ("mean_metallic", 1),
    ("mean_occlusion", 1),
    ("mean_emission", 3),
    ("slope_mean", 2),
    ("slope_covariance", 3),
    ("slope_share", 1),
    ("cov_color_slope_u", 3),
    ("cov_color_slope_v", 3),
    ("cov_color_slope_uu", 3),
    ("cov_color_slope_uv", 3),
    ("cov_color_slope_vv", 3),
    ("cov_color_height", 3),
    ("sigma_height", 1),
];

/// What stands for a number of a surface that nothing gives: a white, smooth, matt one.
pub fn absent(field: &str) -> f32 {
    match field {
        "base_color" | "mean_occlusion" | "slope_share" => 1.0,
        "mean_roughness" => 0.5,
        _ => 0.0,
    }
}

/// How many coefficients a sky has for each channel.
pub const SKY_TERMS: usize = 9;

/// What lights the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lighting {
    /// A distant light, with what the surface emits: the arguments are the surface, the directions to the
    /// eye and to the light, and the light's colour.
    Light,
    /// A sky: the arguments are the surface, the direction to the eye, and of each coefficient of the sky
    /// its three channels.
    Sky,
}

impl Lighting {
    /// What functions take after the surface, with how many numbers each has.
    pub const fn arguments(self) -> &'static [(&'static str, usize)] {
        match self {
            Self::Light => &[("view", 3), ("light", 3), ("light_color", 3)],
            Self::Sky => &[("view", 3), ("sky", 3 * SKY_TERMS)],
        }
    }

    /// A module whose entry gives the linear colour of a surface under this light.
    pub fn module(self, hiding: Hiding) -> Module {
        let b = &Builder::new(self.name(), self.doc());
        let surface = declared(b);
        let view = params(b, "view");
        let color = match self {
            Self::Light => {
                let [light, color] = ["light", "light_color"].map(|name| params(b, name));
                shade(surface, view, light, color, hiding)
            }
            Self::Sky => {
                let sky: [Float<'_>; 3 * SKY_TERMS] = params(b, "sky");
                let channel = |c| std::array::from_fn(|k| sky[3 * k + c]);
                shade_sky(surface, view, &Sky([0, 1, 2].map(channel)), hiding)
            }
        };
        b.results(["r", "g", "b"], color);
        finished(b)
    }

    /// What the function is called after the texture's name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Light => "shade",
            Self::Sky => "shade_sky",
        }
    }

    /// One sentence.
    pub const fn doc(self) -> &'static str {
        match self {
            Self::Light => "The light of a distant source that the surface sends to the eye.",
            Self::Sky => "The light of a sky that the surface sends to the eye.",
        }
    }
}

/// A module whose entry gives the [terms](super::Terms) of a surface under a light: three of matt facets,
/// one of mirrors, and the share that is lit.
pub fn terms_module(hiding: Hiding) -> Module {
    let b = &Builder::new("terms", "What a surface makes of a light.");
    let surface = declared(b).sane();
    let [view, light] = ["view", "light"].map(|name| above(params(b, name)));
    let terms = terms(&surface, view, light, hiding);
    b.results(["r", "g", "b"], terms.diffuse);
    b.result("specular", terms.specular);
    b.result("lit", terms.lit);
    finished(b)
}

fn finished(b: &Builder) -> Module {
    let mut module = Module::default();
    b.finish(&mut module);
    module
}

fn params<'b, const N: usize>(b: &'b Builder, name: &str) -> [Float<'b>; N] {
    if N == 1 {
        return std::array::from_fn(|_| b.float_param(name));
    }
    std::array::from_fn(|i| b.float_param(format!("{name}_{i}")))
}

/// A surface of parameters, in the order of [`FIELDS`].
fn declared(b: &Builder) -> Surface<'_> {
    let mut fields = FIELDS.iter();
    let mut name = || fields.next().expect("a name for each field").0;
    let base_color: Color<'_> = params(b, name());
    let [roughness] = params(b, name());
    let [metallic] = params(b, name());
    let [occlusion] = params(b, name());
    let emission = params(b, name());
    let slope = Vec2(params(b, name()));
    let covariance = Sym2(params(b, name()));
    let [share] = params(b, name());
    let [u, v]: [Color<'_>; 2] = std::array::from_fn(|_| params(b, name()));
    let [uu, uv, vv]: [Color<'_>; 3] = std::array::from_fn(|_| params(b, name()));
    let color_height = params(b, name());
    let [height_sd] = params(b, name());
    Surface {
        base_color,
        roughness,
        metallic,
        occlusion,
        emission,
        slope,
        covariance,
        share,
        color_slope: std::array::from_fn(|c| Vec2([u[c], v[c]])),
        color_slope_square: std::array::from_fn(|c| Sym2([uu[c], uv[c], vv[c]])),
        color_height,
        height_sd,
    }
}
