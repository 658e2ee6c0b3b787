//! Arc cosine.

use crate::componentwise::{transfer, unary};
use crate::transfer::arc;
use mipless_codegen::moments::Curve;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range,
};
use std::f32::consts::PI;

static SPEC: NodeSpec = NodeSpec {
    name: "acos",
    aliases: &["arccosine", "arccos", "math_arccosine"],
    category: Category::Transfer,
    summary: "The angle whose cosine a signal is.",
    doc: Doc {
        computes: "out = arccos(in) in radians, from 0 to π, for each component; in is limited to [−1, \
            1].",
        statistics: "By ten-point Gauss–Legendre quadrature between the places where the function bends \
            and closed forms where it is constant, of the difference from a line; the distortion \
            as a sum of squares. Approximate.",
        accuracy: "For a Gaussian input the mean is within 5e-4 and the standard deviation within 1e-3. \
            Held by `nodes/src/tests/law.rs` against dense numerical integration in f64.",
        references: "Abramowitz & Stegun 4.4.49 (the polynomial). Bussgang 1952, *Crosscorrelation \
            functions of amplitude-distorted Gaussian signals*; Stein 1981, *Estimation of the \
            mean of a multivariate normal distribution*, lemma 1. MaterialX 1.39 specification, \
            node `acos`.",
    },
    inputs: &[
        PortSpec::new("in", PortType::Any, Default::Float(0.0), "The number.")
            .range(Range::soft(-1.0, 1.0)),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "acos_example",
  "nodes": {
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 25}},
    "wave": {"type": "sin", "inputs": {"in": {"node": "turns"}}},
    "less": {"type": "multiply", "inputs": {"in1": {"node": "wave"}, "in2": 0.95}},
    "acos": {"type": "acos", "inputs": {"in": {"node": "less"}}}
  },
  "outputs": { "out": { "node": "acos" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let b = lower.b();
    let curve = Curve {
        function: arc::cosine,
        kinks: vec![b.f32(-1.0), b.f32(1.0)],
        flat: [Some(b.f32(PI)), Some(b.f32(0.0))],
        range: [0.0, PI],
    };
    unary(lower, node, "in", |lower, x| transfer(lower, x, &curve))
}
