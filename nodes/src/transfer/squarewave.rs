//! Square wave.

use crate::componentwise::{transfer, unary};
use mipless_codegen::moments::SquareWave;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "squarewave",
    aliases: &["square_wave", "pulse", "pulse_wave"],
    category: Category::Transfer,
    summary: "1 over a share of every unit, else 0.",
    doc: Doc {
        computes: "out = 1 where the fraction of in is below width, else 0, for each component.",
        statistics: "For σ ≤ 0.11 periods Φ at the nearest two edges, beyond it six harmonics \
            of the Fourier series, damped by e^{−2π²k²v}; the variance is P(1 − P). Exact for a \
            Gaussian. Over a large footprint the mean goes to width. Of a varying width the mean \
            is used.",
        accuracy: "For a Gaussian input the mean is within 5e-6, the remainder’s standard deviation \
            within 2e-3. Held by `codegen/src/moments/tests.rs` against dense numerical \
            integration in f64.",
        references: "The characteristic function of the normal distribution, in *Abramowitz & Stegun* \
            26.2. Bussgang 1952, *Crosscorrelation functions of amplitude-distorted Gaussian \
            signals*; Stein 1981, *Estimation of the mean of a multivariate normal distribution*, \
            lemma 1.",
    },
    inputs: &[
        PortSpec::new("in", PortType::Any, Default::Float(0.0), "The signal.")
            .range(Range::soft(-1.0, 1.0)),
        PortSpec::new(
            "width",
            PortType::Exactly(Type::Float),
            Default::Float(0.5),
            "The share of a unit that is 1.",
        )
        .range(Range::hard(0.0, 1.0)),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "squarewave_example",
  "nodes": {
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "six": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 6.3}},
    "squarewave": {"type": "squarewave", "inputs": {"in": {"node": "six"}, "width": 0.3}}
  },
  "outputs": { "out": { "node": "squarewave" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let width = lower.number(node, "width");
    unary(lower, node, "in", |lower, x| {
        transfer(lower, x, &SquareWave { width })
    })
}
