//! The inverse trigonometric functions, in the ops that every device has.

use crate::componentwise::{transfer, unary};
use crate::port::any;
use mipless_codegen::NodeDef;
use mipless_codegen::ir::Float;
use mipless_codegen::moments::Curve;
use mipless_graph::{Behaviour, Category, Doc, NodeSpec, OutputType, Range};
use std::f32::consts::{FRAC_PI_2, PI};

macro_rules! arcs {
    ($($node:ident {
        aliases: $aliases:expr,
        summary: $summary:literal,
        computes: $computes:literal,
        statistics: $statistics:literal,
        accuracy: $accuracy:literal,
        angle: $angle:expr,
        curve: |$b:ident| $curve:expr,
    })*) => {$(
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: stringify!($node),
                aliases: $aliases,
                category: Category::Transfer,
                summary: $summary,
                doc: Doc {
                    computes: $computes,
                    statistics: $statistics,
                    accuracy: concat!($accuracy, " Held by `nodes/src/tests/law.rs` against dense \
                        numerical integration in f64."),
                    references: cite!(abramowitz_polynomial, bussgang; stringify!($node)),
                },
                inputs: &[any("in", 0.0, "The number.").range(Range::soft(-1.0, 1.0))],
                output: OutputType::Widest,
                reach: |inputs| inputs.reach("in").monotone($angle),
                class: |_| Behaviour::Function,
                example: example! { stringify!($node), concat!(r#"
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 25}},
    "wave": {"type": "sin", "inputs": {"in": {"node": "turns"}}},
    "less": {"type": "multiply", "inputs": {"in1": {"node": "wave"}, "in2": 0.95}},
    ""#, stringify!($node), r#"": {"type": ""#, stringify!($node), r#"", "inputs": {"in": {"node": "less"}}}
"#) },
            };
            NodeDef::new(&SPEC, |lower, node| {
                let $b = lower.b();
                let curve = $curve;
                unary(lower, node, "in", |lower, x| transfer(lower, x, &curve))
            })
        }
    )*};
}

arcs! {
    acos {
        aliases: &["arccosine", "arccos", "math_arccosine"],
        summary: "The angle whose cosine a signal is.",
        computes: "out = arccos(in) in radians, from 0 to π, for each component; in is limited to \
            [−1, 1].",
        statistics: "By ten-point Gauss–Legendre quadrature between the places where the function bends \
            and closed forms where it is constant, of the difference from a line; the distortion as a \
            sum of squares. Approximate.",
        accuracy: "For a Gaussian input the mean is within 5e-4 and the standard deviation within 1e-3.",
        angle: |x| x.clamp(-1.0, 1.0).acos(),
        curve: |b| Curve {
            function: cosine,
            kinks: vec![b.float(-1.0), b.float(1.0)],
            flat: [PI, 0.0].map(|end| Some(b.float(end))),
            range: [0.0, PI],
        },
    }
    asin {
        aliases: &["arcsine", "arcsin", "math_arcsine"],
        summary: "The angle whose sine a signal is.",
        computes: "out = arcsin(in) in radians, from −π/2 to π/2, for each component; in is limited to \
            [−1, 1].",
        statistics: "By ten-point Gauss–Legendre quadrature between the places where the function bends \
            and closed forms where it is constant, of the difference from a line; the distortion as a \
            sum of squares. Approximate.",
        accuracy: "For a Gaussian input the mean is within 5e-4 and the standard deviation within 1e-3.",
        angle: |x| x.clamp(-1.0, 1.0).asin(),
        curve: |b| Curve {
            function: sine,
            kinks: vec![b.float(-1.0), b.float(1.0)],
            flat: [-FRAC_PI_2, FRAC_PI_2].map(|end| Some(b.float(end))),
            range: [-FRAC_PI_2, FRAC_PI_2],
        },
    }
    atan {
        aliases: &["arctangent", "arctan", "math_arctangent"],
        summary: "The angle whose tangent a signal is.",
        computes: "out = arctan(in) in radians, from −π/2 to π/2, for each component.",
        statistics: "By nine standard scores with positive weights, of the difference from a line: mean, \
            slope and curvature by their weights on the density (Stein), the distortion as a sum of \
            squares. Approximate.",
        accuracy: "For a Gaussian input with a spread up to 0.5 the mean is within 1e-4, up to 1.5 \
            within 0.02, of values from −1.6 to 1.6.",
        angle: f32::atan,
        curve: |_b| Curve::smooth(tangent, [-FRAC_PI_2, FRAC_PI_2]),
    }
}

/// Coefficients of arctan(t)/t in t², within 2e-8 on [0, 1] (Abramowitz & Stegun 4.4.49).
const ODD: [f32; 9] = [
    1.0,
    -0.333_331_45,
    0.199_935_51,
    -0.142_088_99,
    0.106_562_64,
    -0.075_289_64,
    0.042_909_614,
    -0.016_165_737,
    0.002_866_225_7,
];

/// arctan(t) for t in [0, 1].
fn octant(t: Float<'_>) -> Float<'_> {
    let [lower @ .., last] = ODD;
    let from = t.literal(last);
    t * (lower.iter().rev()).fold(from, |sum, &c| sum * t.square() + c)
}

/// The angle of the point (x, y), from −π to π; 0 at the origin.
pub(crate) fn angle<'b>(y: Float<'b>, x: Float<'b>) -> Float<'b> {
    let (across, up) = (x.abs(), y.abs());
    let acute = octant(across.min(up) / across.max(up).max(1e-30));
    let first = across.lt(up).select(FRAC_PI_2 - acute, acute);
    let upper = x.lt(0.0).select(PI - first, first);
    y.lt(0.0).select(-upper, upper)
}

/// arctan(x).
fn tangent(x: Float<'_>) -> Float<'_> {
    angle(x, x.literal(1.0))
}

/// x limited to [−1, 1], and √(1 − x²).
fn unit(x: Float<'_>) -> (Float<'_>, Float<'_>) {
    let x = x.clamp(-1.0, 1.0);
    (x, ((1.0 - x) * (1.0 + x)).sqrt())
}

/// arcsin(x) of x limited to [−1, 1].
fn sine(x: Float<'_>) -> Float<'_> {
    let (x, rest) = unit(x);
    angle(x, rest)
}

/// arccos(x) of x limited to [−1, 1].
fn cosine(x: Float<'_>) -> Float<'_> {
    let (x, rest) = unit(x);
    angle(rest, x)
}
