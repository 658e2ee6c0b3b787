//! Coordinates turned around a centre, most in the middle.

use crate::componentwise::sum;
use crate::coordinate::place::{CENTER, TEXCOORD, centred};
use crate::pattern::angle::swirled;
use crate::port::number;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "swirl",
    aliases: &["twist", "twirl", "swirl_uv"],
    category: Category::Coordinate,
    summary: "Turns coordinates around a centre, most in the middle.",
    doc: Doc {
        computes: "With p = texcoord − center: out = center + R(a) p, R the rotation of `rotate2d` and a = \
            amount · max(1 − |p|/radius, 0)².",
        statistics: "By the exact Jacobian at the mean, R(a) + R′(a) p ∇aᵀ. The angle's own variance s² draws \
            the mean towards the centre by e^{−s²/2}, and since a rotation keeps distances, the \
            spread is limited to tr Σ + |p|²(1 − e^{−s²}).",
        accuracy: "At 180 degrees the mean of the coordinates is within 0.02 of the radius for round \
            footprints of up to a tenth of the radius, within 0.12 for footprints of 8:1 that are a \
            quarter of the radius long. Held by `nodes/src/pattern/tests.rs`.",
        references: "Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8 (the Jacobian \
            of a warp).",
    },
    inputs: &[
        TEXCOORD,
        CENTER,
        number(
            "amount",
            180.0,
            "The angle in the middle, counter-clockwise.",
        )
        .range(Range::soft(-720.0, 720.0))
        .unit("degrees"),
        number("radius", 0.5, "Where the turning ends.")
            .range(Range::hard(1e-6, f32::MAX).with_soft(0.01, 1.0))
            .unit("uv"),
    ],
    output: OutputType::Exactly(Type::Vector2),
    reach: |_| Reach::ANY,
    class: |_| Behaviour::Function,
    example: example! { "swirl" => "bands", r##"
    "swirl": { "type": "swirl", "inputs": { "amount": 240 } },
    "bands": { "type": "stripes", "inputs": { "texcoord": { "node": "swirl" }, "frequency": 10 } }
"## },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let (centre, [x, y]) = centred(lower, node);
    let [amount, radius] = ["amount", "radius"].map(|port| lower.number(node, port));
    let turned = swirled(lower, [&x, &y], amount, radius);
    (turned.iter().zip(&centre))
        .map(|(x, centre)| sum(x, centre))
        .collect()
}
