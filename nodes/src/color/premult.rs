//! Premultiplication.

use crate::componentwise::{composed, exposed, product};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "premult",
    aliases: &["premultiply"],
    category: Category::Color,
    summary: "Multiplies a colour by its alpha.",
    doc: Doc {
        computes: "out = (r a, g a, b a, a).",
        statistics: "Products of varying signals take their covariance: exact in mean and variance for \
            jointly Gaussian ones, with numbers linear and exact.",
        accuracy: "For jointly Gaussian inputs exact to rounding in mean and variance. Held by \
            `nodes/src/tests/vector.rs` against dense numerical integration in f64.",
        references: "Porter & Duff 1984, *Compositing Digital Images*, §4. Isserlis 1918, *On a formula \
            for the product-moment coefficient of any order of a normal frequency distribution* \
            (fourth moments from second ones). MaterialX 1.39 specification, node `premult`.",
    },
    inputs: &[PortSpec::new(
        "in",
        PortType::Exactly(Type::Color4),
        Default::Float(0.0),
        "The colour and its alpha.",
    )],
    output: OutputType::Exactly(Type::Color4),
    class: |_| Behaviour::Product,
    example: r#"{
  "version": 1,
  "name": "premult_example",
  "nodes": {
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "front": {"type": "combine4", "inputs": {"in1": {"node": "bands"}, "in2": 0.4, "in3": 0.1, "in4": {"node": "noise"}}},
    "back": {"type": "combine4", "inputs": {"in1": 0.2, "in2": {"node": "noise"}, "in3": 0.7, "in4": 0.8}},
    "premult": {"type": "premult", "inputs": {"in": {"node": "front"}}}
  },
  "outputs": { "out": { "node": "premult" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let color = exposed(lower, node, "in");
    composed(lower, |lower| {
        let mut out: Bundle = (0..3)
            .map(|k| product(lower, &color[k], &color[3]))
            .collect();
        out.push(color[3].clone());
        out
    })
}
