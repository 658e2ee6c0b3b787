//! Disjoint layers.

use crate::color::composite::{IMAGES, composite};
use crate::componentwise::{product, quotient};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Type};

static SPEC: NodeSpec = NodeSpec {
    name: "disjointover",
    aliases: &["disjoint_over"],
    category: Category::Color,
    summary: "One layer over another, which do not overlap while there is room.",
    doc: Doc {
        computes: "With F, f the colour and alpha of fg and B, b those of bg: out = (F + B min(1, (1 − \
            f)/b), min(f + b, 1)), mixed with bg by mix: bg + mix (… − bg).",
        statistics: "The quotient and the minimum as `divide` and `min`, then a product with the \
            covariance. Approximate where the alphas vary.",
        accuracy: "For alphas at least four standard deviations above 0 the mean is within 0.005 and the \
            standard deviation within 0.02. Held by `nodes/src/tests/vector.rs` against dense \
            numerical integration in f64.",
        references: "MaterialX, *Physically Based Shading Nodes and Standard Nodes*. Isserlis 1918, *On a \
            formula for the product-moment coefficient of any order of a normal frequency \
            distribution* (fourth moments from second ones). MaterialX 1.39 specification, node \
            `disjointover`.",
    },
    inputs: IMAGES,
    output: OutputType::Exactly(Type::Color4),
    class: |_| Behaviour::Product,
    example: r#"{
  "version": 1,
  "name": "disjointover_example",
  "nodes": {
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "front": {"type": "combine4", "inputs": {"in1": {"node": "bands"}, "in2": 0.4, "in3": 0.1, "in4": {"node": "noise"}}},
    "back": {"type": "combine4", "inputs": {"in1": 0.2, "in2": {"node": "noise"}, "in3": 0.7, "in4": 0.8}},
    "disjointover": {"type": "disjointover", "inputs": {"fg": {"node": "front"}, "bg": {"node": "back"}, "mix": 0.9}}
  },
  "outputs": { "out": { "node": "disjointover" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    composite(lower, node, |lower, fg, bg, k| {
        let b = lower.b();
        let one = Signal::constant(b, 1.0);
        if k == 3 {
            let sum = fg[3].add(b, &bg[3]);
            return lower.algebra.minimum(&sum, &one);
        }
        let rest = one.sub(b, &fg[3]);
        let share = quotient(lower, &rest, &bg[3]);
        let share = lower.algebra.minimum(&share, &one);
        let behind = product(lower, &bg[k], &share);
        fg[k].add(lower.b(), &behind)
    })
}
