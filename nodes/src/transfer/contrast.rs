//! Contrast.

use crate::componentwise::{composed, product, ternary};
use crate::port::any;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType, Range};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "contrast",
    aliases: &["tones_contrast"],
    category: Category::Transfer,
    summary: "Moves a signal away from a pivot, or towards it.",
    doc: Doc {
        computes: "out = (in − pivot) · amount + pivot, for each component.",
        statistics: "By numbers, linear and exact. A varying amount multiplies as `multiply` does.",
        accuracy: "Exact to rounding by numbers; else as `multiply`. Held by `nodes/src/tests/law.rs` \
            against dense numerical integration in f64.",
        references: cite!(linear; "contrast"),
    },
    inputs: &[
        any("in", 0.0, "The signal."),
        any("amount", 1.0, "The factor.").range(Range::soft(0.0, 4.0)),
        any("pivot", 0.5, "What stays."),
    ],
    output: OutputType::Widest,
    reach: |inputs| {
        let pivot = inputs.reach("pivot");
        (inputs.reach("in") - pivot) * inputs.reach("amount") + pivot
    },
    class,
    example: example! { "contrast", r#"
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 10}},
    "wave": {"type": "sin", "inputs": {"in": {"node": "turns"}}},
    "contrast": {"type": "contrast", "inputs": {"in": {"node": "wave"}, "amount": 1.6}}
"# },
};

/// Linear but for a varying amount.
fn class(inputs: &dyn InputView) -> Behaviour {
    if inputs.varies("amount") {
        Behaviour::Product
    } else {
        Behaviour::Linear
    }
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let ports = ["in", "amount", "pivot"];
    ternary(lower, node, ports, |lower, x, amount, pivot| {
        composed(lower, |lower| {
            let pivot = lower.algebra.expose(pivot);
            product(lower, &(x - &pivot), amount) + pivot
        })
    })
}
