//! Matte.

use crate::color::composite::{IMAGES, composite};
use crate::componentwise::product;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Type};

static SPEC: NodeSpec = NodeSpec {
    name: "matte",
    aliases: &["composite_matte"],
    category: Category::Color,
    summary: "A layer that is not premultiplied, over another.",
    doc: Doc {
        computes: "With F, f the colour and alpha of fg and B, b those of bg: out = (F f + B (1 − f), f \
            + b (1 − f)), mixed with bg by mix: bg + mix (… − bg).",
        statistics: "Products of varying signals take their covariance: exact in mean and variance for \
            jointly Gaussian ones, with numbers linear and exact.",
        accuracy: "For jointly Gaussian inputs with spreads up to 0.3 the mean is within 1e-3 and the \
            standard deviation within 0.01. Held by `nodes/src/tests/vector.rs` against dense \
            numerical integration in f64.",
        references: "Porter & Duff 1984, *Compositing Digital Images*, §4. Isserlis 1918, *On a formula \
            for the product-moment coefficient of any order of a normal frequency distribution* \
            (fourth moments from second ones). MaterialX 1.39 specification, node `matte`.",
    },
    inputs: IMAGES,
    output: OutputType::Exactly(Type::Color4),
    class: |_| Behaviour::Product,
    example: r#"{
  "version": 1,
  "name": "matte_example",
  "nodes": {
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "front": {"type": "combine4", "inputs": {"in1": {"node": "bands"}, "in2": 0.4, "in3": 0.1, "in4": {"node": "noise"}}},
    "back": {"type": "combine4", "inputs": {"in1": 0.2, "in2": {"node": "noise"}, "in3": 0.7, "in4": 0.8}},
    "matte": {"type": "matte", "inputs": {"fg": {"node": "front"}, "bg": {"node": "back"}, "mix": 0.9}}
  },
  "outputs": { "out": { "node": "matte" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    composite(lower, node, |lower, fg, bg, k| {
        let hidden = product(lower, &bg[k], &fg[3]);
        let front = match k {
            3 => fg[3].clone(),
            _ => product(lower, &fg[k], &fg[3]),
        };
        let b = lower.b();
        front.add(b, &bg[k]).sub(b, &hidden)
    })
}
