//! The components of a vector or colour, each as an output.

use crate::port;
use crate::port::{any, exactly};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Reach, Type};

macro_rules! separations {
    ($($node:ident {
        aliases: $aliases:expr,
        summary: $summary:literal,
        computes: $computes:literal,
        of: $of:expr,
        outputs: [$first:literal $(, $more:literal)*],
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
                    statistics: "Exact: the components as they are, with all that they share.",
                    accuracy: "Exact. Held by `nodes/src/tests/channel.rs`.",
                    references: cite!(; stringify!($node)),
                },
                inputs: &[
                    $of,
                    port::choice("output", &[$first $(, $more)*], $first, "Which component `out` is."),
                ],
                output: OutputType::Exactly(Type::Float),
                reach: |inputs| {
                    let names = [$first $(, $more)*];
                    let place = names.iter().position(|name| *name == inputs.choice("output"));
                    // The names are those of a colour, then those of a vector.
                    let each = if names.len() == 2 { 2 } else { names.len() / 2 };
                    let index = place.unwrap_or_default() % each;
                    match inputs.components("in") {
                        count if count == 1 || index < count => inputs.reach("in").component(index),
                        _ => Reach::point(if index == 3 { 1.0 } else { 0.0 }),
                    }
                },
                class: |_| Behaviour::Linear,
                example: $example,
            };
            NodeDef::new(&SPEC, component)
        }
    )*};
}

separations! {
    separate2 {
        aliases: &["separate_xy", "decompose2"],
        summary: "The 2 components of a vector, each as an output.",
        computes: "outx = in[0] and outy = in[1].",
        of: exactly(Type::Vector2, "in", 0.0, "The vector."),
        outputs: ["outx", "outy"],
        example: example! { "separate2" => "both", r#"
    "uv": { "type": "texcoord" },
    "separate2": { "type": "separate2", "inputs": { "in": { "node": "uv" } } },
    "both": { "type": "multiply", "inputs": {
        "in1": { "node": "separate2", "output": "outx" }, "in2": { "node": "separate2", "output": "outy" } } }
"# },
    }
    separate3 {
        aliases: &[
            "separate", "separate_rgb", "separate_color", "separate_xyz", "decompose", "decompose3",
            "rgb_split",
        ],
        summary: "The 3 components of a colour or vector, each as an output.",
        computes: "outr = in[0], outg = in[1] and outb = in[2] of a colour; outx, outy and outz are \
            the same of a vector. A float is all of them, and the alpha of a colour that has one is \
            none.",
        of: any("in", 0.0, "The colour or vector."),
        outputs: ["outr", "outg", "outb", "outx", "outy", "outz"],
        example: example! { "separate3" => "swapped", r##"
    "board": { "type": "checkerboard", "inputs": { "color1": "#d0a060", "color2": "#203040" } },
    "separate3": { "type": "separate3", "inputs": { "in": { "node": "board" } } },
    "swapped": { "type": "combine3", "inputs": {
        "in1": { "node": "separate3", "output": "outb" },
        "in2": { "node": "separate3", "output": "outg" },
        "in3": { "node": "separate3", "output": "outr" } } }
"## },
    }
    separate4 {
        aliases: &["separate_rgba", "decompose4"],
        summary: "The 4 components of a colour or vector, each as an output.",
        computes: "outr = in[0], outg = in[1], outb = in[2] and outa = in[3] of a colour; outx, \
            outy, outz and outw are the same of a vector. The alpha of a colour without one is 1.",
        of: any("in", 0.0, "The colour or vector."),
        outputs: ["outr", "outg", "outb", "outa", "outx", "outy", "outz", "outw"],
        example: r##"{
  "version": 1,
  "name": "separate4_example",
  "nodes": {
    "noise": { "type": "noise2d", "inputs": { "frequency": 5, "pivot": 0.5 } },
    "glass": { "type": "colorramp", "inputs": { "in": { "node": "noise" },
        "stops": [ { "at": 0.2, "value": "#20304000" }, { "at": 0.8, "value": "#e0f0ffff" } ] } },
    "separate4": { "type": "separate4", "inputs": { "in": { "node": "glass" } } }
  },
  "outputs": { "out": { "node": "separate4", "output": "outa" } }
}"##,
    }
}

/// The component of `in` that the last letter of `output` names: r, g, b, a or x, y, z, w. Beyond
/// the components of the input, a float is every one, and the alpha of a colour is 1.
fn component<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let bundle = lower.bundle(node, "in");
    let index = match lower.choice(node, "output").chars().last() {
        Some('r' | 'x') => 0,
        Some('g' | 'y') => 1,
        Some('b' | 'z') => 2,
        _ => 3,
    };
    let signal = match &bundle[..] {
        [float] => float.clone(),
        more => more
            .get(index)
            .cloned()
            .unwrap_or_else(|| Signal::constant(lower.b(), if index == 3 { 1.0 } else { 0.0 })),
    };
    vec![signal]
}
