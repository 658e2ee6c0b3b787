//! A gradient along u.

use crate::componentwise::{binary, product, transfer};
use mipless_codegen::moments::{Piecewise, Signal};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "ramplr",
    aliases: &["linear_gradient", "gradient_linear", "gradient_texture"],
    category: Category::Pattern,
    summary: "Goes from one value to another, along u.",
    doc: Doc {
        computes: "out = valuel + t (valuer − valuel) with t = u limited to [0, 1] and (u, v) = texcoord.",
        statistics: "A clamp of a Gaussian in closed form, with slope and distortion: exact between \
            constants. Between varying values, a product, as `mix`.",
        accuracy: "Within 1e-6 of the difference of the values. Held by `nodes/src/pattern/tests.rs`.",
        references: "Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8. Bussgang \
            1952, *Crosscorrelation functions of amplitude-distorted Gaussian signals*. MaterialX \
            1.39 specification, node `ramplr`.",
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
  "name": "ramplr_example",
  "nodes": {
    "ramplr": { "type": "ramplr", "inputs": { "valuel": "#20303c", "valuer": "#e8c27a" } }
  },
  "outputs": { "out": { "node": "ramplr" } }
}"##,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// A function of position alone, unless a parameter varies.
fn class(inputs: &dyn InputView) -> Behaviour {
    if ["valuel", "valuer"]
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
    let share = transfer(lower, &texcoord[0], &step);
    binary(lower, node, ["valuel", "valuer"], |lower, from, to| {
        between(lower, from, to, &share)
    })
}

/// from + share · (to − from).
pub(crate) fn between(lower: &mut Lower<'_>, from: &Signal, to: &Signal, share: &Signal) -> Signal {
    let across = to.sub(lower.b(), from);
    let part = product(lower, &across, share);
    from.add(lower.b(), &part)
}
