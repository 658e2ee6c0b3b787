//! Schlick's bias and gain: curves of [0, 1] that keep its ends.

use crate::componentwise::{transfer, unary};
use crate::port::{any, number};
use mipless_codegen::NodeDef;
use mipless_codegen::ir::Float;
use mipless_codegen::moments::Curve;
use mipless_graph::{Behaviour, Category, Doc, NodeSpec, OutputType, Range, Reach};

macro_rules! curves {
    ($($node:ident {
        aliases: $aliases:expr,
        summary: $summary:literal,
        computes: $computes:literal,
        parameter: $parameter:literal,
        example: $example:literal,
        kinks: $kinks:expr,
        bias: |$value:ident| $bias:expr,
        function: $function:ident,
    })*) => {$(
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: stringify!($node),
                aliases: $aliases,
                category: Category::Transfer,
                summary: $summary,
                doc: Doc {
                    computes: $computes,
                    statistics: concat!("By ten-point Gauss–Legendre quadrature between the places \
                        where the function bends and closed forms where it is constant, of the \
                        difference from a line; the distortion as a sum of squares. Approximate. Of \
                        a varying ", stringify!($node), " the mean is used."),
                    accuracy: "For a Gaussian input and parameters from 0.1 to 0.9 the mean is within \
                        1e-4 and the standard deviation within 2e-4. Held by \
                        `nodes/src/tests/law.rs` against dense numerical integration in f64.",
                    references: cite!(
                        "Schlick 1994, *Fast Alternatives to Perlin’s Bias and Gain Functions*, in \
                         *Graphics Gems IV*, pp. 401–403. Perlin & Hoffert 1989, *Hypertexture*.",
                        bussgang
                    ),
                },
                inputs: &[
                    any("in", 0.0, "The signal."),
                    number(stringify!($node), 0.5, $parameter).range(Range::hard(0.01, 0.99)),
                ],
                output: OutputType::Widest,
                reach: |_| Reach::of(0.0, 1.0),
                class: |_| Behaviour::Function,
                example: example! { stringify!($node), concat!(r#"
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 25}},
    "wave": {"type": "sin", "inputs": {"in": {"node": "turns"}}},
"#, $example) },
            };
            NodeDef::new(&SPEC, |lower, node| {
                let $value = lower.number(node, stringify!($node));
                let bend = bend($bias);
                let curve = Curve {
                    function: move |x| $function(bend, limited(x)),
                    kinks: $kinks.map(|at: f32| bend.literal(at)).to_vec(),
                    flat: [0.0, 1.0].map(|end| Some(bend.literal(end))),
                    range: [0.0, 1.0],
                };
                unary(lower, node, "in", |lower, x| transfer(lower, x, &curve))
            })
        }
    )*};
}

curves! {
    bias {
        aliases: &["schlick_bias", "tones_bias"],
        summary: "Pulls the middle of [0, 1] up or down.",
        computes: "out = t / ((1/bias − 2)(1 − t) + 1) with t = in limited to [0, 1], for each \
            component: ½ becomes bias, 0 and 1 stay.",
        parameter: "What ½ becomes.",
        example: r#"    "bias": {"type": "bias", "inputs": {"in": {"node": "wave"}, "bias": 0.3}}
"#,
        kinks: [0.0, 1.0],
        bias: |bias| bias,
        function: biased,
    }
    gain {
        aliases: &["schlick_gain", "tones_gain", "s_curve"],
        summary: "Steepens or flattens the middle of [0, 1].",
        computes: "out = ½ bias(2t, 1 − gain) below t = ½ and 1 − ½ bias(2 − 2t, 1 − gain) above, with t \
            = in limited to [0, 1] and `bias` as in the node of that name, for each component.",
        parameter: "½ changes nothing; less is flatter in the middle, more is steeper.",
        example: r#"    "gain": {"type": "gain", "inputs": {"in": {"node": "wave"}, "gain": 0.8}}
"#,
        kinks: [0.0, 0.5, 1.0],
        bias: |gain| 1.0 - gain,
        function: gained,
    }
}

/// 1/bias − 2.
fn bend(bias: Float<'_>) -> Float<'_> {
    1.0 / bias.clamp(0.01, 0.99) + -2.0
}

fn limited(x: Float<'_>) -> Float<'_> {
    x.clamp(0.0, 1.0)
}

/// t / (bend (1 − t) + 1).
fn biased<'b>(bend: Float<'b>, t: Float<'b>) -> Float<'b> {
    t / (bend * (1.0 - t) + 1.0)
}

/// Both halves are the bias of the distance from the nearer end.
fn gained<'b>(bend: Float<'b>, t: Float<'b>) -> Float<'b> {
    let back = 1.0 - t;
    let nearer = t.min(back);
    let rise = 0.5 * biased(bend, nearer + nearer);
    t.lt(back).select(rise, 1.0 - rise)
}
