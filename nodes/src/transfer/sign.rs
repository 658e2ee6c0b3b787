//! Sign.

use crate::componentwise::{transfer, unary};
use mipless_codegen::moments::{Piecewise, Signal};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range,
};

static SPEC: NodeSpec = NodeSpec {
    name: "sign",
    aliases: &["signum", "math_sign"],
    category: Category::Transfer,
    summary: "−1, 0 or 1: on which side of 0 a signal is.",
    doc: Doc {
        computes: "out = 1 where in > 0, −1 where in < 0, 0 where in = 0, for each component.",
        statistics: "A step of height 2: E = 2Φ(z) − 1, z = m/σ; slope 2φ(z)/σ; distortion 4(Φ(z)Φ(−z) − \
            φ(z)²). Exact for a Gaussian.",
        accuracy: "For a Gaussian input the mean is within 2e-6, the remainder’s standard deviation \
            within 2e-4. Held by `codegen/src/moments/tests.rs` against dense numerical \
            integration in f64.",
        references: "Bussgang 1952, *Crosscorrelation functions of amplitude-distorted Gaussian signals*; \
            Stein 1981, *Estimation of the mean of a multivariate normal distribution*, lemma 1. \
            MaterialX 1.39 specification, node `sign`.",
    },
    inputs: &[
        PortSpec::new("in", PortType::Any, Default::Float(0.0), "The signal.")
            .range(Range::soft(-1.0, 1.0)),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "sign_example",
  "nodes": {
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 23}},
    "wave": {"type": "sin", "inputs": {"in": {"node": "turns"}}},
    "sign": {"type": "sign", "inputs": {"in": {"node": "wave"}}}
  },
  "outputs": { "out": { "node": "sign" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    unary(lower, node, "in", |lower, x| {
        let spreads = lower.mode().spreads();
        let b = lower.b();
        let zero = b.f32(0.0);
        if spreads && !x.is_certain(b) {
            let (two, minus) = (b.f32(2.0), b.f32(-1.0));
            let step = Piecewise::step(b, zero).affine(b, two, minus);
            return transfer(lower, x, &step);
        }
        let mean = x.flat_mean(b);
        let (positive, negative) = (b.lt(zero, mean), b.lt(mean, zero));
        let (one, minus) = (b.f32(1.0), b.f32(-1.0));
        let value = b.select(negative, minus, zero);
        let value = b.select(positive, one, value);
        Signal::certain(b, value).with_range([-1.0, 1.0])
    })
}
