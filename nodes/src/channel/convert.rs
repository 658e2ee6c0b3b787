//! Conversion between types.

use crate::port;
use crate::port::any;
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Interval, Node, NodeSpec, OutputType, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "convert",
    aliases: &["cast", "to_vector", "to_color"],
    category: Category::Channel,
    summary: "The same numbers as another type.",
    doc: Doc {
        computes: "out = the components of in, in order, as the type `to`: a float goes to every \
            component; what is missing is 0, an alpha that is missing is 1, what is too much is \
            left out.",
        statistics: "Exact: each component as it is.",
        accuracy: "Exact. Held by `nodes/src/tests/vector.rs` against dense numerical integration in \
            f64.",
        references: cite!(; "convert"),
    },
    inputs: &[
        any("in", 0.0, "What is converted."),
        port::choice(
            "to",
            &["color3", "color4", "vector2", "vector3", "vector4"],
            "color3",
            "The type of the result.",
        ),
    ],
    output: OutputType::Named("to"),
    reach: |inputs| {
        let mut reach = inputs.reach("in");
        for (i, component) in reach
            .0
            .iter_mut()
            .enumerate()
            .skip(inputs.components("in").max(1))
        {
            *component = match (inputs.components("in"), i, inputs.choice("to")) {
                (_, 3, "color4") => Interval::point(1.0),
                (1, _, _) => *component,
                _ => Interval::point(0.0),
            };
        }
        reach
    },
    class: |_| Behaviour::Linear,
    example: example! { "convert", r#"
    "uv": {"type": "texcoord"},
    "convert": {"type": "convert", "inputs": {"in": {"node": "uv"}, "to": "vector3"}}
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let mut bundle = lower.bundle(node, "in");
    let scalar = bundle.len() == 1;
    while bundle.len() < node.ty.components() {
        let alpha = node.ty == Type::Color4 && bundle.len() == 3;
        let next = if scalar && !alpha {
            bundle[0].clone()
        } else {
            Signal::constant(lower.b(), f32::from(u8::from(alpha)))
        };
        bundle.push(next);
    }
    bundle.truncate(node.ty.components());
    bundle
}
