//! Levels with gamma.

use crate::componentwise::{composed, exposed, numbers, product, transfer};
use mipless_codegen::ir::{Builder, Value};
use mipless_codegen::moments::{Curve, Piecewise, RealPower, Reciprocal, Signal, Transfer};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "levels",
    aliases: &["tones", "tone_curve"],
    category: Category::Transfer,
    summary: "Maps one range of numbers to another along a power curve.",
    doc: Doc {
        computes: "t = (in − inlow)/(inhigh − inlow), limited to [0, 1] if `doclamp` is set; out = \
            outlow + sign(t) |t|^(1/gamma) (outhigh − outlow), for each component: MaterialX’s \
            `range` with its gamma. A range narrower than 1e-6 counts as 1e-6 wide.",
        statistics: "By ten-point Gauss–Legendre quadrature between the places where the function bends \
            and closed forms where it is constant, of the difference from a line; the distortion \
            as a sum of squares. Approximate. With a gamma of 1, as `range`, exact for a \
            Gaussian. Of varying inlow, inhigh and gamma the means are used; outlow and outhigh \
            multiply as `multiply` does.",
        accuracy: "For a Gaussian input and a gamma from 0.4 to 2.5 the mean is within 3e-4 of the \
            output range, the standard deviation within 5e-4. Held by `nodes/src/tests/law.rs` \
            against dense numerical integration in f64.",
        references: "Bussgang 1952, *Crosscorrelation functions of amplitude-distorted Gaussian signals*; \
            Stein 1981, *Estimation of the mean of a multivariate normal distribution*, lemma 1. \
            MaterialX 1.39 specification, node `range`.",
    },
    inputs: &[
        PortSpec::new("in", PortType::Any, Default::Float(0.0), "The signal."),
        PortSpec::new(
            "inlow",
            PortType::Any,
            Default::Float(0.0),
            "What maps to outlow.",
        ),
        PortSpec::new(
            "inhigh",
            PortType::Any,
            Default::Float(1.0),
            "What maps to outhigh.",
        ),
        PortSpec::new(
            "gamma",
            PortType::Any,
            Default::Float(1.0),
            "The inverse of the exponent.",
        )
        .range(Range::hard(0.01, 100.0).with_soft(0.2, 5.0)),
        PortSpec::new(
            "outlow",
            PortType::Any,
            Default::Float(0.0),
            "The result at inlow.",
        ),
        PortSpec::new(
            "outhigh",
            PortType::Any,
            Default::Float(1.0),
            "The result at inhigh.",
        ),
        PortSpec::new(
            "doclamp",
            PortType::Exactly(Type::Boolean),
            Default::Boolean(false),
            "Whether the result is limited to lie between outlow and outhigh.",
        )
        .uniform(),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "levels_example",
  "nodes": {
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 25}},
    "wave": {"type": "sin", "inputs": {"in": {"node": "turns"}}},
    "levels": {"type": "levels", "inputs": {"in": {"node": "wave"}, "inlow": -0.8, "gamma": 2.2, "doclamp": true}}
  },
  "outputs": { "out": { "node": "levels" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let limited = lower.flag(node, "doclamp");
    let input = lower.bundle(node, "in");
    let [low, high, gamma] = ["inlow", "inhigh", "gamma"].map(|port| numbers(lower, node, port));
    let [outlow, outhigh] = ["outlow", "outhigh"].map(|port| exposed(lower, node, port));
    composed(lower, |lower| {
        (0..input.len())
            .map(|i| {
                let b = lower.b();
                let width = b.sub(high[i], low[i]);
                let gain = Reciprocal.value(b, width);
                let minus = b.neg(low[i]);
                let share = input[i].offset(b, minus).scale(b, gain);
                let share = curved(lower, &share, gamma[i], limited);
                let span = outhigh[i].sub(lower.b(), &outlow[i]);
                let rise = product(lower, &span, &share);
                outlow[i].add(lower.b(), &rise)
            })
            .collect()
    })
}

/// sign(t) |t|^(1/gamma), of t limited to [0, 1] or not.
pub(crate) fn curved(lower: &mut Lower<'_>, share: &Signal, gamma: Value, limited: bool) -> Signal {
    let b = lower.b();
    let (zero, one) = (b.f32(0.0), b.f32(1.0));
    if b.as_constant(gamma) == Some(1.0) {
        let clamp = Piecewise::clamp(b, zero, one);
        return if limited {
            transfer(lower, share, &clamp)
        } else {
            share.clone()
        };
    }
    let least = b.f32(0.01);
    let gamma = b.max(gamma, least);
    let power = b.div(one, gamma);
    let curve = Curve {
        function: move |b: &mut Builder, t| signed_power(b, t, power, limited),
        kinks: if limited { vec![zero, one] } else { vec![zero] },
        flat: if limited {
            [Some(zero), Some(one)]
        } else {
            [None; 2]
        },
        range: if limited {
            [0.0, 1.0]
        } else {
            [f32::NEG_INFINITY, f32::INFINITY]
        },
    };
    transfer(lower, share, &curve)
}

fn signed_power(b: &mut Builder, t: Value, power: Value, limited: bool) -> Value {
    let t = if limited { b.clamp(t, 0.0, 1.0) } else { t };
    let magnitude = b.abs(t);
    let raised = RealPower { power }.value(b, magnitude);
    if limited {
        return raised;
    }
    let (zero, minus) = (b.f32(0.0), b.neg(raised));
    let negative = b.lt(t, zero);
    b.select(negative, minus, raised)
}
