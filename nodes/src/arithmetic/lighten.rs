//! The lighter of two layers.

use crate::arithmetic::blend::{LAYERS, blend};

use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType};

static SPEC: NodeSpec = NodeSpec {
    name: "lighten",
    aliases: &["lighten_blend"],
    category: Category::Arithmetic,
    summary: "The larger of two signals.",
    doc: Doc {
        computes: "max(fg, bg). The share of it that is taken is mix: out = bg + mix (… − bg), for each \
            component, without limits.",
        statistics: "As `max`: Clark’s moments with the covariance. Exact in mean and variance for jointly \
            Gaussian signals. A varying mix is a product as in `mix`.",
        accuracy: "For jointly Gaussian inputs the mean and the standard deviation are those of the \
            function, within 1e-3. Held by `nodes/src/tests/combination.rs` against dense \
            numerical integration in f64.",
        references: "Clark 1961, *The Greatest of a Finite Set of Random Variables*, eqs. 2–6. W3C, \
            *Compositing and Blending Level 1*, §10 (blend modes).",
    },
    inputs: LAYERS,
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "lighten_example",
  "nodes": {
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "lighten": {"type": "lighten", "inputs": {"fg": {"node": "bands"}, "bg": {"node": "noise"}, "mix": 0.8}}
  },
  "outputs": { "out": { "node": "lighten" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    blend(lower, node, |lower, fg, bg| lower.algebra.maximum(fg, bg))
}
