//! Angle of a point.

use crate::componentwise::{binary, composed, transfer};
use crate::transfer::arc;
use mipless_codegen::moments::{LinearWave, Signal};
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
        statistics: "The angle from the direction of the mean, by a cubature of degree 5 over the joint \
            Gaussian of the inputs with positive weights, plus that direction, as a sawtooth of \
            the sum: the jump from π to −π is a jump of the sawtooth, not a kink of the cubature. \
            Approximate; where the footprint holds the origin, by a large part of the result.",
        accuracy: "For a point at least four standard deviations from the origin the mean and the standard \
            deviation are within 1e-3, where the angle jumps within 1e-3 and 5e-3; where the footprint \
            holds the origin within 0.1 and 0.6. Held by `nodes/src/tests/vector.rs` against dense \
            numerical integration in f64.",
        references: "Stroud 1971, *Approximate Calculation of Multiple Integrals*, U_n 5. Abramowitz & \
            Stegun 4.4.49 (the polynomial). MaterialX 1.39 specification, node `atan2`.",
    },
    inputs: &[
        PortSpec::new("iny", PortType::Any, Default::Float(0.0), "Up."),
        PortSpec::new("inx", PortType::Any, Default::Float(1.0), "Across."),
    ],
    output: OutputType::Widest,
    class: |inputs| {
        if inputs.varies("iny") && inputs.varies("inx") {
            Behaviour::Rough {
                error: 0.08,
                place: "has a mean that is off by up to 0.1 radians, and a standard deviation by 0.6, \
                    where the footprint holds the origin",
            }
        } else {
            Behaviour::Function
        }
    },
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
    use std::f32::consts::{PI, TAU};
    binary(lower, node, ["iny", "inx"], |lower, y, x| {
        let spreads = lower.mode().spreads();
        let b = lower.b();
        let mean = [y, x].map(|axis| axis.flat_mean(b));
        if !spreads || (y.is_certain(b) && x.is_certain(b)) {
            let angle = arc::angle(b, mean[0], mean[1]);
            return Signal::certain(b, angle).with_range([-PI, PI]);
        }
        composed(lower, |lower| {
            let b = lower.b();
            // Of the origin any direction will do.
            let square = b.dot(&mean, &mean);
            let (least, one) = (b.f32(1e-20), b.f32(1.0));
            let somewhere = b.lt(least, square);
            let [up, across] = mean;
            let across = b.select(somewhere, across, one);
            let from = arc::angle(b, up, across);
            let inputs = [y.clone(), x.clone()];
            let turned = lower.algebra.cubature(&inputs, &[[-PI, PI]], |b, values| {
                let along = b.dot(values, &[up, across]);
                let back = b.neg(up);
                let aside = b.dot(values, &[across, back]);
                vec![arc::angle(b, aside, along)]
            });
            let b = lower.b();
            let turn = b.f32(1.0 / TAU);
            let turns = turned[0].offset(b, from).scale(b, turn);
            let half = b.f32(0.5);
            let turns = turns.offset(b, half);
            let wrapped = transfer(lower, &turns, &LinearWave::sawtooth());
            let b = lower.b();
            let start = b.f32(-PI);
            let whole = b.f32(TAU);
            wrapped
                .scale(b, whole)
                .offset(b, start)
                .with_range([-PI, PI])
        })
    })
}
