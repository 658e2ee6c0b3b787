//! Coordinates displaced by a signal.

use crate::componentwise::{product, sum};
use crate::coordinate::place::TEXCOORD;
use crate::port;
use crate::port::number;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType, Range, Reach, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
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
        references: cite!(linear, heckbert),
    },
    inputs: &[
        TEXCOORD,
        port::pair("in", [0.0, 0.0], "The displacement."),
        number("strength", 0.1, "How far a displacement of 1 moves.")
            .range(Range::soft(-1.0, 1.0))
            .unit("uv"),
    ],
    output: OutputType::Exactly(Type::Vector2),
    reach: |_| Reach::ANY,
    class,
    example: example! { "warp" => "bands", r##"
    "swell": { "type": "noise2d", "inputs": { "frequency": 3, "seed": 4 } },
    "warp": { "type": "warp", "inputs": { "in": { "node": "swell" }, "strength": 0.2 } },
    "bands": { "type": "stripes", "inputs": { "texcoord": { "node": "warp" }, "frequency": 9 } }
"## },
};

/// Linear unless the strength varies with what it multiplies.
fn class(inputs: &dyn InputView) -> Behaviour {
    if inputs.varies("strength") && inputs.varies("in") {
        Behaviour::Product
    } else {
        Behaviour::Linear
    }
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let [texcoord, by] = ["texcoord", "in"].map(|port| lower.bundle(node, port));
    let strength = lower.signal(node, "strength");
    (texcoord.iter().zip(&by))
        .map(|(coordinate, by)| sum(coordinate, &product(lower, by, &strength)))
        .collect()
}
