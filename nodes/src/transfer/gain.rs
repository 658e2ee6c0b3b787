//! Gain.

use crate::componentwise::{transfer, unary};
use crate::transfer::bias::{bend, biased};
use mipless_codegen::ir::{Builder, Value};
use mipless_codegen::moments::Curve;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "gain",
    aliases: &["schlick_gain", "tones_gain", "s_curve"],
    category: Category::Transfer,
    summary: "Steepens or flattens the middle of [0, 1].",
    doc: Doc {
        computes: "out = ½ bias(2t, 1 − gain) below t = ½ and 1 − ½ bias(2 − 2t, 1 − gain) above, with t \
            = in limited to [0, 1] and `bias` as in the node of that name, for each component.",
        statistics: "By ten-point Gauss–Legendre quadrature between the places where the function bends \
            and closed forms where it is constant, of the difference from a line; the distortion \
            as a sum of squares. Approximate. Of a varying gain the mean is used.",
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
            "gain",
            PortType::Exactly(Type::Float),
            Default::Float(0.5),
            "½ changes nothing; less is flatter in the middle, more is steeper.",
        )
        .range(Range::hard(0.01, 0.99)),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "gain_example",
  "nodes": {
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 25}},
    "wave": {"type": "sin", "inputs": {"in": {"node": "turns"}}},
    "gain": {"type": "gain", "inputs": {"in": {"node": "wave"}, "gain": 0.8}}
  },
  "outputs": { "out": { "node": "gain" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let gain = lower.number(node, "gain");
    let b = lower.b();
    let (zero, one) = (b.f32(0.0), b.f32(1.0));
    let half = b.f32(0.5);
    let bias = b.sub(one, gain);
    let bend = bend(b, bias);
    let curve = Curve {
        function: move |b: &mut Builder, x| gained(b, bend, x),
        kinks: vec![zero, half, one],
        flat: [Some(zero), Some(one)],
        range: [0.0, 1.0],
    };
    unary(lower, node, "in", |lower, x| transfer(lower, x, &curve))
}

/// Both halves are the bias of the distance from the nearer end.
fn gained(b: &mut Builder, bend: Value, x: Value) -> Value {
    let t = b.clamp(x, 0.0, 1.0);
    let one = b.f32(1.0);
    let back = b.sub(one, t);
    let nearer = b.min(t, back);
    let twice = b.add(nearer, nearer);
    let rise = biased(b, bend, twice);
    let rise = b.scale(rise, 0.5);
    let fall = b.sub(one, rise);
    let first = b.lt(t, back);
    b.select(first, rise, fall)
}
