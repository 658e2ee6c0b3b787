//! Conversion between types.

use crate::port;
use crate::port::any;
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Interval, Node, NodeSpec, OutputType, Reach};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "convert",
    aliases: &["cast", "to_vector", "to_color"],
    category: Category::Channel,
    summary: "The same numbers as another type.",
    doc: Doc {
        computes: "out = the components of in, in order, as the type `to`: a float goes to every \
            component; a third that is missing is 0, a fourth that is missing is 1, what is too much \
            is left out. As a boolean it is 1 but for 0, which whole numbers are where they are \
            nearer to it than ½.",
        statistics: "Exact: each component as it is.",
        accuracy: "Exact. Held by `nodes/src/tests/vector.rs` against dense numerical integration in \
            f64.",
        references: cite!(; "convert"),
    },
    inputs: &[
        any("in", 0.0, "What is converted."),
        port::choice(
            "to",
            &[
                "color3", "color4", "vector2", "vector3", "vector4", "float", "integer", "boolean",
            ],
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
            *component = match (inputs.components("in"), i) {
                (1, _) => *component,
                (_, 3) => Interval::point(1.0),
                _ => Interval::point(0.0),
            };
        }
        if inputs.choice("to") == "boolean" {
            return Reach::of(0.0, 1.0);
        }
        reach
    },
    class: |inputs| match inputs.choice("to") {
        "boolean" => Behaviour::Function,
        _ => Behaviour::Linear,
    },
    example: example! { "convert", r#"
    "uv": {"type": "texcoord"},
    "convert": {"type": "convert", "inputs": {"in": {"node": "uv"}, "to": "vector3"}}
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let mut bundle = lower.bundle(node, "in");
    if lower.choice(node, "to") == "boolean" {
        let [one, zero] = [1.0, 0.0].map(|truth| Signal::constant(lower.b(), truth));
        let branches = [one.clone(), zero, one];
        return vec![(lower.algebra).selection(&bundle[0], &[-0.5, 0.5], &branches)];
    }
    let scalar = bundle.len() == 1;
    while bundle.len() < node.ty.components() {
        let next = if scalar {
            bundle[0].clone()
        } else {
            Signal::constant(lower.b(), if bundle.len() == 3 { 1.0 } else { 0.0 })
        };
        bundle.push(next);
    }
    bundle.truncate(node.ty.components());
    bundle
}
