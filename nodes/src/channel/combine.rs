//! Numbers as a vector or colour.

use crate::port::number;
use mipless_codegen::NodeDef;
use mipless_graph::{Behaviour, Category, Doc, NodeSpec, OutputType, PortSpec, Reach, Type};

macro_rules! combinations {
    ($($node:ident -> $ty:ident {
        aliases: $aliases:expr,
        summary: $summary:literal,
        computes: $computes:literal,
        each: $each:literal,
        inputs: $inputs:expr,
        example: $example:expr,
    })*) => {$(
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: stringify!($node),
                aliases: $aliases,
                category: Category::Channel,
                summary: $summary,
                doc: Doc {
                    computes: $computes,
                    statistics: concat!(
                        "Exact: each ", $each,
                        " is its input, and their covariances are those of the inputs."
                    ),
                    accuracy: "Exact. Held by `nodes/src/tests.rs`.",
                    references: cite!(; stringify!($node)),
                },
                inputs: $inputs,
                output: OutputType::Exactly(Type::$ty),
                reach: |inputs| {
                    let ports = SPEC.inputs.iter();
                    Reach::combined(&ports.map(|port| inputs.reach(port.name)).collect::<Vec<_>>())
                },
                class: |_| Behaviour::Linear,
                example: example! { stringify!($node), $example },
            };
            NodeDef::new(&SPEC, |lower, node| {
                let ports = SPEC.inputs.iter();
                ports.map(|port| lower.signal(node, port.name)).collect()
            })
        }
    )*};
}

const RED: PortSpec = number("in1", 0.0, "Red.");
const GREEN: PortSpec = number("in2", 0.0, "Green.");
const BLUE: PortSpec = number("in3", 0.0, "Blue.");

combinations! {
    combine2 -> Vector2 {
        aliases: &["combine_xy"],
        summary: "A vector from two numbers.",
        computes: "out = (in1, in2).",
        each: "component",
        inputs: &[
            number("in1", 0.0, "The first component."),
            number("in2", 0.0, "The second component."),
        ],
        example: r#"
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "across": {"type": "stripes", "inputs": {"frequency": 4, "rotate": 90}},
    "combine2": {"type": "combine2", "inputs": {"in1": {"node": "bands"}, "in2": {"node": "across"}}}
"#,
    }
    combine3 -> Color3 {
        aliases: &["combine", "combine_rgb", "combine_color", "combinexyz"],
        summary: "A colour from three numbers.",
        computes: "out = (in1, in2, in3).",
        each: "channel",
        inputs: &[RED, GREEN, BLUE],
        example: r#"
    "bands": { "type": "stripes", "inputs": { "frequency": 6 } },
    "across": { "type": "stripes", "inputs": { "frequency": 4, "rotate": 90 } },
    "combine3": { "type": "combine3", "inputs": { "in1": { "node": "bands" }, "in2": 0.4, "in3": { "node": "across" } } }
"#,
    }
    combine4 -> Color4 {
        aliases: &["combine_rgba"],
        summary: "A colour with alpha from four numbers.",
        computes: "out = (in1, in2, in3, in4).",
        each: "component",
        inputs: &[RED, GREEN, BLUE, number("in4", 1.0, "Alpha.")],
        example: r#"
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "across": {"type": "stripes", "inputs": {"frequency": 4, "rotate": 90}},
    "combine4": {"type": "combine4", "inputs": {"in1": {"node": "bands"}, "in2": {"node": "across"}}}
"#,
    }
}
