//! Coordinates turned around a centre, most in the middle.

use crate::componentwise::{difference, sum};
use crate::pattern::angle::swirled;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
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
        PortSpec::new(
            "texcoord",
            PortType::Exactly(Type::Vector2),
            Default::Surface,
            "The coordinates.",
        )
        .unit("uv"),
        PortSpec::new(
            "center",
            PortType::Exactly(Type::Vector2),
            Default::Vector2([0.5, 0.5]),
            "The centre.",
        )
        .unit("uv"),
        PortSpec::new(
            "amount",
            PortType::Exactly(Type::Float),
            Default::Float(180.0),
            "The angle in the middle, counter-clockwise.",
        )
        .range(Range::soft(-720.0, 720.0))
        .unit("degrees"),
        PortSpec::new(
            "radius",
            PortType::Exactly(Type::Float),
            Default::Float(0.5),
            "Where the turning ends.",
        )
        .range(Range::hard(1e-6, f32::MAX).with_soft(0.01, 1.0))
        .unit("uv"),
    ],
    output: OutputType::Exactly(Type::Vector2),
    class,
    example: r##"{
  "version": 1,
  "name": "swirl_example",
  "nodes": {
    "swirl": { "type": "swirl", "inputs": { "amount": 240 } },
    "bands": { "type": "stripes", "inputs": { "texcoord": { "node": "swirl" }, "frequency": 10 } }
  },
  "outputs": { "out": { "node": "bands" } }
}"##,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// A function of both coordinates.
fn class(_: &dyn InputView) -> Behaviour {
    Behaviour::Function
}

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let (texcoord, centre) = (lower.bundle(node, "texcoord"), lower.bundle(node, "center"));
    let [amount, radius] = ["amount", "radius"].map(|port| lower.number(node, port));
    let [x, y] = [0, 1].map(|i| difference(lower, &texcoord[i], &centre[i]));
    let [x, y] = swirled(lower, [&x, &y], amount, radius);
    vec![sum(lower, &x, &centre[0]), sum(lower, &y, &centre[1])]
}
