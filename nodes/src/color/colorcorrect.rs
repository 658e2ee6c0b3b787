//! Colour correction.

use crate::color::hsv::adjusted;
use crate::color::luminance::ACES_CG;
use crate::color::saturate::saturated;
use crate::componentwise::{composed, exposed};
use crate::port::number;
use crate::transfer::levels::curved;
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range, Reach,
};
use std::f32::consts::LN_2;

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "colorcorrect",
    aliases: &["color_correct", "color_correction", "grade"],
    category: Category::Color,
    summary: "Hue, saturation, gamma, lift, gain, contrast and exposure of a colour, in this order.",
    doc: Doc {
        computes: "As MaterialX: the hue turns as in `hsvadjust`; `saturate`, with the coefficients \
            of ACEScg; sign(x) |x|^(1/gamma); x (1 − lift) + lift; times gain; (x − \
            contrastpivot) contrast + contrastpivot; times 2^exposure. An alpha is kept.",
        statistics: "Linear steps are exact. The hue by the cubature of `hsvadjust`, where it is not the \
            number 0; the gamma as in `levels`, where it is not the number 1. Of varying \
            parameters the means are used.",
        accuracy: "Without hue and gamma, exact to rounding; with a gamma from 0.4 to 2.5 the mean is \
            within 5e-4 and the standard deviation within 1e-3 for Gaussian channels; with a hue, \
            as `hsvadjust`. Held by `nodes/src/tests/color.rs` against dense numerical \
            integration in f64.",
        references: cite!(hexcone, stroud, bussgang; "colorcorrect"),
    },
    inputs: &[
        PortSpec::new(
            "in",
            PortType::Color,
            Default::Color3([1.0; 3]),
            "The colour, linear Rec. 709.",
        ),
        number("hue", 0.0, "Turns to add to the hue.")
            .unit("turns")
            .range(Range::soft(-0.5, 0.5)),
        number("saturation", 1.0, "0 is grey, 1 changes nothing.").range(Range::soft(0.0, 2.0)),
        number("gamma", 1.0, "The inverse of the exponent.")
            .range(Range::hard(0.01, 100.0).with_soft(0.2, 5.0)),
        number("lift", 0.0, "Raises the dark end."),
        number("gain", 1.0, "The factor.").range(Range::soft(0.0, 4.0)),
        number("contrast", 1.0, "The factor about the pivot.").range(Range::soft(0.0, 4.0)),
        number("contrastpivot", 0.5, "What contrast leaves."),
        number("exposure", 0.0, "Stops of light.")
            .unit("stops")
            .range(Range::soft(-4.0, 4.0)),
    ],
    output: OutputType::Colored,
    reach: |_| Reach::ANY,
    class: |_| Behaviour::Function,
    example: example! { "colorcorrect", r#"
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "other": {"type": "noise2d", "inputs": {"frequency": 4, "pivot": 0.4, "seed": 3}},
    "color": {"type": "combine3", "inputs": {"in1": {"node": "noise"}, "in2": 0.25, "in3": {"node": "other"}}},
    "colorcorrect": {"type": "colorcorrect", "inputs": {"in": {"node": "color"}, "saturation": 1.2, "gamma": 1.4, "lift": 0.05, "exposure": 0.3}}
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let mut color = exposed(lower, node, "in");
    let alpha = color.split_off(3);
    let [hue, gamma, lift, gain, contrast, pivot] =
        ["hue", "gamma", "lift", "gain", "contrast", "contrastpivot"]
            .map(|port| lower.number(node, port));
    let saturation = Signal::certain(lower.number(node, "saturation"));
    let exposure = lower.number(node, "exposure");
    let mut out: Bundle<'b> = composed(lower, |lower| {
        let one = hue.literal(1.0);
        let turned = adjusted(lower, &color, [hue, one, one]);
        let weights = ACES_CG.map(|weight| hue.literal(weight));
        let color = saturated(lower, &turned, &saturation, &weights);
        let factor = (exposure * LN_2).clamp(-80.0, 80.0).exp();
        (color.iter())
            .map(|x| {
                let x = curved(lower, x, gamma, false);
                let x = (x * (1.0 - lift)).offset(lift) * gain;
                (x.offset(-pivot) * contrast).offset(pivot) * factor
            })
            .collect()
    });
    out.extend(alpha);
    out
}
