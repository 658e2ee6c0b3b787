//! Levels of equal height.

use crate::componentwise::unary;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "quantize",
    aliases: &["posterize", "snap", "steps"],
    category: Category::Transfer,
    summary: "A signal in steps.",
    doc: Doc {
        computes: "out = ⌊in · steps⌋ / steps, for each component.",
        statistics: "⌊x⌋ is x less its fraction, whose moments are those of `fract`: E[⌊x⌋] = m − E[fract \
            x], slope 1 − α, the same distortion. Exact for a Gaussian, and a position keeps its \
            integer cell. Of varying steps the mean is used.",
        accuracy: "For a Gaussian input the mean is within 4e-6, the remainder’s standard deviation \
            within 1e-3 of 1 + σ. Held by `codegen/src/moments/tests/waves.rs` against dense \
            numerical integration in f64.",
        references: "The characteristic function of the normal distribution, in *Abramowitz & Stegun* \
            26.2. Bussgang 1952, *Crosscorrelation functions of amplitude-distorted Gaussian \
            signals*; Stein 1981, *Estimation of the mean of a multivariate normal distribution*, \
            lemma 1.",
    },
    inputs: &[
        PortSpec::new("in", PortType::Any, Default::Float(0.0), "The signal."),
        PortSpec::new(
            "steps",
            PortType::Exactly(Type::Float),
            Default::Float(4.0),
            "How many levels a unit has.",
        )
        .range(Range::hard(0.001, 1e6).with_soft(1.0, 32.0)),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "quantize_example",
  "nodes": {
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 25}},
    "wave": {"type": "sin", "inputs": {"in": {"node": "turns"}}},
    "quantize": {"type": "quantize", "inputs": {"in": {"node": "wave"}, "steps": 5}}
  },
  "outputs": { "out": { "node": "quantize" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let steps = lower.number(node, "steps");
    unary(lower, node, "in", |lower, x| {
        let scaled = x.scale(lower.b(), steps);
        let floor = lower.algebra.floor(&scaled);
        let one = lower.b().f32(1.0);
        let height = lower.b().div(one, steps);
        floor.scale(lower.b(), height)
    })
}
