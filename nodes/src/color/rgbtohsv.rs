//! Hue, saturation, value.

use crate::color::hsv::to_hsv_function;
use crate::color::luminance::COLOR;
use crate::componentwise::{composed, exposed};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Reach};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "rgbtohsv",
    aliases: &["rgb_to_hsv", "separate_hsv"],
    category: Category::Color,
    summary: "The hue, saturation and value of a colour.",
    doc: Doc {
        computes: "With M and m the largest and least channel: value M, saturation (M − m)/M, and the \
            hue in turns: (g − b)/(M − m)/6 where red is largest, ⅓ and ⅔ further where green and \
            blue are; from 0 up to 1; 0 for a grey; black and what is below it have saturation \
            0. An alpha is kept.",
        statistics: "By a cubature of degree 5 over the joint Gaussian of the three channels, thirteen \
            evaluations with positive weights: the mean, the slope by each channel, and the rest \
            as a sum of squares. Approximate: the hue jumps from 1 to 0 at red and is free at \
            grey, where it is off by a large part of a turn; a colour that is averaged in \
            `hsvadjust` or `hsvtorgb` is not. The value is a maximum by Clark’s moments.",
        accuracy: "For a colour whose channels lie at least four standard deviations apart, away from \
            red, the means and standard deviations are within 0.005; where their order changes \
            within the footprint, the value within 0.005, the saturation within 0.06 and the hue \
            within 0.25. Held by `nodes/src/tests/color.rs` against dense numerical integration \
            in f64.",
        references: cite!(hexcone, stroud, clark; "rgbtohsv"),
    },
    inputs: &[COLOR],
    output: OutputType::Colored,
    reach: |_| Reach::ANY,
    class: |inputs| {
        if inputs.varies("in") {
            Behaviour::Rough {
                error: 0.11,
                place: "has a hue that is off by up to a quarter of a turn near grey and at red",
            }
        } else {
            Behaviour::Function
        }
    },
    example: example! { "rgbtohsv", r#"
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "amplitude": 0.2, "pivot": 0.8}},
    "other": {"type": "noise2d", "inputs": {"frequency": 4, "amplitude": 0.2, "pivot": 0.45, "seed": 3}},
    "color": {"type": "combine3", "inputs": {"in1": {"node": "noise"}, "in2": 0.15, "in3": {"node": "other"}}},
    "rgbtohsv": {"type": "rgbtohsv", "inputs": {"in": {"node": "color"}}}
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let mut color = exposed(lower, node, "in");
    let alpha = color.split_off(3);
    let b = lower.b();
    let function = lower.function("rgb_to_hsv", to_hsv_function);
    composed(lower, |lower| {
        let ranges = [[0.0, 1.0], UNBOUNDED];
        let mut out = (lower.algebra).cubature(&color, &ranges, |rgb| {
            let mut hsv = b.call(&function, rgb);
            hsv.truncate(2);
            hsv
        });
        let largest = lower.algebra.maximum(&color[0], &color[1]);
        out.push(lower.algebra.maximum(&largest, &color[2]));
        out.extend(alpha);
        out
    })
}

const UNBOUNDED: [f32; 2] = [f32::NEG_INFINITY, f32::INFINITY];
