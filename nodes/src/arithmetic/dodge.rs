//! Dodge.

use crate::arithmetic::blend::{LAYERS, blend};
use crate::componentwise::quotient;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType};

static SPEC: NodeSpec = NodeSpec {
    name: "dodge",
    aliases: &["color_dodge", "dodge_blend"],
    category: Category::Arithmetic,
    summary: "Brightens a signal by what another lacks of 1.",
    doc: Doc {
        computes: "bg / (1 − fg), without limits as in MaterialX. A divisor nearer to 0 than 1e-6 is \
            moved to ±1e-6. The share of it that is taken is mix: out = bg + mix (… − bg), for \
            each component, without limits.",
        statistics: "As `divide`: the product with a reciprocal, whose moments exist only where the \
            divisor stays away from 0: its mean is kept at least four standard deviations from \
            it. Approximate. A varying mix is a product as in `mix`.",
        accuracy: "For a divisor at least six standard deviations from 0 the mean is within 1e-3 and the \
            standard deviation within 0.015. Held by `nodes/src/tests/combination.rs` against \
            dense numerical integration in f64.",
        references: "Marsaglia 2006, *Ratios of Normal Variables*, §2 (no moments without truncation). \
            Isserlis 1918, *On a formula for the product-moment coefficient of any order of a \
            normal frequency distribution* (fourth moments from second ones). MaterialX 1.39 \
            specification, node `dodge`.",
    },
    inputs: LAYERS,
    output: OutputType::Widest,
    class,
    example: r#"{
  "version": 1,
  "name": "dodge_example",
  "nodes": {
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "low": {"type": "multiply", "inputs": {"in1": {"node": "bands"}, "in2": 0.4}},
    "dodge": {"type": "dodge", "inputs": {"fg": {"node": "low"}, "bg": {"node": "noise"}}}
  },
  "outputs": { "out": { "node": "dodge" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// A varying divisor bends; a number scales.
fn class(inputs: &dyn InputView) -> Behaviour {
    match (
        inputs.varies("fg"),
        inputs.varies("bg"),
        inputs.varies("mix"),
    ) {
        (false, _, false) => Behaviour::Linear,
        (true, false, false) => Behaviour::Function,
        _ => Behaviour::Product,
    }
}

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    blend(lower, node, |lower, fg, bg| {
        let b = lower.b();
        let one = b.f32(1.0);
        let rest = fg.negate(b).offset(b, one);
        quotient(lower, bg, &rest)
    })
}
