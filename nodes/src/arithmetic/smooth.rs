//! Extrema whose corner is rounded.

use crate::componentwise::{binary, composed, transfer};
use crate::port::{any, number};
use mipless_codegen::moments::{Piecewise, Signal};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Range, Reach};

macro_rules! extrema {
    ($($node:ident {
        aliases: $aliases:expr,
        which: $which:literal,
        sign: $sign:literal,
        apart: |$apart:ident| $signed:expr,
    })*) => {$(
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: stringify!($node),
                aliases: $aliases,
                category: Category::Arithmetic,
                summary: concat!("The ", $which, " of two signals, blended where they are close."),
                doc: Doc {
                    computes: concat!("out = ½(in1 + in2 ", $sign, " s) with s = |in1 − in2|, its corner \
                        rounded by the parabola (d² + k²)/2k where |d| = |in1 − in2| < k = width, for \
                        each component."),
                    statistics: "A sum, and a piecewise quadratic function of the difference by \
                        truncated moments. Exact for jointly Gaussian signals, with their covariance. \
                        Of a varying width the mean is used.",
                    accuracy: "For jointly Gaussian inputs the mean and the standard deviation are \
                        those of the function, within 1e-3. Held by \
                        `nodes/src/tests/combination.rs` against dense numerical integration in f64.",
                    references: cite!(
                        "Quilez 2013, *Smooth minimum* (the quadratic polynomial form).",
                        bussgang
                    ),
                },
                inputs: &[
                    any("in1", 0.0, "The first operand."),
                    any("in2", 0.0, "The second operand."),
                    number("width", 0.1, "How far apart the signals are where the blend ends.")
                        .range(Range::hard(0.0, f32::MAX).with_soft(0.0, 1.0)),
                ],
                output: OutputType::Widest,
                reach: |_| Reach::ANY,
                class: |_| Behaviour::Function,
                example: example! { stringify!($node), concat!(r#"
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    ""#, stringify!($node), r#"": {"type": ""#, stringify!($node),
                    r#"", "inputs": {"in1": {"node": "bands"}, "in2": {"node": "noise"}, "width": 0.3}}
"#) },
            };
            NodeDef::new(&SPEC, |lower, node| rounded(lower, node, |$apart| $signed))
        }
    )*};
}

extrema! {
    smoothmax {
        aliases: &["smooth_maximum", "smooth_max"],
        which: "larger",
        sign: "+",
        apart: |apart| apart,
    }
    smoothmin {
        aliases: &["smooth_minimum", "smooth_min", "smooth_minmax"],
        which: "smaller",
        sign: "−",
        apart: |apart| -apart,
    }
}

/// ½(X + Y ± s): half of the sum and of what `signed` makes of the rounded |X − Y|.
fn rounded<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    signed: impl Fn(Signal<'b>) -> Signal<'b>,
) -> Bundle<'b> {
    let width = lower.number(node, "width");
    binary(lower, node, ["in1", "in2"], |lower, x, y| {
        composed(lower, |lower| {
            let [x, y] = [x, y].map(|signal| lower.algebra.expose(signal));
            let apart = transfer(lower, &(&x - &y), &Piecewise::rounded(width));
            (x + y + signed(apart)) * 0.5
        })
    })
}
