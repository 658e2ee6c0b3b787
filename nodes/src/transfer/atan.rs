//! Arc tangent.

use crate::componentwise::{transfer, unary};
use crate::transfer::arc;
use mipless_codegen::moments::Curve;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range,
};
use std::f32::consts::FRAC_PI_2;

static SPEC: NodeSpec = NodeSpec {
    name: "atan",
    aliases: &["arctangent", "arctan", "math_arctangent"],
    category: Category::Transfer,
    summary: "The angle whose tangent a signal is.",
    doc: Doc {
        computes: "out = arctan(in) in radians, from −π/2 to π/2, for each component.",
        statistics: "By nine standard scores with positive weights, of the difference from a line: mean, \
            slope and curvature by their weights on the density (Stein), the distortion as a sum \
            of squares. Approximate.",
        accuracy: "For a Gaussian input with a spread up to 0.5 the mean is within 1e-4, up to 1.5 \
            within 0.02, of values from −1.6 to 1.6. Held by `nodes/src/tests/law.rs` against \
            dense numerical integration in f64.",
        references: "Abramowitz & Stegun 4.4.49 (the polynomial). Bussgang 1952, *Crosscorrelation \
            functions of amplitude-distorted Gaussian signals*; Stein 1981, *Estimation of the \
            mean of a multivariate normal distribution*, lemma 1. MaterialX 1.39 specification, \
            node `atan`.",
    },
    inputs: &[
        PortSpec::new("in", PortType::Any, Default::Float(0.0), "The number.")
            .range(Range::soft(-1.0, 1.0)),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "atan_example",
  "nodes": {
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 25}},
    "wave": {"type": "sin", "inputs": {"in": {"node": "turns"}}},
    "less": {"type": "multiply", "inputs": {"in1": {"node": "wave"}, "in2": 0.95}},
    "atan": {"type": "atan", "inputs": {"in": {"node": "less"}}}
  },
  "outputs": { "out": { "node": "atan" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let curve = Curve::smooth(arc::tangent, [-FRAC_PI_2, FRAC_PI_2]);
    unary(lower, node, "in", |lower, x| transfer(lower, x, &curve))
}
