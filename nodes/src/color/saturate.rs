//! Saturation.

use crate::componentwise::{composed, exposed, numbers, product};
use mipless_codegen::ir::Value;
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "saturate",
    aliases: &["saturation", "adjust_saturation"],
    category: Category::Color,
    summary: "Moves a colour away from the grey of its luminance, or towards it.",
    doc: Doc {
        computes: "out = L + amount (in − L) with L = lumacoeffs · in; linear Rec. 709, whose \
            coefficients are the default.",
        statistics: "By a number, linear and exact as far as the covariances of the channels are carried. \
            A varying amount multiplies as `multiply` does. Of varying coefficients the means are \
            used.",
        accuracy: "Exact to rounding by a number; else as `multiply`. Held by `nodes/src/tests/color.rs` \
            against dense numerical integration in f64.",
        references: "ITU-R BT.709-6, item 3.2. Bruneton & Neyret 2012, *A Survey of Non-linear \
            Pre-filtering Methods for Efficient and Accurate Surface Shading*, §2.2 (linear maps \
            of a mean and a covariance). MaterialX 1.39 specification, node `saturate`.",
    },
    inputs: &[
        PortSpec::new(
            "in",
            PortType::Exactly(Type::Color3),
            Default::Float(0.0),
            "The colour, linear Rec. 709.",
        ),
        PortSpec::new(
            "amount",
            PortType::Exactly(Type::Float),
            Default::Float(1.0),
            "0 is grey, 1 changes nothing.",
        )
        .range(Range::soft(0.0, 2.0)),
        PortSpec::new(
            "lumacoeffs",
            PortType::Exactly(Type::Color3),
            Default::Color3([0.2126, 0.7152, 0.0722]),
            "The luminances of the primaries.",
        ),
    ],
    output: OutputType::Exactly(Type::Color3),
    class,
    example: r#"{
  "version": 1,
  "name": "saturate_example",
  "nodes": {
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "color": {"type": "combine3", "inputs": {"in1": {"node": "noise"}, "in2": 0.3, "in3": {"node": "bands"}}},
    "saturate": {"type": "saturate", "inputs": {"in": {"node": "color"}, "amount": 0.4}}
  },
  "outputs": { "out": { "node": "saturate" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// Linear but for a varying amount.
fn class(inputs: &dyn InputView) -> Behaviour {
    if inputs.varies("amount") {
        Behaviour::Product
    } else {
        Behaviour::Linear
    }
}

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let color = exposed(lower, node, "in");
    let amount = lower.signal(node, "amount");
    let weights = numbers(lower, node, "lumacoeffs");
    composed(lower, |lower| saturated(lower, &color, &amount, &weights))
}

/// L + amount (in − L).
pub(crate) fn saturated(
    lower: &mut Lower<'_>,
    color: &[Signal],
    amount: &Signal,
    weights: &[Value],
) -> Bundle {
    let b = lower.b();
    let mut grey = Signal::constant(b, 0.0);
    for (channel, &weight) in color.iter().zip(weights) {
        let part = channel.scale(b, weight);
        grey = grey.add(b, &part);
    }
    (color.iter())
        .map(|channel| {
            let apart = channel.sub(lower.b(), &grey);
            let scaled = product(lower, &apart, amount);
            scaled.add(lower.b(), &grey)
        })
        .collect()
}
