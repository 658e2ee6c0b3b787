//! Exponential.

use crate::componentwise::{transfer, unary};
use mipless_codegen::moments::Exponential;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range,
};

static SPEC: NodeSpec = NodeSpec {
    name: "exp",
    aliases: &["exponential", "math_exp"],
    category: Category::Transfer,
    summary: "e to the power of a signal.",
    doc: Doc {
        computes: "out = e^in, for each component; in is limited to ±80.",
        statistics: "The lognormal distribution: E = M = e^{m + v/2}, slope M, distortion M²(eᵛ − 1 − v). \
            Exact for a Gaussian.",
        accuracy: "For a Gaussian input the mean is within 2e-6 of its value, the remainder’s standard \
            deviation within 2e-4 of e^{m + v}. Held by `codegen/src/moments/tests/curves.rs` \
            against dense numerical integration in f64.",
        references: "Aitchison & Brown 1957, *The Lognormal Distribution*, §2.3. Bussgang 1952, \
            *Crosscorrelation functions of amplitude-distorted Gaussian signals*; Stein 1981, \
            *Estimation of the mean of a multivariate normal distribution*, lemma 1. MaterialX \
            1.39 specification, node `exp`.",
    },
    inputs: &[
        PortSpec::new("in", PortType::Any, Default::Float(0.0), "The exponent.")
            .range(Range::soft(-4.0, 4.0)),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "exp_example",
  "nodes": {
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 25}},
    "wave": {"type": "sin", "inputs": {"in": {"node": "turns"}}},
    "exp": {"type": "exp", "inputs": {"in": {"node": "wave"}}}
  },
  "outputs": { "out": { "node": "exp" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    unary(lower, node, "in", |lower, x| {
        transfer(lower, x, &Exponential)
    })
}
