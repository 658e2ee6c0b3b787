//! Magnitude of a difference.

use crate::arithmetic::blend::{LAYERS, blend};
use crate::componentwise::transfer;
use mipless_codegen::moments::Piecewise;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType};

static SPEC: NodeSpec = NodeSpec {
    name: "difference",
    aliases: &["difference_blend", "absolute_difference"],
    category: Category::Arithmetic,
    summary: "How far two signals are apart.",
    doc: Doc {
        computes: "|bg − fg|. The share of it that is taken is mix: out = bg + mix (… − bg), for each \
            component, without limits.",
        statistics: "The folded normal distribution of bg − fg, with the covariance of the two. Exact for \
            jointly Gaussian signals. A varying mix is a product as in `mix`.",
        accuracy: "For jointly Gaussian inputs the mean and the standard deviation are those of the \
            function, within 1e-3. Held by `nodes/src/tests/combination.rs` against dense \
            numerical integration in f64.",
        references: "Leone, Nelson & Nottingham 1961, *The Folded Normal Distribution*. Bussgang 1952, \
            *Crosscorrelation functions of amplitude-distorted Gaussian signals*; Stein 1981, \
            *Estimation of the mean of a multivariate normal distribution*, lemma 1. MaterialX \
            1.39 specification, node `difference`.",
    },
    inputs: LAYERS,
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "difference_example",
  "nodes": {
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "difference": {"type": "difference", "inputs": {"fg": {"node": "bands"}, "bg": {"node": "noise"}, "mix": 0.8}}
  },
  "outputs": { "out": { "node": "difference" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    blend(lower, node, |lower, fg, bg| {
        let b = lower.b();
        let (apart, absolute) = (bg.sub(b, fg), Piecewise::absolute(b));
        transfer(lower, &apart, &absolute)
    })
}
