//! The 3 components of a colour or vector.

use crate::channel::separate::component;
use mipless_codegen::NodeDef;
use mipless_graph::{
    Behaviour, Category, Default, Doc, NodeSpec, OutputType, PortSpec, PortType, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "separate3",
    aliases: &[
        "separate",
        "separate_rgb",
        "separate_color",
        "separate_xyz",
        "decompose",
        "decompose3",
        "rgb_split",
    ],
    category: Category::Channel,
    summary: "The 3 components of a colour or vector, each as an output.",
    doc: Doc {
        computes: "outr = in[0], outg = in[1] and outb = in[2] of a colour; outx, outy and outz are the same of a vector. \
            A float is all of them, and the alpha of a colour that has one is none.",
        statistics: "Exact: the components as they are, with all that they share.",
        accuracy: "Exact. Held by `nodes/src/tests/channel.rs`.",
        references: "MaterialX 1.39 specification, node `separate3`.",
    },
    inputs: &[
        PortSpec::new(
            "in",
            PortType::Any,
            Default::Float(0.0),
            "The colour or vector.",
        ),
        PortSpec::new(
            "output",
            PortType::Choice(&["outr", "outg", "outb", "outx", "outy", "outz"]),
            Default::Choice("outr"),
            "Which component `out` is.",
        ),
    ],
    output: OutputType::Exactly(Type::Float),
    class: |_| Behaviour::Linear,
    example: r##"{
  "version": 1,
  "name": "separate3_example",
  "nodes": {
    "board": { "type": "checkerboard", "inputs": { "color1": "#d0a060", "color2": "#203040" } },
    "separate3": { "type": "separate3", "inputs": { "in": { "node": "board" } } },
    "swapped": { "type": "combine3", "inputs": {
        "in1": { "node": "separate3", "output": "outb" },
        "in2": { "node": "separate3", "output": "outg" },
        "in3": { "node": "separate3", "output": "outr" } } }
  },
  "outputs": { "out": { "node": "swapped" } }
}"##,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef {
    spec: &SPEC,
    lower: component,
};
