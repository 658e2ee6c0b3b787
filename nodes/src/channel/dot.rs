//! A knot in a wire.

use crate::componentwise::unary;
use crate::port::any;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "dot",
    aliases: &["reroute", "pass_through", "relay"],
    category: Category::Channel,
    summary: "Its input as it is, with a note.",
    doc: Doc {
        computes: "out = in. For editors, whose wires bend at it; the note is for readers.",
        statistics: "Exact: the signal as it is.",
        accuracy: "Exact; no code is generated for it. Held by `nodes/src/tests/channel.rs`.",
        references: cite!(; "dot"),
    },
    inputs: &[
        any("in", 0.0, "The signal."),
        PortSpec::new(
            "note",
            PortType::Exactly(Type::String),
            Default::Text(""),
            "Whatever is to be said.",
        ),
    ],
    output: OutputType::Widest,
    reach: |inputs| inputs.reach("in"),
    class: |_| Behaviour::Linear,
    example: example! { "dot", r#"
    "bands": { "type": "stripes", "inputs": { "frequency": 6 } },
    "dot": { "type": "dot", "inputs": { "in": { "node": "bands" }, "note": "to the mask" } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    unary(lower, node, "in", |_, x| x.clone())
}
