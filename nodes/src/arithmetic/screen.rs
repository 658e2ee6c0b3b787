//! Screen.

use crate::arithmetic::blend::{LAYERS, blend};
use crate::componentwise::product;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType};

static SPEC: NodeSpec = NodeSpec {
    name: "screen",
    aliases: &["screen_blend"],
    category: Category::Arithmetic,
    summary: "Multiplies what two signals lack of 1.",
    doc: Doc {
        computes: "1 − (1 − fg)(1 − bg). The share of it that is taken is mix: out = bg + mix (… − bg), \
            for each component, without limits.",
        statistics: "fg + bg − fg · bg: a product of varying signals takes its covariance: exact in mean \
            and variance for jointly Gaussian ones. A varying mix is a product as in `mix`.",
        accuracy: "For jointly Gaussian inputs the mean and the standard deviation are those of the \
            function, within 1e-3. Held by `nodes/src/tests/combination.rs` against dense \
            numerical integration in f64.",
        references: "Isserlis 1918, *On a formula for the product-moment coefficient of any order of a \
            normal frequency distribution* (fourth moments from second ones). W3C, *Compositing \
            and Blending Level 1*, §10 (blend modes). MaterialX 1.39 specification, node \
            `screen`.",
    },
    inputs: LAYERS,
    output: OutputType::Widest,
    class: |_| Behaviour::Product,
    example: r#"{
  "version": 1,
  "name": "screen_example",
  "nodes": {
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "screen": {"type": "screen", "inputs": {"fg": {"node": "bands"}, "bg": {"node": "noise"}, "mix": 0.8}}
  },
  "outputs": { "out": { "node": "screen" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    blend(lower, node, |lower, fg, bg| {
        let both = product(lower, fg, bg);
        let b = lower.b();
        fg.add(b, bg).sub(b, &both)
    })
}
