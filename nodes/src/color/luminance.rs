//! Luminance of a colour.

use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Type,
};

static SPEC: NodeSpec = NodeSpec {
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
        references: "ITU-R BT.709-6, item 3.2. Bruneton & Neyret 2012, *A Survey of Non-linear \
            Pre-filtering Methods for Efficient and Accurate Surface Shading*, §2.2 (linear maps \
            of a mean and a covariance). MaterialX 1.39 specification, node `luminance`.",
    },
    inputs: &[PortSpec::new(
        "in",
        PortType::Exactly(Type::Color3),
        Default::Color3([0.0; 3]),
        "The colour.",
    )],
    output: OutputType::Exactly(Type::Float),
    class: |_| Behaviour::Linear,
    example: r##"{
  "version": 1,
  "name": "luminance_example",
  "nodes": {
    "board": { "type": "checkerboard", "inputs": { "color1": "#c08a52" } },
    "luminance": { "type": "luminance", "inputs": { "in": { "node": "board" } } }
  },
  "outputs": { "out": { "node": "luminance" } }
}"##,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// The luminances of the Rec. 709 primaries.
const WEIGHTS: [f32; 3] = [0.2126, 0.7152, 0.0722];

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let color = lower.bundle(node, "in");
    let b = lower.b();
    let mut sum = Signal::constant(b, 0.0);
    for (channel, weight) in color.iter().zip(WEIGHTS) {
        let weight = b.f32(weight);
        let part = channel.scale(b, weight);
        sum = sum.add(b, &part);
    }
    vec![sum]
}
