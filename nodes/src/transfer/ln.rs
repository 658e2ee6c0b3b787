//! Natural logarithm.

use crate::componentwise::{transfer, unary};
use mipless_codegen::ir::Builder;
use mipless_codegen::moments::Curve;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range,
};

static SPEC: NodeSpec = NodeSpec {
    name: "ln",
    aliases: &["log", "logarithm", "math_log"],
    category: Category::Transfer,
    summary: "The natural logarithm of a signal.",
    doc: Doc {
        computes: "out = ln max(in, 0.001), for each component: the limit keeps the moments finite.",
        statistics: "The part below 0.001 in closed form, the part above it by ten-point Gauss–Legendre \
            quadrature of the difference from a line; the distortion as a sum of squares. \
            Approximate near the pole.",
        accuracy: "For a Gaussian input at least four standard deviations above 0, the mean and the \
            standard deviation are within 5e-4; nearer, both are within 0.02 of values that reach \
            from −6.9 up. Held by `nodes/src/tests/law.rs` against dense numerical integration in \
            f64.",
        references: "Bussgang 1952, *Crosscorrelation functions of amplitude-distorted Gaussian signals*; \
            Stein 1981, *Estimation of the mean of a multivariate normal distribution*, lemma 1. \
            MaterialX 1.39 specification, node `ln`.",
    },
    inputs: &[
        PortSpec::new("in", PortType::Any, Default::Float(1.0), "The number.")
            .range(Range::soft(0.0, 4.0)),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "ln_example",
  "nodes": {
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 25}},
    "wave": {"type": "sin", "inputs": {"in": {"node": "turns"}}},
    "lifted": {"type": "add", "inputs": {"in1": {"node": "wave"}, "in2": 1.5}},
    "ln": {"type": "ln", "inputs": {"in": {"node": "lifted"}}}
  },
  "outputs": { "out": { "node": "ln" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// What lies below counts as this.
const LEAST: f32 = 1e-3;

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let least = lower.b().f32(LEAST);
    let floor = lower.b().ln(least);
    let logarithm = Curve {
        function: move |b: &mut Builder, x| {
            let x = b.max(x, least);
            b.ln(x)
        },
        kinks: vec![least],
        flat: [Some(floor), None],
        range: [LEAST.ln(), f32::INFINITY],
    };
    unary(lower, node, "in", |lower, x| transfer(lower, x, &logarithm))
}
