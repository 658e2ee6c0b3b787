//! Polar coordinates.

use crate::coordinate::place::{CENTER, TEXCOORD, centred};
use crate::pattern::angle::polar;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "polar",
    aliases: &[
        "cartesian_to_polar",
        "polar_coordinates",
        "circle_map",
        "radial_tiling",
        "carttopolar",
    ],
    category: Category::Coordinate,
    summary: "Angle and distance from a centre.",
    doc: Doc {
        computes: "out = (θ, r): with p = texcoord − center, θ = the angle of p in turns of [0, 1), \
            counter-clockwise from the u axis, and r = |p|.",
        statistics: "By the Jacobian at the mean, with the curvature's part of the mean of r: E[r]² = |m|² + \
            tr Σ − Var r. Var r goes from the variance along p to that of a Rayleigh number at the \
            centre, Var θ from that across p over 4π²|m|² to that of a uniform angle, 1/12. \
            Approximate within two footprints of the centre. At the cut, where θ jumps from 1 to 0, \
            the footprint goes on beyond 1: exact for whatever repeats with θ.",
        accuracy: "For footprints of up to 0.3 |m| the mean of θ is within 0.02 turns; at the centre the \
            mean of r is within 5 % of the footprint. Held by `nodes/src/pattern/tests.rs`.",
        references: cite!(
            heckbert,
            arctangent,
            "Rice 1945, *Mathematical Analysis of Random Noise* (the distribution of r)."
        ),
    },
    inputs: &[TEXCOORD, CENTER],
    output: OutputType::Exactly(Type::Vector2),
    reach: |_| Reach::ANY,
    class: |_| Behaviour::Function,
    example: example! { "polar" => "rays", r##"
    "polar": { "type": "polar" },
    "rays": { "type": "stripes", "inputs": { "texcoord": { "node": "polar" }, "frequency": 9 } }
"## },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let (_, [x, y]) = centred(lower, node);
    polar(lower, [&x, &y]).to_vec()
}
