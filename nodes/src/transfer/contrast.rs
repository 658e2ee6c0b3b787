//! Contrast.

use crate::componentwise::{composed, product, ternary};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Range,
};

static SPEC: NodeSpec = NodeSpec {
    name: "contrast",
    aliases: &["tones_contrast"],
    category: Category::Transfer,
    summary: "Moves a signal away from a pivot, or towards it.",
    doc: Doc {
        computes: "out = (in − pivot) · amount + pivot, for each component.",
        statistics: "By numbers, linear and exact. A varying amount multiplies as `multiply` does.",
        accuracy: "Exact to rounding by numbers; else as `multiply`. Held by `nodes/src/tests/law.rs` \
            against dense numerical integration in f64.",
        references: "Bruneton & Neyret 2012, *A Survey of Non-linear Pre-filtering Methods for Efficient \
            and Accurate Surface Shading*, §2.2 (linear maps of a mean and a covariance). \
            MaterialX 1.39 specification, node `contrast`.",
    },
    inputs: &[
        PortSpec::new("in", PortType::Any, Default::Float(0.0), "The signal."),
        PortSpec::new("amount", PortType::Any, Default::Float(1.0), "The factor.")
            .range(Range::soft(0.0, 4.0)),
        PortSpec::new("pivot", PortType::Any, Default::Float(0.5), "What stays."),
    ],
    output: OutputType::Widest,
    class,
    example: r#"{
  "version": 1,
  "name": "contrast_example",
  "nodes": {
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 10}},
    "wave": {"type": "sin", "inputs": {"in": {"node": "turns"}}},
    "contrast": {"type": "contrast", "inputs": {"in": {"node": "wave"}, "amount": 1.6}}
  },
  "outputs": { "out": { "node": "contrast" } }
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
    let ports = ["in", "amount", "pivot"];
    ternary(lower, node, ports, |lower, x, amount, pivot| {
        composed(lower, |lower| {
            let pivot = lower.algebra.expose(pivot);
            let across = x.sub(lower.b(), &pivot);
            let scaled = product(lower, &across, amount);
            scaled.add(lower.b(), &pivot)
        })
    })
}
