//! Smooth maximum.

use crate::componentwise::{binary, composed, transfer};
use mipless_codegen::moments::Piecewise;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "smoothmax",
    aliases: &["smooth_maximum", "smooth_max"],
    category: Category::Arithmetic,
    summary: "The larger of two signals, blended where they are close.",
    doc: Doc {
        computes: "out = ½(in1 + in2 + s) with s = |in1 − in2|, its corner rounded by the parabola (d² + \
            k²)/2k where |d| = |in1 − in2| < k = width, for each component.",
        statistics: "A sum, and a piecewise quadratic function of the difference by truncated moments. \
            Exact for jointly Gaussian signals, with their covariance. Of a varying width the \
            mean is used.",
        accuracy: "For jointly Gaussian inputs the mean and the standard deviation are those of the \
            function, within 1e-3. Held by `nodes/src/tests/combination.rs` against dense \
            numerical integration in f64.",
        references: "Quilez 2013, *Smooth minimum* (the quadratic polynomial form). Bussgang 1952, \
            *Crosscorrelation functions of amplitude-distorted Gaussian signals*; Stein 1981, \
            *Estimation of the mean of a multivariate normal distribution*, lemma 1.",
    },
    inputs: &[
        PortSpec::new(
            "in1",
            PortType::Any,
            Default::Float(0.0),
            "The first operand.",
        ),
        PortSpec::new(
            "in2",
            PortType::Any,
            Default::Float(0.0),
            "The second operand.",
        ),
        PortSpec::new(
            "width",
            PortType::Exactly(Type::Float),
            Default::Float(0.1),
            "How far apart the signals are where the blend ends.",
        )
        .range(Range::hard(0.0, f32::MAX).with_soft(0.0, 1.0)),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "smoothmax_example",
  "nodes": {
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "smoothmax": {"type": "smoothmax", "inputs": {"in1": {"node": "bands"}, "in2": {"node": "noise"}, "width": 0.3}}
  },
  "outputs": { "out": { "node": "smoothmax" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let width = lower.number(node, "width");
    binary(lower, node, ["in1", "in2"], |lower, x, y| {
        composed(lower, |lower| {
            let [x, y] = [x, y].map(|signal| lower.algebra.expose(signal));
            let b = lower.b();
            let (apart, rounded) = (x.sub(b, &y), Piecewise::rounded(b, width));
            let apart = transfer(lower, &apart, &rounded);
            let b = lower.b();
            let half = b.f32(0.5);
            x.add(b, &y).add(b, &apart).scale(b, half)
        })
    })
}
