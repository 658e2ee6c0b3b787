//! Angle of a point.

use crate::componentwise::{binary, composed, transfer};
use crate::port::any;
use crate::transfer::arc;
use mipless_codegen::moments::{LinearWave, Signal};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Reach};
use std::f32::consts::{PI, TAU};

pub(super) static SPEC: NodeSpec = NodeSpec {
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
        references: cite!(stroud, abramowitz_polynomial; "atan2"),
    },
    inputs: &[any("iny", 0.0, "Up."), any("inx", 1.0, "Across.")],
    output: OutputType::Widest,
    reach: |_| Reach::of(-PI, PI),
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
    example: example! { "atan2", r#"
    "up": {"type": "noise2d", "inputs": {"frequency": 5}},
    "across": {"type": "noise2d", "inputs": {"frequency": 4, "amplitude": 0.5, "pivot": 1, "seed": 3}},
    "atan2": {"type": "atan2", "inputs": {"iny": {"node": "up"}, "inx": {"node": "across"}}}
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    binary(lower, node, ["iny", "inx"], |lower, y, x| {
        let [up, across] = [y, x].map(Signal::flat_mean);
        if !lower.mode().spreads() || (y.is_certain() && x.is_certain()) {
            return Signal::certain(arc::angle(up, across)).with_range([-PI, PI]);
        }
        composed(lower, |lower| {
            // Of the origin any direction will do.
            let somewhere = (up * up + across * across).gt(1e-20);
            let across = somewhere.select(across, 1.0);
            let inputs = [y.clone(), x.clone()];
            let turned = lower.algebra.cubature(&inputs, &[[-PI, PI]], |point| {
                let along = point[0] * up + point[1] * across;
                let aside = point[0] * across + point[1] * -up;
                vec![arc::angle(aside, along)]
            });
            let turns = turned[0].offset(arc::angle(up, across)) * (1.0 / TAU);
            let wrapped = transfer(lower, &turns.offset(0.5), &LinearWave::sawtooth());
            (wrapped * TAU).offset(-PI).with_range([-PI, PI])
        })
    })
}
