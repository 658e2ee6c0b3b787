//! Three numbers as a colour.

use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "combine3",
    aliases: &["combine", "combine_rgb", "combine_color", "combinexyz"],
    category: Category::Channel,
    summary: "A colour from three numbers.",
    doc: Doc {
        computes: "out = (in1, in2, in3).",
        statistics: "Exact: each channel is its input, and their covariances are those of the inputs.",
        accuracy: "Exact. Held by `nodes/src/tests.rs`.",
        references: "MaterialX 1.39 specification, node `combine3`.",
    },
    inputs: &[
        PortSpec::new(
            "in1",
            PortType::Exactly(Type::Float),
            Default::Float(0.0),
            "Red.",
        ),
        PortSpec::new(
            "in2",
            PortType::Exactly(Type::Float),
            Default::Float(0.0),
            "Green.",
        ),
        PortSpec::new(
            "in3",
            PortType::Exactly(Type::Float),
            Default::Float(0.0),
            "Blue.",
        ),
    ],
    output: OutputType::Exactly(Type::Color3),
    class: |_| Behaviour::Linear,
    example: r#"{
  "version": 1,
  "name": "combine3_example",
  "nodes": {
    "bands": { "type": "stripes", "inputs": { "frequency": 6 } },
    "across": { "type": "stripes", "inputs": { "frequency": 4, "rotate": 90 } },
    "combine3": { "type": "combine3", "inputs": { "in1": { "node": "bands" }, "in2": 0.4, "in3": { "node": "across" } } }
  },
  "outputs": { "out": { "node": "combine3" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    ["in1", "in2", "in3"]
        .map(|port| lower.signal(node, port))
        .to_vec()
}
