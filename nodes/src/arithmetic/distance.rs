//! Distance.

use crate::arithmetic::vector::length;
use crate::componentwise::exposed;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "distance",
    aliases: &["vector_distance"],
    category: Category::Arithmetic,
    summary: "How far two points are apart.",
    doc: Doc {
        computes: "out = √Σ (in1ᵢ − in2ᵢ)².",
        statistics: "The squares in closed form, their sum taken for a Gaussian, and its square root by \
            ten-point Gauss–Legendre quadrature over the part above 0. Approximate: near 0 the \
            sum of few squares is far from Gaussian.",
        accuracy: "For jointly Gaussian components the mean is within 0.02 and the standard deviation \
            within 0.07 of the root of the components’ summed variance; the worst is a vector of \
            mean 0. Held by `nodes/src/tests/vector.rs` against dense numerical integration in \
            f64.",
        references: "Isserlis 1918, *On a formula for the product-moment coefficient of any order of a \
            normal frequency distribution* (fourth moments from second ones). Bussgang 1952, \
            *Crosscorrelation functions of amplitude-distorted Gaussian signals*; Stein 1981, \
            *Estimation of the mean of a multivariate normal distribution*, lemma 1. MaterialX \
            1.39 specification, node `distance`.",
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
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "distance_example",
  "nodes": {
    "uv": {"type": "texcoord"},
    "turned": {"type": "rotate2d", "inputs": {"in": {"node": "uv"}, "amount": 30}},
    "distance": {"type": "distance", "inputs": {"in1": {"node": "uv"}, "in2": [0.5, 0.4]}}
  },
  "outputs": { "out": { "node": "distance" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let [x, y] = ["in1", "in2"].map(|port| exposed(lower, node, port));
    let components: Bundle = (x.iter().zip(&y))
        .map(|(x, y)| x.sub(lower.b(), y))
        .collect();
    vec![length(lower, &components)]
}
