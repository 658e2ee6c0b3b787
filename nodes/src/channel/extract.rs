//! One component.

use crate::port;
use crate::port::any;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Range, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "extract",
    aliases: &["channel", "swizzle", "channel_select"],
    category: Category::Channel,
    summary: "One component of a vector or colour.",
    doc: Doc {
        computes: "out = in[index], counted from 0. An index beyond the components of the input takes \
            the last one.",
        statistics: "Exact: the component as it is.",
        accuracy: "Exact. Held by `nodes/src/tests.rs`.",
        references: cite!(; "extract"),
    },
    inputs: &[
        any("in", 0.0, "The vector or colour."),
        port::integer("index", 0, "Which component.")
            .uniform()
            .range(Range::hard(0.0, 3.0)),
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |inputs| {
        let last = inputs.components("in") - 1;
        inputs
            .reach("in")
            .component(last.min(inputs.number("index") as usize))
    },
    class: |_| Behaviour::Linear,
    example: example! { "extract", r#"
    "uv": { "type": "texcoord" },
    "extract": { "type": "extract", "inputs": { "in": { "node": "uv" }, "index": 1 } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let mut bundle = lower.bundle(node, "in");
    let index = lower.integer(node, "index").max(0) as usize;
    let last = bundle.len() - 1;
    vec![bundle.swap_remove(index.min(last))]
}
