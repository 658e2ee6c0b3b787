//! Four numbers as a colour with alpha.

use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "combine4",
    aliases: &["combine_rgba"],
    category: Category::Channel,
    summary: "A colour with alpha from four numbers.",
    doc: Doc {
        computes: "out = (in1, in2, in3, in4).",
        statistics: "Exact: each component is its input, and their covariances are those of the inputs.",
        accuracy: "Exact. Held by `nodes/src/tests.rs`.",
        references: "MaterialX 1.39 specification, node `combine4`.",
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
        PortSpec::new(
            "in4",
            PortType::Exactly(Type::Float),
            Default::Float(1.0),
            "Alpha.",
        ),
    ],
    output: OutputType::Exactly(Type::Color4),
    class: |_| Behaviour::Linear,
    example: r#"{
  "version": 1,
  "name": "combine4_example",
  "nodes": {
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "across": {"type": "stripes", "inputs": {"frequency": 4, "rotate": 90}},
    "combine4": {"type": "combine4", "inputs": {"in1": {"node": "bands"}, "in2": {"node": "across"}}}
  },
  "outputs": { "out": { "node": "combine4" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    ["in1", "in2", "in3", "in4"]
        .map(|port| lower.signal(node, port))
        .to_vec()
}
