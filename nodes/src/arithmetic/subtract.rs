//! Difference.

use crate::componentwise::{OPERANDS, binary};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType};

static SPEC: NodeSpec = NodeSpec {
    name: "subtract",
    aliases: &["sub"],
    category: Category::Arithmetic,
    summary: "The difference of two signals.",
    doc: Doc {
        computes: "out = in1 − in2, for each component.",
        statistics: "Exact for any distribution: coefficients subtract, so Var(out) = Var(in1) + Var(in2) \
            − 2 cov(in1, in2); the difference of a signal with itself is 0 without spread.",
        accuracy: "Exact to rounding: the rule is an identity. Held by `nodes/src/tests.rs`, which \
            compares every node with its point value as the footprint goes to 0, in each mode.",
        references: "Bruneton & Neyret 2012, *A Survey of Non-linear Pre-filtering Methods for Efficient \
            and Accurate Surface Shading*, §2.2 (linear maps of a mean and a covariance). \
            MaterialX 1.39 specification, node `subtract`.",
    },
    inputs: OPERANDS,
    output: OutputType::Widest,
    class: |_| Behaviour::Linear,
    example: r#"{
  "version": 1,
  "name": "subtract_example",
  "nodes": {
    "bands": { "type": "stripes", "inputs": { "frequency": 6 } },
    "across": { "type": "stripes", "inputs": { "frequency": 4, "rotate": 90 } },
    "subtract": { "type": "subtract", "inputs": { "in1": { "node": "bands" }, "in2": { "node": "across" } } }
  },
  "outputs": { "out": { "node": "subtract" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    binary(lower, node, ["in1", "in2"], |lower, x, y| {
        x.sub(lower.b(), y)
    })
}
