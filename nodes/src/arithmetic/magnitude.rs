//! Length.

use crate::arithmetic::vector::length;
use crate::componentwise::exposed;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "magnitude",
    aliases: &["length", "vector_length", "norm"],
    category: Category::Arithmetic,
    summary: "The length of a vector.",
    doc: Doc {
        computes: "out = √Σ inᵢ²; of a number, |in|.",
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
            1.39 specification, node `magnitude`.",
    },
    inputs: &[PortSpec::new(
        "in",
        PortType::Any,
        Default::Float(0.0),
        "The vector.",
    )],
    output: OutputType::Exactly(Type::Float),
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "magnitude_example",
  "nodes": {
    "uv": {"type": "texcoord"},
    "turned": {"type": "rotate2d", "inputs": {"in": {"node": "uv"}, "amount": 30}},
    "magnitude": {"type": "magnitude", "inputs": {"in": {"node": "uv"}}}
  },
  "outputs": { "out": { "node": "magnitude" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let components = exposed(lower, node, "in");
    vec![length(lower, &components)]
}
