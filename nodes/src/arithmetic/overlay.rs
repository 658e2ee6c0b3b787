//! Overlay.

use crate::arithmetic::blend::overlaid;
use crate::arithmetic::blend::{LAYERS, blend};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType};

static SPEC: NodeSpec = NodeSpec {
    name: "overlay",
    aliases: &["overlay_blend"],
    category: Category::Arithmetic,
    summary: "Darkens what is dark and lightens what is light, by another signal.",
    doc: Doc {
        computes: "2 fg bg where bg < ½, 1 − 2 (1 − fg)(1 − bg) elsewhere. The share of it that is taken \
            is mix: out = bg + mix (… − bg), for each component, without limits.",
        statistics: "With h = max(2bg − 1, 0) in closed form, the result is h + fg (2bg − 2h): a hinge, \
            and a product with the covariance that the factors have. Exact in mean for jointly \
            Gaussian signals; the variance of the product takes its factors for Gaussian. A \
            varying mix is a product as in `mix`.",
        accuracy: "For jointly Gaussian inputs with spreads up to 0.3 the mean is within 1e-3 and the \
            standard deviation within 0.03. Held by `nodes/src/tests/combination.rs` against \
            dense numerical integration in f64.",
        references: "Isserlis 1918, *On a formula for the product-moment coefficient of any order of a \
            normal frequency distribution* (fourth moments from second ones). Bussgang 1952, \
            *Crosscorrelation functions of amplitude-distorted Gaussian signals*; Stein 1981, \
            *Estimation of the mean of a multivariate normal distribution*, lemma 1. W3C, \
            *Compositing and Blending Level 1*, §10 (blend modes). MaterialX 1.39 specification, \
            node `overlay`.",
    },
    inputs: LAYERS,
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "overlay_example",
  "nodes": {
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "overlay": {"type": "overlay", "inputs": {"fg": {"node": "bands"}, "bg": {"node": "noise"}, "mix": 0.8}}
  },
  "outputs": { "out": { "node": "overlay" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    blend(lower, node, overlaid)
}
