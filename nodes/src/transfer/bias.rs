//! Bias.

use crate::componentwise::{transfer, unary};
use mipless_codegen::ir::{Builder, Value};
use mipless_codegen::moments::Curve;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "bias",
    aliases: &["schlick_bias", "tones_bias"],
    category: Category::Transfer,
    summary: "Pulls the middle of [0, 1] up or down.",
    doc: Doc {
        computes: "out = t / ((1/bias − 2)(1 − t) + 1) with t = in limited to [0, 1], for each \
            component: ½ becomes bias, 0 and 1 stay.",
        statistics: "By ten-point Gauss–Legendre quadrature between the places where the function bends \
            and closed forms where it is constant, of the difference from a line; the distortion \
            as a sum of squares. Approximate. Of a varying bias the mean is used.",
        accuracy: "For a Gaussian input and parameters from 0.1 to 0.9 the mean is within 1e-4 and the \
            standard deviation within 2e-4. Held by `nodes/src/tests/law.rs` against dense \
            numerical integration in f64.",
        references: "Schlick 1994, *Fast Alternatives to Perlin’s Bias and Gain Functions*, in *Graphics \
            Gems IV*, pp. 401–403. Perlin & Hoffert 1989, *Hypertexture*. Bussgang 1952, \
            *Crosscorrelation functions of amplitude-distorted Gaussian signals*; Stein 1981, \
            *Estimation of the mean of a multivariate normal distribution*, lemma 1.",
    },
    inputs: &[
        PortSpec::new("in", PortType::Any, Default::Float(0.0), "The signal."),
        PortSpec::new(
            "bias",
            PortType::Exactly(Type::Float),
            Default::Float(0.5),
            "What ½ becomes.",
        )
        .range(Range::hard(0.01, 0.99)),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "bias_example",
  "nodes": {
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 25}},
    "wave": {"type": "sin", "inputs": {"in": {"node": "turns"}}},
    "bias": {"type": "bias", "inputs": {"in": {"node": "wave"}, "bias": 0.3}}
  },
  "outputs": { "out": { "node": "bias" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let bias = lower.number(node, "bias");
    let b = lower.b();
    let (zero, one) = (b.f32(0.0), b.f32(1.0));
    let bend = bend(b, bias);
    let curve = Curve {
        function: move |b: &mut Builder, x| {
            let t = b.clamp(x, 0.0, 1.0);
            biased(b, bend, t)
        },
        kinks: vec![zero, one],
        flat: [Some(zero), Some(one)],
        range: [0.0, 1.0],
    };
    unary(lower, node, "in", |lower, x| transfer(lower, x, &curve))
}

/// 1/bias − 2.
pub(crate) fn bend(b: &mut Builder, bias: Value) -> Value {
    let bias = b.clamp(bias, 0.01, 0.99);
    let one = b.f32(1.0);
    let inverse = b.div(one, bias);
    b.offset(inverse, -2.0)
}

/// t / (bend (1 − t) + 1).
pub(crate) fn biased(b: &mut Builder, bend: Value, t: Value) -> Value {
    let one = b.f32(1.0);
    let rest = b.sub(one, t);
    let below = b.mul(bend, rest);
    let below = b.offset(below, 1.0);
    b.div(t, below)
}
