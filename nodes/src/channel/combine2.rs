//! Two numbers as a vector.

use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "combine2",
    aliases: &["combine_xy"],
    category: Category::Channel,
    summary: "A vector from two numbers.",
    doc: Doc {
        computes: "out = (in1, in2).",
        statistics: "Exact: each component is its input, and their covariances are those of the inputs.",
        accuracy: "Exact. Held by `nodes/src/tests.rs`.",
        references: "MaterialX 1.39 specification, node `combine2`.",
    },
    inputs: &[
        PortSpec::new(
            "in1",
            PortType::Exactly(Type::Float),
            Default::Float(0.0),
            "The first component.",
        ),
        PortSpec::new(
            "in2",
            PortType::Exactly(Type::Float),
            Default::Float(0.0),
            "The second component.",
        ),
    ],
    output: OutputType::Exactly(Type::Vector2),
    class: |_| Behaviour::Linear,
    example: r#"{
  "version": 1,
  "name": "combine2_example",
  "nodes": {
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "across": {"type": "stripes", "inputs": {"frequency": 4, "rotate": 90}},
    "combine2": {"type": "combine2", "inputs": {"in1": {"node": "bands"}, "in2": {"node": "across"}}}
  },
  "outputs": { "out": { "node": "combine2" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    ["in1", "in2"].map(|port| lower.signal(node, port)).to_vec()
}
