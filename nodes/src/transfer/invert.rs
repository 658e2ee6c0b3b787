//! Mirroring at an amount.

use crate::componentwise::binary;
use crate::port::any;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "invert",
    aliases: &["negate", "complement", "oneminus"],
    category: Category::Transfer,
    summary: "An amount less the signal.",
    doc: Doc {
        computes: "out = amount − in, for each component.",
        statistics: "Linear, exact for any distribution.",
        accuracy: "Exact to rounding: the rule is an identity. Held by `nodes/src/tests.rs`, which \
            compares every node with its point value as the footprint goes to 0, in each mode.",
        references: cite!(linear; "invert"),
    },
    inputs: &[
        any("in", 0.0, "The signal."),
        any("amount", 1.0, "What the signal is taken from."),
    ],
    output: OutputType::Widest,
    reach: |inputs| inputs.reach("amount") - inputs.reach("in"),
    class: |_| Behaviour::Linear,
    example: example! { "invert", r#"
    "bands": { "type": "stripes", "inputs": { "frequency": 6 } },
    "invert": { "type": "invert", "inputs": { "in": { "node": "bands" } } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    binary(lower, node, ["amount", "in"], |_, amount, x| amount - x)
}
