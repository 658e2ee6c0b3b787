//! Mirroring at an amount.

use crate::componentwise::binary;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType,
};

static SPEC: NodeSpec = NodeSpec {
    name: "invert",
    aliases: &["negate", "complement", "oneminus"],
    category: Category::Transfer,
    summary: "An amount less the signal.",
    doc: Doc {
        computes: "out = amount − in, for each component.",
        statistics: "Linear, exact for any distribution.",
        accuracy: "Exact to rounding: the rule is an identity. Held by `nodes/src/tests.rs`, which \
            compares every node with its point value as the footprint goes to 0, in each mode.",
        references: "Bruneton & Neyret 2012, *A Survey of Non-linear Pre-filtering Methods for Efficient \
            and Accurate Surface Shading*, §2.2 (linear maps of a mean and a covariance). \
            MaterialX 1.39 specification, node `invert`.",
    },
    inputs: &[
        PortSpec::new("in", PortType::Any, Default::Float(0.0), "The signal."),
        PortSpec::new(
            "amount",
            PortType::Any,
            Default::Float(1.0),
            "What the signal is taken from.",
        ),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Linear,
    example: r#"{
  "version": 1,
  "name": "invert_example",
  "nodes": {
    "bands": { "type": "stripes", "inputs": { "frequency": 6 } },
    "invert": { "type": "invert", "inputs": { "in": { "node": "bands" } } }
  },
  "outputs": { "out": { "node": "invert" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    binary(lower, node, ["amount", "in"], |lower, amount, x| {
        amount.sub(lower.b(), x)
    })
}
