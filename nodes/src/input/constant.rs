//! A literal.

use crate::port::any;
use mipless_codegen::NodeDef;
use mipless_graph::{Behaviour, Category, Doc, NodeSpec, OutputType};

static SPEC: NodeSpec = NodeSpec {
    name: "constant",
    aliases: &["uniform", "uniform_greyscale", "value", "color", "rgb"],
    category: Category::Input,
    summary: "A number, vector or colour that is the same everywhere.",
    doc: Doc {
        computes: "out = value. The type of the node is that of its literal: a number, two numbers \
            (`vector2`), or a colour.",
        statistics: "Constant: the mean is the value, and there is no spread.",
        accuracy: "Exact. Held by `nodes/src/tests.rs`.",
        references: cite!(; "constant"),
    },
    inputs: &[any("value", 0.0, "The value.").uniform()],
    output: OutputType::Widest,
    class: |_| Behaviour::Constant,
    example: r##"{
  "version": 1,
  "name": "constant_example",
  "nodes": {
    "constant": { "type": "constant", "inputs": { "value": "#c08a52" } }
  },
  "outputs": { "out": { "node": "constant" } }
}"##,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef {
    spec: &SPEC,
    lower: |lower, node| lower.bundle(node, "value"),
};
