//! Magnitude.

use mipless_codegen::moments::Piecewise;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range,
};

use crate::componentwise::{transfer, unary};

static SPEC: NodeSpec = NodeSpec {
    name: "absval",
    aliases: &["abs", "absolute", "folds"],
    category: Category::Transfer,
    summary: "The magnitude of a signal.",
    doc: Doc {
        computes: "out = |in|, for each component.",
        statistics: "The folded normal distribution: E = m(Φ(z) − Φ(−z)) + 2σφ(z), z = m/σ; slope Φ(z) − \
            Φ(−z); distortion 4σ²d(z) with d(z) = (z² + 1)Φ(z)Φ(−z) − |z|φ(z)|Φ(z) − Φ(−z)| − \
            φ(z)². Exact for a Gaussian.",
        accuracy: "For a Gaussian input the mean is within 2e-6 σ. Held by \
            `codegen/src/moments/tests.rs` against dense numerical integration in f64.",
        references: "Leone, Nelson & Nottingham 1961, *The Folded Normal Distribution*. Bussgang 1952, \
            *Crosscorrelation functions of amplitude-distorted Gaussian signals*; Stein 1981, \
            *Estimation of the mean of a multivariate normal distribution*, lemma 1. MaterialX \
            1.39 specification, node `absval`.",
    },
    inputs: &[
        PortSpec::new("in", PortType::Any, Default::Float(0.0), "The signal.")
            .range(Range::soft(-1.0, 1.0)),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "absval_example",
  "nodes": {
    "uv": { "type": "texcoord" },
    "u": { "type": "extract", "inputs": { "in": { "node": "uv" }, "index": 0 } },
    "turns": { "type": "multiply", "inputs": { "in1": { "node": "u" }, "in2": 25 } },
    "wave": { "type": "sin", "inputs": { "in": { "node": "turns" } } },
    "absval": { "type": "absval", "inputs": { "in": { "node": "wave" } } }
  },
  "outputs": { "out": { "node": "absval" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    unary(lower, node, "in", |lower, x| {
        let absolute = Piecewise::absolute(lower.b());
        transfer(lower, x, &absolute)
    })
}
