//! Dot product.

use crate::componentwise::{composed, exposed, product};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "dotproduct",
    aliases: &["dot_product"],
    category: Category::Arithmetic,
    summary: "The sum of the products of components.",
    doc: Doc {
        computes: "out = Σ in1ᵢ in2ᵢ.",
        statistics: "Products of varying signals take their covariance: exact in mean and variance for \
            jointly Gaussian ones, with numbers linear and exact.",
        accuracy: "For jointly Gaussian inputs the mean is exact to rounding and the standard deviation \
            within 1e-3. Held by `nodes/src/tests/vector.rs` against dense numerical integration \
            in f64.",
        references: "Isserlis 1918, *On a formula for the product-moment coefficient of any order of a \
            normal frequency distribution* (fourth moments from second ones). MaterialX 1.39 \
            specification, node `dotproduct`.",
    },
    inputs: &[
        PortSpec::new(
            "in1",
            PortType::Any,
            Default::Float(0.0),
            "The first operand.",
        ),
        PortSpec::new(
            "in2",
            PortType::Any,
            Default::Float(0.0),
            "The second operand.",
        ),
    ],
    output: OutputType::Exactly(Type::Float),
    class: |_| Behaviour::Product,
    example: r#"{
  "version": 1,
  "name": "dotproduct_example",
  "nodes": {
    "uv": {"type": "texcoord"},
    "turned": {"type": "rotate2d", "inputs": {"in": {"node": "uv"}, "amount": 30}},
    "dotproduct": {"type": "dotproduct", "inputs": {"in1": {"node": "uv"}, "in2": {"node": "turned"}}}
  },
  "outputs": { "out": { "node": "dotproduct" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let [x, y] = ["in1", "in2"].map(|port| exposed(lower, node, port));
    composed(lower, |lower| {
        let mut sum = Signal::constant(lower.b(), 0.0);
        for (x, y) in x.iter().zip(&y) {
            let part = product(lower, x, y);
            sum = sum.add(lower.b(), &part);
        }
        vec![sum]
    })
}
