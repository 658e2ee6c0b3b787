//! Saturation.

use crate::color::luminance::{COLOR, LUMACOEFFS};
use crate::componentwise::{composed, exposed, numbers, product, total};
use crate::port::number;
use mipless_codegen::ir::Float;
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType, Range, Reach,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "saturate",
    aliases: &["saturation", "adjust_saturation"],
    category: Category::Color,
    summary: "Moves a colour away from the grey of its luminance, or towards it.",
    doc: Doc {
        computes: "out = L + amount (in − L) with L = lumacoeffs · in, beside the alpha that in has. \
            The coefficients are those of ACEScg, as in MaterialX.",
        statistics: "By a number, linear and exact as far as the covariances of the channels are carried. \
            A varying amount multiplies as `multiply` does. Of varying coefficients the means are \
            used.",
        accuracy: "Exact to rounding by a number; else as `multiply`. Held by `nodes/src/tests/color.rs` \
            against dense numerical integration in f64.",
        references: cite!(rec709, linear; "saturate"),
    },
    inputs: &[
        COLOR,
        number("amount", 1.0, "0 is grey, 1 changes nothing.").range(Range::soft(0.0, 2.0)),
        LUMACOEFFS,
    ],
    output: OutputType::Colored,
    reach: |_| Reach::ANY,
    class,
    example: example! { "saturate", r#"
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "color": {"type": "combine3", "inputs": {"in1": {"node": "noise"}, "in2": 0.3, "in3": {"node": "bands"}}},
    "saturate": {"type": "saturate", "inputs": {"in": {"node": "color"}, "amount": 0.4}}
"# },
};

/// Linear but for a varying amount.
fn class(inputs: &dyn InputView) -> Behaviour {
    if inputs.varies("amount") {
        Behaviour::Product
    } else {
        Behaviour::Linear
    }
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let mut color = exposed(lower, node, "in");
    let alpha = color.split_off(3);
    let amount = lower.signal(node, "amount");
    let weights = numbers(lower, node, "lumacoeffs");
    let mut out = composed(lower, |lower| saturated(lower, &color, &amount, &weights));
    out.extend(alpha);
    out
}

/// L + amount (in − L).
pub(super) fn saturated<'b>(
    lower: &mut Lower<'_, 'b>,
    color: &[Signal<'b>],
    amount: &Signal<'b>,
    weights: &[Float<'b>],
) -> Bundle<'b> {
    let weighted = color.iter().zip(weights).map(|(x, &weight)| x * weight);
    let grey = total(lower.b(), weighted);
    let saturated = |x: &Signal<'b>| product(lower, &(x - &grey), amount) + &grey;
    color.iter().map(saturated).collect()
}
