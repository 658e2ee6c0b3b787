//! Division by alpha.

use crate::componentwise::{composed, exposed, quotient};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "unpremult",
    aliases: &["unpremultiply"],
    category: Category::Color,
    summary: "Divides a colour by its alpha.",
    doc: Doc {
        computes: "out = (r/a, g/a, b/a, a); an alpha nearer to 0 than 1e-6 is moved to ±1e-6.",
        statistics: "As `divide`: exact by a number; by a varying alpha the moments exist only where it \
            stays away from 0, and its mean is kept at least four standard deviations from it. \
            Approximate.",
        accuracy: "For an alpha at least six standard deviations above 0 the mean is within 1e-3 and the \
            standard deviation within 0.01. Held by `nodes/src/tests/vector.rs` against dense \
            numerical integration in f64.",
        references: "Porter & Duff 1984, *Compositing Digital Images*, §4. Isserlis 1918, *On a formula \
            for the product-moment coefficient of any order of a normal frequency distribution* \
            (fourth moments from second ones). MaterialX 1.39 specification, node `unpremult`.",
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
  "name": "unpremult_example",
  "nodes": {
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "front": {"type": "combine4", "inputs": {"in1": {"node": "bands"}, "in2": 0.4, "in3": 0.1, "in4": {"node": "noise"}}},
    "back": {"type": "combine4", "inputs": {"in1": 0.2, "in2": {"node": "noise"}, "in3": 0.7, "in4": 0.8}},
    "unpremult": {"type": "unpremult", "inputs": {"in": {"node": "back"}}}
  },
  "outputs": { "out": { "node": "unpremult" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let color = exposed(lower, node, "in");
    composed(lower, |lower| {
        let mut out: Bundle = (0..3)
            .map(|k| quotient(lower, &color[k], &color[3]))
            .collect();
        out.push(color[3].clone());
        out
    })
}
