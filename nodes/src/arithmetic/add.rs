//! Sum.

use crate::componentwise::{OPERANDS, binary};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType};

static SPEC: NodeSpec = NodeSpec {
    name: "add",
    aliases: &["sum", "linear_dodge"],
    category: Category::Arithmetic,
    summary: "The sum of two signals.",
    doc: Doc {
        computes: "out = in1 + in2, for each component.",
        statistics: "Exact for any distribution: means and coefficients add, so Var(out) = Var(in1) + \
            Var(in2) + 2 cov(in1, in2), with the covariance of what both inputs share.",
        accuracy: "Exact to rounding: the rule is an identity. Held by `nodes/src/tests.rs`, which \
            compares every node with its point value as the footprint goes to 0, in each mode.",
        references: "Bruneton & Neyret 2012, *A Survey of Non-linear Pre-filtering Methods for Efficient \
            and Accurate Surface Shading*, §2.2 (linear maps of a mean and a covariance). \
            MaterialX 1.39 specification, node `add`.",
    },
    inputs: OPERANDS,
    output: OutputType::Widest,
    class: |_| Behaviour::Linear,
    example: r#"{
  "version": 1,
  "name": "add_example",
  "nodes": {
    "bands": { "type": "stripes", "inputs": { "frequency": 6 } },
    "across": { "type": "stripes", "inputs": { "frequency": 4, "rotate": 90 } },
    "add": { "type": "add", "inputs": { "in1": { "node": "bands" }, "in2": { "node": "across" } } }
  },
  "outputs": { "out": { "node": "add" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    binary(lower, node, ["in1", "in2"], |lower, x, y| {
        x.add(lower.b(), y)
    })
}
