//! Angle of a point.

use crate::arc;
use crate::componentwise::binary;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType,
};

static SPEC: NodeSpec = NodeSpec {
    name: "atan2",
    aliases: &["arctan2", "arctangent2", "math_arctan2"],
    category: Category::Arithmetic,
    summary: "The angle of the point (inx, iny).",
    doc: Doc {
        computes: "out = the angle of (inx, iny) in radians, from −π to π; 0 at the origin.",
        statistics: "By a cubature of degree 5 over the joint Gaussian of the inputs, with positive \
            weights: mean, the slopes by each input, and the rest as a sum of squares. \
            Approximate; where the footprint holds the origin or the jump from π to −π, by a \
            large part of the result.",
        accuracy: "For a point at least four standard deviations from the origin and from the jump the \
            mean and the standard deviation are within 1e-3; at the origin within 0.6; at the \
            jump, where half of the footprint is at π and half at −π, the mean is off by up to \
            2.2. Held by `nodes/src/tests/vector.rs` against dense numerical integration in f64.",
        references: "Stroud 1971, *Approximate Calculation of Multiple Integrals*, U_n 5. Abramowitz & \
            Stegun 4.4.49 (the polynomial). MaterialX 1.39 specification, node `atan2`.",
    },
    inputs: &[
        PortSpec::new("iny", PortType::Any, Default::Float(0.0), "Up."),
        PortSpec::new("inx", PortType::Any, Default::Float(1.0), "Across."),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "atan2_example",
  "nodes": {
    "up": {"type": "noise2d", "inputs": {"frequency": 5}},
    "across": {"type": "noise2d", "inputs": {"frequency": 4, "amplitude": 0.5, "pivot": 1, "seed": 3}},
    "atan2": {"type": "atan2", "inputs": {"iny": {"node": "up"}, "inx": {"node": "across"}}}
  },
  "outputs": { "out": { "node": "atan2" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    use std::f32::consts::PI;
    binary(lower, node, ["iny", "inx"], |lower, y, x| {
        let inputs = [y.clone(), x.clone()];
        let mut out = lower.algebra.cubature(&inputs, &[[-PI, PI]], |b, values| {
            vec![arc::angle(b, values[0], values[1])]
        });
        out.remove(0)
    })
}
