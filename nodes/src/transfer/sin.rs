//! Sine.

use mipless_codegen::moments::Sine;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range,
};

use crate::componentwise::{transfer, unary};

static SPEC: NodeSpec = NodeSpec {
    name: "sin",
    aliases: &["sine", "math_sine"],
    category: Category::Transfer,
    summary: "The sine of a signal in radians.",
    doc: Doc {
        computes: "out = sin(in), for each component; in is reduced to one turn first, so that every \
            device agrees.",
        statistics: "For a Gaussian input with mean m and variance v: E = sin(m)e^{−v/2}, slope \
            cos(m)e^{−v/2}, distortion cos²(m)e^{−v}(sinh v − v) + ½ sin²(m)(1 − e^{−v})². \
            Exact. Over a large footprint the mean goes to 0 and the variance to ½.",
        accuracy: "For a Gaussian input with |in| up to 100 the mean is within 1e-5, which is the \
            rounding of the argument in f32. Held by `codegen/src/moments/tests.rs` against \
            dense numerical integration in f64.",
        references: "The characteristic function of the normal distribution, in *Abramowitz & Stegun* \
            26.2. Bussgang 1952, *Crosscorrelation functions of amplitude-distorted Gaussian \
            signals*; Stein 1981, *Estimation of the mean of a multivariate normal \
            distribution*, lemma 1. MaterialX 1.39 specification, node `sin`.",
    },
    inputs: &[
        PortSpec::new("in", PortType::Any, Default::Float(0.0), "The angle.")
            .range(Range::soft(-3.15, 3.15))
            .unit("radians"),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "sin_example",
  "nodes": {
    "uv": { "type": "texcoord" },
    "u": { "type": "extract", "inputs": { "in": { "node": "uv" }, "index": 0 } },
    "turns": { "type": "multiply", "inputs": { "in1": { "node": "u" }, "in2": 25 } },
    "sin": { "type": "sin", "inputs": { "in": { "node": "turns" } } }
  },
  "outputs": { "out": { "node": "sin" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    unary(lower, node, "in", |lower, x| {
        transfer(lower, x, &Sine { phase: 0.0 })
    })
}
