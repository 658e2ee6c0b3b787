//! Rounding.

use crate::componentwise::unary;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range,
};

static SPEC: NodeSpec = NodeSpec {
    name: "round",
    aliases: &["math_round", "nearest"],
    category: Category::Transfer,
    summary: "The whole number nearest to a signal.",
    doc: Doc {
        computes: "out = ⌊in + ½⌋, for each component: halves go up.",
        statistics: "⌊x⌋ is x less its fraction, whose moments are those of `fract`: E[⌊x⌋] = m − E[fract \
            x], slope 1 − α, the same distortion. Exact for a Gaussian, and a position keeps its \
            integer cell.",
        accuracy: "For a Gaussian input the mean is within 4e-6, the remainder’s standard deviation \
            within 1e-3 of 1 + σ. Held by `codegen/src/moments/tests/waves.rs` against dense \
            numerical integration in f64.",
        references: "The characteristic function of the normal distribution, in *Abramowitz & Stegun* \
            26.2. Bussgang 1952, *Crosscorrelation functions of amplitude-distorted Gaussian \
            signals*; Stein 1981, *Estimation of the mean of a multivariate normal distribution*, \
            lemma 1. MaterialX 1.39 specification, node `round`.",
    },
    inputs: &[
        PortSpec::new("in", PortType::Any, Default::Float(0.0), "The signal.")
            .range(Range::soft(-4.0, 4.0)),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "round_example",
  "nodes": {
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "six": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 6.3}},
    "round": {"type": "round", "inputs": {"in": {"node": "six"}}}
  },
  "outputs": { "out": { "node": "round" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    unary(lower, node, "in", |lower, x| {
        let half = lower.b().f32(0.5);
        let raised = x.offset(lower.b(), half);
        lower.algebra.floor(&raised)
    })
}
