//! A material that stays right at every distance: what a host reads of it.

use super::gradient::{class_of, gradient, of_normal};
use super::microsurface::Microsurface;
use crate::port::{self, choice, number};
use mipless_codegen::ir::{Float, Vec2};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, MaterialPart, Node, NodeSpec, OutputType,
    PortSpec, PortType, Range, Reach, Type,
};

const STANDARD: &str = "standard_surface";
const OPEN: &str = "open_pbr";
const GLTF: &str = "gltf";

/// What the shape of the surface depends on.
const SHAPE: &[&str] = &["height", "scale", "normal", "texcoord"];
const ROUGH_SHAPE: &[&str] = &["roughness", "height", "scale", "normal", "texcoord"];
const COLOR_SHAPE: &[&str] = &["base_color", "height", "scale", "normal", "texcoord"];

/// A mean.
const fn mean(
    name: &'static str,
    ty: Type,
    models: &'static [&'static str],
    reads: &'static [&'static str],
) -> MaterialPart {
    MaterialPart {
        name,
        ty,
        models,
        reads,
        is_mean: true,
        is_joint: false,
    }
}

/// What is no mean of points.
const fn shape(
    name: &'static str,
    ty: Type,
    models: &'static [&'static str],
    reads: &'static [&'static str],
) -> MaterialPart {
    MaterialPart {
        is_mean: false,
        ..mean(name, ty, models, reads)
    }
}

/// What slopes have in common with other signals, and how they are spread.
const fn joint(name: &'static str, ty: Type, reads: &'static [&'static str]) -> MaterialPart {
    MaterialPart {
        is_joint: true,
        ..shape(name, ty, NONE, reads)
    }
}

const ALL: &[&str] = &[STANDARD, OPEN, GLTF];
const NONE: &[&str] = &[];

/// The parts, those of moments last.
const PARTS: &[MaterialPart] = &[
    mean("base_color", Type::Color3, ALL, &["base_color"]),
    mean("metalness", Type::Float, &[STANDARD], &["metallic"]),
    mean("base_metalness", Type::Float, &[OPEN], &["metallic"]),
    mean("metallic", Type::Float, &[GLTF], &["metallic"]),
    shape(
        "specular_roughness",
        Type::Float,
        &[STANDARD, OPEN],
        ROUGH_SHAPE,
    ),
    shape("roughness", Type::Float, &[GLTF], ROUGH_SHAPE),
    shape("specular_anisotropy", Type::Float, &[STANDARD], ROUGH_SHAPE),
    shape("specular_rotation", Type::Float, &[STANDARD], ROUGH_SHAPE),
    shape(
        "specular_roughness_anisotropy",
        Type::Float,
        &[OPEN],
        ROUGH_SHAPE,
    ),
    shape("diffuse_roughness", Type::Float, &[STANDARD], SHAPE),
    shape("base_diffuse_roughness", Type::Float, &[OPEN], SHAPE),
    shape("normal", Type::Vector3, &[STANDARD, GLTF], SHAPE),
    shape("geometry_normal", Type::Vector3, &[OPEN], SHAPE),
    shape("geometry_tangent", Type::Vector3, &[OPEN], ROUGH_SHAPE),
    mean("displacement", Type::Float, ALL, &["height", "scale"]),
    shape(
        "occlusion",
        Type::Float,
        ALL,
        &["occlusion", "height", "scale", "normal", "texcoord"],
    ),
    mean("opacity", Type::Float, &[STANDARD], &["opacity"]),
    mean("geometry_opacity", Type::Float, &[OPEN], &["opacity"]),
    mean("alpha", Type::Float, &[GLTF], &["opacity"]),
    mean(
        "emission_color",
        Type::Color3,
        &[STANDARD, OPEN],
        &["emission"],
    ),
    mean("emissive", Type::Color3, &[GLTF], &["emission"]),
    mean("mean_roughness", Type::Float, NONE, &["roughness"]),
    mean("mean_metallic", Type::Float, NONE, &["metallic"]),
    mean("mean_occlusion", Type::Float, NONE, &["occlusion"]),
    mean("mean_opacity", Type::Float, NONE, &["opacity"]),
    mean("mean_emission", Type::Color3, NONE, &["emission"]),
    shape("normal_map", Type::Color3, NONE, SHAPE),
    shape("slope_mean", Type::Vector2, NONE, SHAPE),
    shape("slope_covariance", Type::Vector3, NONE, SHAPE),
    joint("slope_share", Type::Float, SHAPE),
    joint("cov_color_slope_u", Type::Vector3, COLOR_SHAPE),
    joint("cov_color_slope_v", Type::Vector3, COLOR_SHAPE),
    shape(
        "cov_color_height",
        Type::Vector3,
        NONE,
        &["base_color", "height", "scale"],
    ),
    shape("sigma_height", Type::Float, NONE, &["height", "scale"]),
];

/// The names of the choice `output`: all of the model, then each part.
const NAMES: [&str; PARTS.len() + 1] = {
    let mut names = ["all"; PARTS.len() + 1];
    let mut i = 0;
    while i < PARTS.len() {
        names[i + 1] = PARTS[i].name;
        i += 1;
    }
    names
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "surface",
    aliases: &[
        "material",
        "standard_surface",
        "open_pbr_surface",
        "gltf_pbr",
        "principled_bsdf",
        "disney_principled",
        "UsdPreviewSurface",
    ],
    category: Category::Channel,
    summary: "A material that a host shades right at every distance: it ends a graph, and each of its \
        parts is an output.",
    doc: Doc {
        computes: "An output of the graph that names the node stands for all parts of `model`, under the \
            model's own names; one part alone is `{ \"node\": NAME, \"output\": PART }`. At a point they are \
            the inputs as they are, with the normal of the slopes s of scale · height and of `normal`, \
            n = (−s, 1)/√(1 + |s|²). Over a footprint the slopes have a mean m and a covariance S. Means are \
            base colour, metalness, opacity, emission, `displacement` = scale E[height]. The normal is that \
            of m. Roughness and anisotropy are those of α² = E[roughness]⁴ + 2 S, by the eigenvalues of S as \
            it is seen from the normal, each model by its own formula; `specular_rotation` (in turns) or \
            `geometry_tangent` is the direction of the larger one, and glTF, whose core has no anisotropy, \
            gets the half-sum. Diffuse roughness is Oren and Nayar's σ = √(tr S/2), at most 1. Occlusion is \
            multiplied by 1/(1 + 0.173 σ^1.444), what the filtered valleys hide. Roughness is held in \
            [0.01, 1], the others of 0 to 1 in that. No node reads a surface, a graph has one that stands \
            for all parts, and what no output needs is not computed. For those who shade by moments, and \
            in `all` of no model: means of the inputs, `normal_map` (½ + ½ n, the colour of a map), `slope_mean`, `slope_covariance` (uu, uv, vv), \
            `slope_share`, the covariances of the colour with the slopes (`cov_color_slope_u`, `_v`) and, \
            beyond what the footprint's gradients explain, with the height, and its deviation \
            `sigma_height`.",
        statistics: "Slopes as of `slope`, with their covariance; a normal becomes slopes, −n_xy/n_z, by a \
            cubature. Roughness, normal and occlusion are functions of the moments, so that the method \
            `supersample` gives means of points and no truth for them: the truth is the shaded picture.",
        accuracy: "That of the slopes. A host's GGX of these widths is within 0.24, 0.18 and 0.15 of the \
            convolved lobe (L2 over half-vectors, roughness² 0.05, 0.2 and 0.5, Gaussian slopes of a deviation of \
            0.4), its peak within 20 %; where slopes are 0 on a part of the footprint (cracks, plateaus) it \
            is no better than the mean normal alone.",
        references: "Olano & Baker 2010, *LEAN Mapping*. Dupuy et al. 2013, *Linear Efficient Antialiased \
            Displacement and Reflectance Mapping*. Kaplanyan, Hill, Patney & Lefohn 2016, *Filtering \
            Distributions of Normals for Shading Antialiasing*. Oren & Nayar 1994. MaterialX 1.39, \
            `standard_surface`, `open_pbr_surface`, `gltf_pbr`.",
    },
    inputs: &[
        PortSpec::new(
            "base_color",
            PortType::Exactly(Type::Color3),
            Default::Color3([0.8, 0.8, 0.8]),
            "The colour of diffuse light, of a metal that of its reflections.",
        ),
        number(
            "roughness",
            0.5,
            "How rough the facets are; its square is GGX's α.",
        )
        .range(Range::hard(0.0, 1.0)),
        number("metallic", 0.0, "Whether it is a metal.").range(Range::hard(0.0, 1.0)),
        number(
            "height",
            0.0,
            "The height, times `scale` in units of the texcoord.",
        ),
        number("scale", 1.0, "What the height is multiplied by.").range(Range::soft(0.0, 1.0)),
        PortSpec::new(
            "normal",
            PortType::Exactly(Type::Vector3),
            Default::Color3([0.0, 0.0, 1.0]),
            "A normal in tangent space, as `normalmap` gives it, whose slopes add to the height's.",
        )
        .unit("normal"),
        number(
            "occlusion",
            1.0,
            "What of the light from all sides arrives.",
        )
        .range(Range::hard(0.0, 1.0)),
        number("opacity", 1.0, "What the surface covers.").range(Range::hard(0.0, 1.0)),
        PortSpec::new(
            "emission",
            PortType::Exactly(Type::Color3),
            Default::Color3([0.0, 0.0, 0.0]),
            "The light that it gives.",
        ),
        port::surface("The coordinates along which the height rises, and that tangents follow."),
        choice(
            "model",
            ALL,
            STANDARD,
            "Whose names and formulas the outputs have.",
        ),
        choice(
            "output",
            &NAMES,
            "all",
            "Which part `out` is: `all` for those of the model.",
        ),
    ],
    output: OutputType::Material {
        model: "model",
        parts: PARTS,
    },
    reach: |inputs| match inputs.choice("output") {
        "base_color" => inputs.reach("base_color"),
        "displacement" => inputs.reach("height") * inputs.reach("scale"),
        "emission_color" | "emissive" | "mean_emission" => inputs.reach("emission"),
        "normal" | "geometry_normal" | "geometry_tangent" => Reach::of(-1.0, 1.0),
        name if name.starts_with("slope_") || name.starts_with("cov_") => Reach::ANY,
        "sigma_height" => Reach::ANY,
        _ => Reach::of(0.0, 1.0),
    },
    class,
    example: example! { "surface", r##"
    "stones": { "type": "fractal2d", "inputs": { "frequency": 6 } },
    "color": { "type": "colorramp", "inputs": { "in": { "node": "stones" },
        "stops": [ { "at": -0.5, "value": "#40362c" }, { "at": 0.5, "value": "#b0a898" } ] } },
    "surface": { "type": "surface", "inputs": { "base_color": { "node": "color" }, "roughness": 0.4,
        "height": { "node": "stones" }, "scale": 0.05 } }
"## },
};

fn class(inputs: &dyn InputView) -> Behaviour {
    match inputs.choice("output") {
        "base_color" | "displacement" | "emission_color" | "emissive" | "mean_emission" => {
            Behaviour::Linear
        }
        _ => class_of(inputs, "height"),
    }
}

/// The slopes of the surface: those of the height, and those that the normal means.
fn slopes<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> [Signal<'b>; 2] {
    let scale = lower.number(node, "scale");
    let height = gradient(lower, node, "height").map(|slope| slope * scale);
    let normal = lower.bundle(node, "normal");
    let upright = |at: usize| normal[at].is_certain() && normal[at].mean.is_zero();
    if upright(0) && upright(1) {
        return height;
    }
    let detail = of_normal(lower, &normal);
    [0, 1].map(|i| &height[i] + &detail[i])
}

fn microsurface<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Microsurface<'b> {
    let [u, v] = slopes(lower, node);
    let mean = Vec2([u.flat_mean(), v.flat_mean()]);
    let covariance = [u.variance(), u.covariance(&v).total, v.variance()];
    Microsurface::new(mean, covariance)
}

/// The mean of an input within [least, 1].
fn share<'b>(lower: &Lower<'_, 'b>, node: &Node, port: &str, least: f32) -> Float<'b> {
    lower.number(node, port).clamp(least, 1.0)
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let number = |value: Float<'b>| vec![Signal::certain(value)];
    let numbers = |values: &[Float<'b>]| -> Bundle<'b> {
        values.iter().map(|&value| Signal::certain(value)).collect()
    };
    let name = lower.choice(node, "output");
    match name {
        "base_color" => lower.bundle(node, "base_color"),
        "emission_color" | "emissive" | "mean_emission" => lower.bundle(node, "emission"),
        "metalness" | "base_metalness" | "metallic" | "mean_metallic" => {
            number(share(lower, node, "metallic", 0.0))
        }
        "opacity" | "geometry_opacity" | "alpha" | "mean_opacity" => {
            number(share(lower, node, "opacity", 0.0))
        }
        "mean_roughness" => number(share(lower, node, "roughness", 0.01)),
        "mean_occlusion" => number(share(lower, node, "occlusion", 0.0)),
        "displacement" => {
            let scale = lower.number(node, "scale");
            vec![lower.signal(node, "height").flat() * scale]
        }
        "occlusion" => {
            let own = share(lower, node, "occlusion", 0.0);
            number(own * microsurface(lower, node).openness())
        }
        "diffuse_roughness" | "base_diffuse_roughness" => {
            number(microsurface(lower, node).diffuse_roughness())
        }
        "normal" | "geometry_normal" => numbers(&microsurface(lower, node).normal()),
        "normal_map" => numbers(&microsurface(lower, node).normal().map(|x| x * 0.5 + 0.5)),
        "slope_mean" => numbers(&*microsurface(lower, node).mean()),
        "slope_covariance" => numbers(&*microsurface(lower, node).covariance()),
        "slope_share" => {
            let [u, v] = slopes(lower, node);
            number(Signal::share_of([&u, &v]))
        }
        "cov_color_slope_u" => with_slope(lower, node, 0),
        "cov_color_slope_v" => with_slope(lower, node, 1),
        "cov_color_height" => {
            let scale = lower.number(node, "scale");
            let height = lower.signal(node, "height").flat();
            let colors = lower.bundle(node, "base_color");
            let covariances = colors
                .iter()
                .map(|color| color.covariance(&height).rest * scale);
            covariances.map(Signal::certain).collect()
        }
        "sigma_height" => {
            let scale = lower.number(node, "scale");
            let height = lower.signal(node, "height");
            number(height.other_variance().max(0.0).sqrt() * scale.abs())
        }
        _ => {
            let roughness = share(lower, node, "roughness", 0.01);
            let lobe = microsurface(lower, node).lobe(roughness);
            match name {
                "specular_roughness" if lower.choice(node, "model") == OPEN => {
                    number(lobe.open_pbr())
                }
                "specular_roughness" => number(lobe.standard()[0]),
                "specular_anisotropy" => number(lobe.standard()[1]),
                "specular_rotation" => number(lobe.turns()),
                "specular_roughness_anisotropy" => number(lobe.anisotropy()),
                "geometry_tangent" => numbers(&lobe.tangent()),
                "roughness" => number(lobe.round()),
                other => panic!("{other} is no part of a surface"),
            }
        }
    }
}

/// The covariances of the base colour with a slope.
fn with_slope<'b>(lower: &mut Lower<'_, 'b>, node: &Node, axis: usize) -> Bundle<'b> {
    let slope = slopes(lower, node)[axis].clone();
    let colors = lower.bundle(node, "base_color");
    let covariances = colors.iter().map(|color| color.covariance(&slope).total);
    covariances.map(Signal::certain).collect()
}
