//! Threshold.

use mipless_codegen::moments::Piecewise;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range,
};

use crate::componentwise::{binary, difference, transfer};

static SPEC: NodeSpec = NodeSpec {
    name: "step",
    aliases: &["threshold", "tones_step", "histogram_scan", "greater_than"],
    category: Category::Transfer,
    summary: "1 where a signal reaches an edge, else 0.",
    doc: Doc {
        computes: "out = 1 where in ≥ edge, else 0, for each component.",
        statistics: "With m and σ the mean and standard deviation of in − edge, and z = m/σ: E = Φ(z), \
            slope φ(z)/σ, distortion Φ(z)Φ(−z) − φ(z)². Exact for a Gaussian in − edge, whether \
            the edge varies or not.",
        accuracy: "For a Gaussian input the mean is within 6e-7 (Abramowitz & Stegun 7.1.26). For a \
            noise the error is the distance of its distribution from a Gaussian, which its page \
            states. Held by `codegen/src/moments/tests.rs` against dense numerical integration \
            in f64.",
        references: "Bussgang 1952, *Crosscorrelation functions of amplitude-distorted Gaussian signals*; \
            Stein 1981, *Estimation of the mean of a multivariate normal distribution*, lemma 1. \
            Heitz, Nowrouzezahrai, Poulin & Neyret 2013, *Filtering Color Mapped Textures and \
            Surfaces*, §4.",
    },
    inputs: &[
        PortSpec::new("in", PortType::Any, Default::Float(0.0), "The signal.")
            .range(Range::soft(-1.0, 1.0)),
        PortSpec::new(
            "edge",
            PortType::Any,
            Default::Float(0.0),
            "Where the result becomes 1.",
        )
        .range(Range::soft(-1.0, 1.0)),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "step_example",
  "nodes": {
    "uv": { "type": "texcoord" },
    "u": { "type": "extract", "inputs": { "in": { "node": "uv" }, "index": 0 } },
    "turns": { "type": "multiply", "inputs": { "in1": { "node": "u" }, "in2": 25 } },
    "wave": { "type": "sin", "inputs": { "in": { "node": "turns" } } },
    "step": { "type": "step", "inputs": { "in": { "node": "wave" }, "edge": 0.3 } }
  },
  "outputs": { "out": { "node": "step" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    binary(lower, node, ["in", "edge"], |lower, x, edge| {
        // The difference is small where it matters: a position keeps its detail far from 0.
        let distance = difference(lower, x, edge);
        let b = lower.b();
        let zero = b.f32(0.0);
        let step = Piecewise::step(b, zero);
        transfer(lower, &distance, &step)
    })
}
