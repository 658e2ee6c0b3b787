//! Cross product.

use crate::componentwise::{composed, exposed, product};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "crossproduct",
    aliases: &["cross", "cross_product"],
    category: Category::Arithmetic,
    summary: "The vector at right angles to two others.",
    doc: Doc {
        computes: "out = in1 × in2.",
        statistics: "Products of varying signals take their covariance: exact in mean and variance for \
            jointly Gaussian ones, with numbers linear and exact.",
        accuracy: "For jointly Gaussian inputs the mean is exact to rounding and the standard deviation \
            within 1e-3. Held by `nodes/src/tests/vector.rs` against dense numerical integration \
            in f64.",
        references: "Isserlis 1918, *On a formula for the product-moment coefficient of any order of a \
            normal frequency distribution* (fourth moments from second ones). MaterialX 1.39 \
            specification, node `crossproduct`.",
    },
    inputs: &[
        PortSpec::new(
            "in1",
            PortType::Exactly(Type::Vector3),
            Default::Float(0.0),
            "The first operand.",
        ),
        PortSpec::new(
            "in2",
            PortType::Exactly(Type::Vector3),
            Default::Float(0.0),
            "The second operand.",
        ),
    ],
    output: OutputType::Exactly(Type::Vector3),
    class: |_| Behaviour::Product,
    example: r#"{
  "version": 1,
  "name": "crossproduct_example",
  "nodes": {
    "uv": {"type": "texcoord"},
    "turned": {"type": "rotate2d", "inputs": {"in": {"node": "uv"}, "amount": 30}},
    "a": {"type": "convert", "inputs": {"in": {"node": "uv"}, "to": "vector3"}},
    "b": {"type": "convert", "inputs": {"in": {"node": "turned"}, "to": "vector3"}},
    "crossproduct": {"type": "crossproduct", "inputs": {"in1": {"node": "a"}, "in2": {"node": "b"}}}
  },
  "outputs": { "out": { "node": "crossproduct" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let [x, y] = ["in1", "in2"].map(|port| exposed(lower, node, port));
    composed(lower, |lower| {
        (0..3)
            .map(|k| {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                let first = product(lower, &x[i], &y[j]);
                let second = product(lower, &x[j], &y[i]);
                first.sub(lower.b(), &second)
            })
            .collect()
    })
}
