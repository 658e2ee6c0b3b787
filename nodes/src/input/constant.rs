//! A literal.

use crate::port::any;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "constant",
    aliases: &["uniform", "uniform_greyscale", "value", "color", "rgb"],
    category: Category::Input,
    summary: "A number, vector or colour that is the same everywhere.",
    doc: Doc {
        computes: "out = value. The type of the node is that of its literal: a number, two numbers \
            (`vector2`), or a colour.",
        statistics: "Constant: the mean is the value, and there is no spread.",
        accuracy: "Exact. Held by `nodes/src/tests.rs`.",
        references: cite!(; "constant"),
    },
    inputs: &[any("value", 0.0, "The value.").uniform()],
    output: OutputType::Widest,
    reach: |inputs| inputs.reach("value"),
    class: |_| Behaviour::Constant,
    example: example! { "constant", r##"
    "constant": { "type": "constant", "inputs": { "value": "#c08a52" } }
"## },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    lower.bundle(node, "value")
}
