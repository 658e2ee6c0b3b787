//! A gradient along v.

use crate::componentwise::{binary, transfer};
use crate::pattern::ramplr::between;
use mipless_codegen::moments::Piecewise;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "ramptb",
    aliases: &["vertical_gradient"],
    category: Category::Pattern,
    summary: "Goes from one value to another, along v.",
    doc: Doc {
        computes: "out = valuet + t (valueb − valuet) with t = v limited to [0, 1] and (u, v) = texcoord. \
            As in MaterialX, the top is where v is 0.",
        statistics: "A clamp of a Gaussian in closed form, with slope and distortion: exact between \
            constants. Between varying values, a product, as `mix`.",
        accuracy: "Within 1e-6 of the difference of the values. Held by `nodes/src/pattern/tests.rs`.",
        references: "Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8. Bussgang \
            1952, *Crosscorrelation functions of amplitude-distorted Gaussian signals*. MaterialX \
            1.39 specification, node `ramptb`.",
    },
    inputs: &[
        PortSpec::new(
            "valuet",
            PortType::Any,
            Default::Float(0.0),
            "The value at the top.",
        ),
        PortSpec::new(
            "valueb",
            PortType::Any,
            Default::Float(0.0),
            "The value at the bottom.",
        ),
        PortSpec::new(
            "texcoord",
            PortType::Exactly(Type::Vector2),
            Default::Surface,
            "The coordinates.",
        )
        .unit("uv"),
    ],
    output: OutputType::Widest,
    class,
    example: r##"{
  "version": 1,
  "name": "ramptb_example",
  "nodes": {
    "ramptb": { "type": "ramptb", "inputs": { "valuet": "#20303c", "valueb": "#e8c27a" } }
  },
  "outputs": { "out": { "node": "ramptb" } }
}"##,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// A function of position alone, unless a parameter varies.
fn class(inputs: &dyn InputView) -> Behaviour {
    if ["valuet", "valueb"]
        .into_iter()
        .any(|port| inputs.varies(port))
    {
        Behaviour::Function
    } else {
        Behaviour::Pattern
    }
}

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let texcoord = lower.bundle(node, "texcoord");
    let b = lower.b();
    let (zero, one) = (b.f32(0.0), b.f32(1.0));
    let step = Piecewise::clamp(b, zero, one);
    let share = transfer(lower, &texcoord[1], &step);
    binary(lower, node, ["valuet", "valueb"], |lower, from, to| {
        between(lower, from, to, &share)
    })
}
