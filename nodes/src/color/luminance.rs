//! Luminance of a colour.

use crate::componentwise::total;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Reach, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "luminance",
    aliases: &[
        "rgbtobw",
        "rgb_to_bw",
        "greyscale",
        "grayscale",
        "desaturate",
    ],
    category: Category::Color,
    summary: "How bright a colour is.",
    doc: Doc {
        computes: "out = 0.2126 r + 0.7152 g + 0.0722 b, of a linear Rec. 709 colour.",
        statistics: "Linear, exact for any distribution as far as the covariances of the channels are \
            carried.",
        accuracy: "Exact to rounding: the rule is an identity. Held by `nodes/src/tests.rs`, which \
            compares every node with its point value as the footprint goes to 0, in each mode.",
        references: cite!(rec709, linear; "luminance"),
    },
    inputs: &[PortSpec::new(
        "in",
        PortType::Exactly(Type::Color3),
        Default::Color3([0.0; 3]),
        "The colour.",
    )],
    output: OutputType::Exactly(Type::Float),
    reach: |inputs| Reach([inputs.reach("in").whole(3); 4]),
    class: |_| Behaviour::Linear,
    example: example! { "luminance", r##"
    "board": { "type": "checkerboard", "inputs": { "color1": "#c08a52" } },
    "luminance": { "type": "luminance", "inputs": { "in": { "node": "board" } } }
"## },
};

/// The luminances of the Rec. 709 primaries.
pub(super) const REC_709: [f32; 3] = [0.2126, 0.7152, 0.0722];

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let color = lower.bundle(node, "in");
    let weighted = color.iter().zip(REC_709).map(|(x, weight)| x * weight);
    vec![total(lower.b(), weighted)]
}
