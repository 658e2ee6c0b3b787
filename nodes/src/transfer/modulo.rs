//! Remainder.

use crate::componentwise::{binary, composed, product, quotient, transfer};
use mipless_codegen::moments::LinearWave;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range,
};

static SPEC: NodeSpec = NodeSpec {
    name: "modulo",
    aliases: &["mod", "fmod", "math_modulo", "wrap"],
    category: Category::Transfer,
    summary: "What a division leaves over.",
    doc: Doc {
        computes: "out = in1 − in2 ⌊in1 / in2⌋, for each component: it has the sign of in2. A divisor \
            nearer to 0 than 1e-6 is moved to ±1e-6.",
        statistics: "in2 times the fraction of in1/in2. By a number, exact for a Gaussian, as `fract`. By \
            a varying signal, the quotient as `divide`, taken for a Gaussian, and a product: \
            approximate.",
        accuracy: "By a number, the mean is within 4e-6 of in2. By a varying signal with a spread of a \
            tenth of its mean: see `nodes/src/tests/law.rs`, which holds the mean within 0.01 and \
            the standard deviation within 0.015 against dense numerical integration in f64.",
        references: "The characteristic function of the normal distribution, in *Abramowitz & Stegun* \
            26.2. Bussgang 1952, *Crosscorrelation functions of amplitude-distorted Gaussian \
            signals*; Stein 1981, *Estimation of the mean of a multivariate normal distribution*, \
            lemma 1. MaterialX 1.39 specification, node `modulo`.",
    },
    inputs: &[
        PortSpec::new("in1", PortType::Any, Default::Float(0.0), "The dividend."),
        PortSpec::new(
            "in2",
            PortType::Any,
            Default::Float(1.0),
            "The divisor; 0 is refused.",
        )
        .range(Range::soft(0.1, 4.0).nonzero()),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "modulo_example",
  "nodes": {
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "modulo": {"type": "modulo", "inputs": {"in1": {"node": "u"}, "in2": 0.21}}
  },
  "outputs": { "out": { "node": "modulo" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let wave = LinearWave::sawtooth();
    let mut divisor = None;
    let out = binary(lower, node, ["in1", "in2"], |lower, x, y| {
        divisor = lower.b().as_constant(y.mean).filter(|_| y.cell.is_none());
        divisor = divisor.filter(|_| y.is_certain(lower.b())).map(f32::abs);
        composed(lower, |lower| {
            let y = lower.algebra.expose(y);
            let turns = quotient(lower, x, &y);
            let part = transfer(lower, &turns, &wave);
            product(lower, &part, &y)
        })
    });
    lower.algebra.repeats(divisor);
    out
}
