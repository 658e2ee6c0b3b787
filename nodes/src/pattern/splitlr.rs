//! Two halves along u.

use crate::componentwise::{binary, transfer};
use crate::pattern::ramplr::between;
use mipless_codegen::moments::Piecewise;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "splitlr",
    aliases: &[],
    category: Category::Pattern,
    summary: "One value on one side and another on the other, along u.",
    doc: Doc {
        computes: "out = valuer where u ≥ center, else valuel, with (u, v) = texcoord.",
        statistics: "A step of a Gaussian, Φ in closed form, variance P(1 − P): exact between constants. \
            Between varying values, a product, as `mix`.",
        accuracy: "Within 1e-6 of the difference of the values. Held by `nodes/src/pattern/tests.rs`.",
        references: "Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8. Bussgang \
            1952, *Crosscorrelation functions of amplitude-distorted Gaussian signals*. MaterialX \
            1.39 specification, node `splitlr`.",
    },
    inputs: &[
        PortSpec::new(
            "valuel",
            PortType::Any,
            Default::Float(0.0),
            "The value at the left.",
        ),
        PortSpec::new(
            "valuer",
            PortType::Any,
            Default::Float(0.0),
            "The value at the right.",
        ),
        PortSpec::new(
            "center",
            PortType::Exactly(Type::Float),
            Default::Float(0.5),
            "Where one value meets the other.",
        )
        .unit("uv"),
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
  "name": "splitlr_example",
  "nodes": {
    "splitlr": { "type": "splitlr", "inputs": { "valuel": "#20303c", "valuer": "#e8c27a" } }
  },
  "outputs": { "out": { "node": "splitlr" } }
}"##,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// A function of position alone, unless a parameter varies.
fn class(inputs: &dyn InputView) -> Behaviour {
    if ["valuel", "valuer", "center"]
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
    let centre = lower.number(node, "center");
    let step = Piecewise::step(lower.b(), centre);
    let share = transfer(lower, &texcoord[0], &step);
    binary(lower, node, ["valuel", "valuer"], |lower, from, to| {
        between(lower, from, to, &share)
    })
}
