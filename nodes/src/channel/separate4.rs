//! The 4 components of a colour or vector.

use crate::channel::separate::component;
use mipless_codegen::NodeDef;
use mipless_graph::{
    Behaviour, Category, Default, Doc, NodeSpec, OutputType, PortSpec, PortType, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "separate4",
    aliases: &["separate_rgba", "decompose4"],
    category: Category::Channel,
    summary: "The 4 components of a colour or vector, each as an output.",
    doc: Doc {
        computes: "outr = in[0], outg = in[1], outb = in[2] and outa = in[3] of a colour; outx, outy, outz and outw are the \
            same of a vector. The alpha of a colour without one is 1.",
        statistics: "Exact: the components as they are, with all that they share.",
        accuracy: "Exact. Held by `nodes/src/tests/channel.rs`.",
        references: "MaterialX 1.39 specification, node `separate4`.",
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
            PortType::Choice(&[
                "outr", "outg", "outb", "outa", "outx", "outy", "outz", "outw",
            ]),
            Default::Choice("outr"),
            "Which component `out` is.",
        ),
    ],
    output: OutputType::Exactly(Type::Float),
    class: |_| Behaviour::Linear,
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
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef {
    spec: &SPEC,
    lower: component,
};
