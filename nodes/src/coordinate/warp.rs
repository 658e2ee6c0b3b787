//! Coordinates displaced by a signal.

use crate::componentwise::{product, sum};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "warp",
    aliases: &[
        "displace_uv",
        "domain_warp",
        "distortion",
        "directional_warp",
        "vector_warp",
        "warp2",
    ],
    category: Category::Coordinate,
    summary: "Displaces coordinates by any signal.",
    doc: Doc {
        computes: "out = texcoord + strength · in, for each coordinate. One number displaces along both.",
        statistics: "A sum, which is exact. With J = A + strength · ∇in · A the response to the footprint and \
            R what the footprint removed from the signal, whatever reads the coordinates sees the \
            covariance J Jᵀ + strength² R: footprints shrink and grow with the displacement, and its \
            unseen detail blurs.",
        accuracy: "Of a spectral noise of standard deviation 1 that is read at coordinates displaced by two \
            noises of three times its wavelength, by 0.3 of its wavelengths each, the filtered mean \
            is within 0.0004, 0.015 and 0.069 (RMS) at footprints of 0.03, 0.1 and 0.2 wavelengths; \
            without the Jacobian it would be 0.02, 0.16 and 0.25. Displaced by noises of its own \
            wavelength, whose folds a Jacobian does not describe, it is within 0.006, 0.12 and 0.23. \
            Measured by the benchmark `warp`.",
        references: "Bruneton & Neyret 2012, *A Survey of Non-linear Pre-filtering Methods for Efficient and \
            Accurate Surface Shading*, §2.2 (linear maps of a mean and a covariance). Heckbert 1989, \
            *Fundamentals of Texture Mapping and Image Warping*, §3.5.8.",
    },
    inputs: &[
        PortSpec::new(
            "texcoord",
            PortType::Exactly(Type::Vector2),
            Default::Surface,
            "The coordinates.",
        )
        .unit("uv"),
        PortSpec::new(
            "in",
            PortType::Exactly(Type::Vector2),
            Default::Vector2([0.0, 0.0]),
            "The displacement.",
        ),
        PortSpec::new(
            "strength",
            PortType::Exactly(Type::Float),
            Default::Float(0.1),
            "How far a displacement of 1 moves.",
        )
        .range(Range::soft(-1.0, 1.0))
        .unit("uv"),
    ],
    output: OutputType::Exactly(Type::Vector2),
    class,
    example: r##"{
  "version": 1,
  "name": "warp_example",
  "nodes": {
    "swell": { "type": "noise2d", "inputs": { "frequency": 3, "seed": 4 } },
    "warp": { "type": "warp", "inputs": { "in": { "node": "swell" }, "strength": 0.2 } },
    "bands": { "type": "stripes", "inputs": { "texcoord": { "node": "warp" }, "frequency": 9 } }
  },
  "outputs": { "out": { "node": "bands" } }
}"##,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// Linear unless the strength varies with what it multiplies.
fn class(inputs: &dyn InputView) -> Behaviour {
    if inputs.varies("strength") && inputs.varies("in") {
        Behaviour::Product
    } else {
        Behaviour::Linear
    }
}

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let (texcoord, by) = (lower.bundle(node, "texcoord"), lower.bundle(node, "in"));
    let strength = lower.signal(node, "strength");
    (texcoord.iter().zip(&by))
        .map(|(coordinate, by)| {
            let shift = product(lower, by, &strength);
            sum(lower, coordinate, &shift)
        })
        .collect()
}
