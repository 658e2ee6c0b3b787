//! Linear light.

use crate::arithmetic::blend::{LAYERS, blend};

use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType};

static SPEC: NodeSpec = NodeSpec {
    name: "linearlight",
    aliases: &["linear_light", "linear_light_blend"],
    category: Category::Arithmetic,
    summary: "Adds or takes away light by how far a signal is from ½.",
    doc: Doc {
        computes: "bg + 2 fg − 1. The share of it that is taken is mix: out = bg + mix (… − bg), for \
            each component, without limits.",
        statistics: "Linear, exact. A varying mix is a product as in `mix`.",
        accuracy: "Exact to rounding. Held by `nodes/src/tests/combination.rs` against dense numerical \
            integration in f64.",
        references: "Bruneton & Neyret 2012, *A Survey of Non-linear Pre-filtering Methods for Efficient \
            and Accurate Surface Shading*, §2.2 (linear maps of a mean and a covariance).",
    },
    inputs: LAYERS,
    output: OutputType::Widest,
    class,
    example: r#"{
  "version": 1,
  "name": "linearlight_example",
  "nodes": {
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "linearlight": {"type": "linearlight", "inputs": {"fg": {"node": "bands"}, "bg": {"node": "noise"}, "mix": 0.8}}
  },
  "outputs": { "out": { "node": "linearlight" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// A varying mix multiplies.
fn class(inputs: &dyn InputView) -> Behaviour {
    if inputs.varies("mix") {
        Behaviour::Product
    } else {
        Behaviour::Linear
    }
}

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    blend(lower, node, |lower, fg, bg| {
        let b = lower.b();
        let (two, minus) = (b.f32(2.0), b.f32(-1.0));
        fg.scale(b, two).offset(b, minus).add(b, bg)
    })
}
