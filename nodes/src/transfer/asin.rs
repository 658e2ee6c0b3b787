//! Arc sine.

use crate::componentwise::{transfer, unary};
use crate::transfer::arc;
use mipless_codegen::moments::Curve;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range,
};
use std::f32::consts::FRAC_PI_2;

static SPEC: NodeSpec = NodeSpec {
    name: "asin",
    aliases: &["arcsine", "arcsin", "math_arcsine"],
    category: Category::Transfer,
    summary: "The angle whose sine a signal is.",
    doc: Doc {
        computes: "out = arcsin(in) in radians, from −π/2 to π/2, for each component; in is limited to \
            [−1, 1].",
        statistics: "By ten-point Gauss–Legendre quadrature between the places where the function bends \
            and closed forms where it is constant, of the difference from a line; the distortion \
            as a sum of squares. Approximate.",
        accuracy: "For a Gaussian input the mean is within 5e-4 and the standard deviation within 1e-3. \
            Held by `nodes/src/tests/law.rs` against dense numerical integration in f64.",
        references: "Abramowitz & Stegun 4.4.49 (the polynomial). Bussgang 1952, *Crosscorrelation \
            functions of amplitude-distorted Gaussian signals*; Stein 1981, *Estimation of the \
            mean of a multivariate normal distribution*, lemma 1. MaterialX 1.39 specification, \
            node `asin`.",
    },
    inputs: &[
        PortSpec::new("in", PortType::Any, Default::Float(0.0), "The number.")
            .range(Range::soft(-1.0, 1.0)),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "asin_example",
  "nodes": {
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 25}},
    "wave": {"type": "sin", "inputs": {"in": {"node": "turns"}}},
    "less": {"type": "multiply", "inputs": {"in1": {"node": "wave"}, "in2": 0.95}},
    "asin": {"type": "asin", "inputs": {"in": {"node": "less"}}}
  },
  "outputs": { "out": { "node": "asin" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let b = lower.b();
    let curve = Curve {
        function: arc::sine,
        kinks: vec![b.f32(-1.0), b.f32(1.0)],
        flat: [Some(b.f32(-FRAC_PI_2)), Some(b.f32(FRAC_PI_2))],
        range: [-FRAC_PI_2, FRAC_PI_2],
    };
    unary(lower, node, "in", |lower, x| transfer(lower, x, &curve))
}
