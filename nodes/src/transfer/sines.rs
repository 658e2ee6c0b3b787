//! The sine and the cosine.

use crate::componentwise::{transfer, unary};
use crate::port::any;
use mipless_codegen::NodeDef;
use mipless_codegen::moments::Sine;
use mipless_graph::{Behaviour, Category, Doc, NodeSpec, OutputType, Range, Reach};
use std::f32::consts::FRAC_PI_2;

macro_rules! sines {
    ($($node:ident $word:literal {
        mean: $mean:literal,
        slope: $slope:literal,
        squares: [$first:literal, $second:literal],
        tests: $tests:literal,
        example: $example:literal,
        phase: $phase:expr,
    })*) => {$(
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: stringify!($node),
                aliases: &[$word, concat!("math_", $word)],
                category: Category::Transfer,
                summary: concat!("The ", $word, " of a signal in radians."),
                doc: Doc {
                    computes: concat!("out = ", stringify!($node), "(in), for each component; in is \
                        reduced to one turn first, so that every device agrees."),
                    statistics: concat!("For a Gaussian input with mean m and variance v: E = ",
                        $mean, "e^{−v/2}, slope ", $slope, "e^{−v/2}, distortion ", $first,
                        "e^{−v}(sinh v − v) + ½ ", $second, "(1 − e^{−v})². Exact. Over a large \
                        footprint the mean goes to 0 and the variance to ½."),
                    accuracy: concat!("For a Gaussian input with |in| up to 100 the mean is within \
                        1e-5, which is the rounding of the argument in f32. Held by `", $tests, "` \
                        against dense numerical integration in f64."),
                    references: cite!(characteristic, bussgang; stringify!($node)),
                },
                inputs: &[any("in", 0.0, "The angle.").range(Range::soft(-3.15, 3.15)).unit("radians")],
                output: OutputType::Widest,
                reach: |_| Reach::of(-1.0, 1.0),
                class: |_| Behaviour::Function,
                example: example! { stringify!($node), $example },
            };
            NodeDef::new(&SPEC, |lower, node| {
                unary(lower, node, "in", |lower, x| transfer(lower, x, &Sine { phase: $phase }))
            })
        }
    )*};
}

sines! {
    cos "cosine" {
        mean: "cos(m)",
        slope: "−sin(m)",
        squares: ["sin²(m)", "cos²(m)"],
        tests: "nodes/src/tests/law.rs",
        example: r#"
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 10}},
    "cos": {"type": "cos", "inputs": {"in": {"node": "turns"}}}
"#,
        phase: FRAC_PI_2,
    }
    sin "sine" {
        mean: "sin(m)",
        slope: "cos(m)",
        squares: ["cos²(m)", "sin²(m)"],
        tests: "codegen/src/moments/tests.rs",
        example: r#"
    "uv": { "type": "texcoord" },
    "u": { "type": "extract", "inputs": { "in": { "node": "uv" }, "index": 0 } },
    "turns": { "type": "multiply", "inputs": { "in1": { "node": "u" }, "in2": 25 } },
    "sin": { "type": "sin", "inputs": { "in": { "node": "turns" } } }
"#,
        phase: 0.0,
    }
}
