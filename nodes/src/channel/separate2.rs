//! The 2 components of a vector.

use crate::channel::separate::component;
use mipless_codegen::NodeDef;
use mipless_graph::{
    Behaviour, Category, Default, Doc, NodeSpec, OutputType, PortSpec, PortType, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "separate2",
    aliases: &["separate_xy", "decompose2"],
    category: Category::Channel,
    summary: "The 2 components of a vector, each as an output.",
    doc: Doc {
        computes: "outx = in[0] and outy = in[1].",
        statistics: "Exact: the components as they are, with all that they share.",
        accuracy: "Exact. Held by `nodes/src/tests/channel.rs`.",
        references: "MaterialX 1.39 specification, node `separate2`.",
    },
    inputs: &[
        PortSpec::new(
            "in",
            PortType::Exactly(Type::Vector2),
            Default::Float(0.0),
            "The vector.",
        ),
        PortSpec::new(
            "output",
            PortType::Choice(&["outx", "outy"]),
            Default::Choice("outx"),
            "Which component `out` is.",
        ),
    ],
    output: OutputType::Exactly(Type::Float),
    class: |_| Behaviour::Linear,
    example: r#"{
  "version": 1,
  "name": "separate2_example",
  "nodes": {
    "uv": { "type": "texcoord" },
    "separate2": { "type": "separate2", "inputs": { "in": { "node": "uv" } } },
    "both": { "type": "multiply", "inputs": {
        "in1": { "node": "separate2", "output": "outx" }, "in2": { "node": "separate2", "output": "outy" } } }
  },
  "outputs": { "out": { "node": "both" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef {
    spec: &SPEC,
    lower: component,
};
