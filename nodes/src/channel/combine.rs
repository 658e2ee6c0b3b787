//! Numbers as a vector or colour.

use crate::port;
use crate::port::number;
use mipless_codegen::NodeDef;
use mipless_graph::{
    Behaviour, Category, Default, Doc, NodeSpec, OutputType, PortSpec, PortType, Reach,
};

macro_rules! combinations {
    ($($node:ident -> $output:expr, {
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
                output: $output,
                reach: |inputs| {
                    let ports = SPEC.inputs.iter().filter(|port| !port.uniform);
                    let parts = ports.flat_map(|port| {
                        let reach = inputs.reach(port.name);
                        (0..inputs.components(port.name)).map(move |i| reach.component(i))
                    });
                    Reach::combined(&parts.collect::<Vec<_>>())
                },
                class: |_| Behaviour::Linear,
                example: example! { stringify!($node), $example },
            };
            NodeDef::new(&SPEC, |lower, node| {
                let ports = SPEC.inputs.iter().filter(|port| !port.uniform);
                ports.flat_map(|port| lower.bundle(node, port.name)).collect()
            })
        }
    )*};
}

const RED: PortSpec = number("in1", 0.0, "Red.");
const GREEN: PortSpec = number("in2", 0.0, "Green.");
const BLUE: PortSpec = number("in3", 0.0, "Blue.");

combinations! {
    combine2 -> OutputType::Joined, {
        aliases: &["combine_xy"],
        summary: "A vector from two numbers, or one from two parts.",
        computes: "out = (in1, in2), the components of in1 and then those of in2: two numbers are a \
            vector2, two vectors of two a vector4, a vector3 and a number a vector4, a color3 and a \
            number a color4.",
        each: "component",
        inputs: &[
            PortSpec::new("in1", PortType::Own, Default::Float(0.0), "What comes first."),
            PortSpec::new("in2", PortType::Own, Default::Float(0.0), "What comes after it."),
        ],
        example: r#"
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "across": {"type": "stripes", "inputs": {"frequency": 4, "rotate": 90}},
    "combine2": {"type": "combine2", "inputs": {"in1": {"node": "bands"}, "in2": {"node": "across"}}}
"#,
    }
    combine3 -> OutputType::Named("signature"), {
        aliases: &["combine", "combine_rgb", "combine_color", "combinexyz"],
        summary: "A colour from three numbers.",
        computes: "out = (in1, in2, in3).",
        each: "channel",
        inputs: &[
            RED,
            GREEN,
            BLUE,
            port::choice("signature", &["color3", "vector3"], "color3", "The type of the result."),
        ],
        example: r#"
    "bands": { "type": "stripes", "inputs": { "frequency": 6 } },
    "across": { "type": "stripes", "inputs": { "frequency": 4, "rotate": 90 } },
    "combine3": { "type": "combine3", "inputs": { "in1": { "node": "bands" }, "in2": 0.4, "in3": { "node": "across" } } }
"#,
    }
    combine4 -> OutputType::Named("signature"), {
        aliases: &["combine_rgba"],
        summary: "A colour with alpha from four numbers.",
        computes: "out = (in1, in2, in3, in4).",
        each: "component",
        inputs: &[
            RED,
            GREEN,
            BLUE,
            number("in4", 0.0, "Alpha."),
            port::choice("signature", &["color4", "vector4"], "color4", "The type of the result."),
        ],
        example: r#"
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "across": {"type": "stripes", "inputs": {"frequency": 4, "rotate": 90}},
    "combine4": {"type": "combine4", "inputs": {"in1": {"node": "bands"}, "in2": {"node": "across"}}}
"#,
    }
}
