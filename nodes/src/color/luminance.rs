//! Luminance of a colour.

use crate::componentwise::{numbers, total};
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
    summary: "How bright a colour is, as a grey.",
    doc: Doc {
        computes: "out = (L, L, L) with L = lumacoeffs · in, beside the alpha that in has. The \
            coefficients are those of ACEScg, as in MaterialX; those of Rec. 709 are [0.2126, \
            0.7152, 0.0722]. A number is got from it by `extract`.",
        statistics: "Linear, exact for any distribution as far as the covariances of the channels are \
            carried. Of varying coefficients the means are used.",
        accuracy: "Exact to rounding: the rule is an identity. Held by `nodes/src/tests.rs`, which \
            compares every node with its point value as the footprint goes to 0, in each mode.",
        references: cite!(rec709, linear; "luminance"),
    },
    inputs: &[COLOR, LUMACOEFFS],
    output: OutputType::Colored,
    reach: |_| Reach::ANY,
    class: |_| Behaviour::Linear,
    example: example! { "luminance", r##"
    "board": { "type": "checkerboard", "inputs": { "color1": "#c08a52" } },
    "luminance": { "type": "luminance", "inputs": { "in": { "node": "board" } } }
"## },
};

/// A colour, whose alpha is kept where it has one.
pub(super) const COLOR: PortSpec = PortSpec::new(
    "in",
    PortType::Color,
    Default::Color3([0.0; 3]),
    "The colour.",
);

/// The luminances of the primaries.
pub(super) const LUMACOEFFS: PortSpec = PortSpec::new(
    "lumacoeffs",
    PortType::Exactly(Type::Color3),
    Default::Color3(ACES_CG),
    "The luminances of the primaries.",
);

/// The luminances of the primaries of ACEScg, which MaterialX weighs with.
pub(super) const ACES_CG: [f32; 3] = [0.272_228_7, 0.674_081_8, 0.053_689_5];

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let mut color = lower.bundle(node, "in");
    let alpha = color.split_off(3);
    let weights = numbers(lower, node, "lumacoeffs");
    let weighted = color.iter().zip(weights).map(|(x, weight)| x * weight);
    let mut out = vec![total(lower.b(), weighted); 3];
    out.extend(alpha);
    out
}
