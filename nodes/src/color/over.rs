//! Layer over layer.

use crate::color::composite::{IMAGES, composite};
use crate::componentwise::product;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Type};

static SPEC: NodeSpec = NodeSpec {
    name: "over",
    aliases: &["alpha_over", "normal_blend", "composite_over"],
    category: Category::Color,
    summary: "One layer over another.",
    doc: Doc {
        computes: "With F, f the colour and alpha of fg and B, b those of bg: out = (F + B (1 − f), f + \
            b (1 − f)), mixed with bg by mix: bg + mix (… − bg).",
        statistics: "Products of varying signals take their covariance: exact in mean and variance for \
            jointly Gaussian ones, with numbers linear and exact.",
        accuracy: "For jointly Gaussian inputs with spreads up to 0.3 the mean is within 1e-3 and the \
            standard deviation within 0.01. Held by `nodes/src/tests/vector.rs` against dense \
            numerical integration in f64.",
        references: "Porter & Duff 1984, *Compositing Digital Images*, §4. Isserlis 1918, *On a formula \
            for the product-moment coefficient of any order of a normal frequency distribution* \
            (fourth moments from second ones). MaterialX 1.39 specification, node `over`.",
    },
    inputs: IMAGES,
    output: OutputType::Exactly(Type::Color4),
    class: |_| Behaviour::Product,
    example: r#"{
  "version": 1,
  "name": "over_example",
  "nodes": {
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "front": {"type": "combine4", "inputs": {"in1": {"node": "bands"}, "in2": 0.4, "in3": 0.1, "in4": {"node": "noise"}}},
    "back": {"type": "combine4", "inputs": {"in1": 0.2, "in2": {"node": "noise"}, "in3": 0.7, "in4": 0.8}},
    "over": {"type": "over", "inputs": {"fg": {"node": "front"}, "bg": {"node": "back"}, "mix": 0.9}}
  },
  "outputs": { "out": { "node": "over" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    composite(lower, node, |lower, fg, bg, k| {
        // B (1 − f) = B − B f.
        let hidden = product(lower, &bg[k], &fg[3]);
        let b = lower.b();
        fg[k].add(b, &bg[k]).sub(b, &hidden)
    })
}
