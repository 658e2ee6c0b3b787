//! Whole numbers beside a signal.

use crate::componentwise::unary;
use crate::noise::cell::steps::summed;
use crate::port::any;
use mipless_codegen::NodeDef;
use mipless_graph::{Behaviour, Category, Doc, NodeSpec, OutputType, Range};

macro_rules! roundings {
    ($($node:ident {
        aliases: $aliases:expr,
        summary: $summary:literal,
        computes: $computes:literal,
        rule: $rule:expr,
    })*) => {$(
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: stringify!($node),
                aliases: $aliases,
                category: Category::Transfer,
                summary: $summary,
                doc: Doc {
                    computes: $computes,
                    statistics: "⌊x⌋ is x less its fraction, whose moments are those of `fract`: \
                        E[⌊x⌋] = m − E[fract x], slope 1 − α, the same distortion. Exact for a \
                        Gaussian, and a position keeps its integer cell. What follows the whole \
                        parts of one coordinate or two, and is alike everywhere (random numbers, \
                        hashes, conditions), is evaluated for each step in the footprint and summed \
                        with what of the Gaussian lies in it; beyond 6 to 8 steps of one coordinate, 3 to 4 of two \
                        (standard deviations), it fades to the mean over all.",
                    accuracy: "For a Gaussian input the mean is within 4e-6, the remainder’s standard \
                        deviation within 1e-3 of 1 + σ. Held by \
                        `codegen/src/moments/tests/waves.rs` against dense numerical integration in \
                        f64. Random colours of steps are within 0.003 as a display shows them, from \
                        pixels of 0.005 to 1 uv at 5 and 6 steps a uv: `tests/tests/field.rs`.",
                    references: cite!(characteristic, bussgang; stringify!($node)),
                },
                inputs: &[any("in", 0.0, "The signal.").range(Range::soft(-4.0, 4.0))],
                output: OutputType::Widest,
                reach: |inputs| inputs.reach("in").monotone(f32::$node),
                class: |_| Behaviour::Function,
                example: example! { stringify!($node), concat!(r#"
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "six": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 6.3}},
    ""#, stringify!($node), r#"": {"type": ""#, stringify!($node), r#"", "inputs": {"in": {"node": "six"}}}
"#) },
            };
            NodeDef::new(&SPEC, |lower, node| unary(lower, node, "in", $rule)).of_steps(summed)
        }
    )*};
}

roundings! {
    ceil {
        aliases: &["ceiling", "round_up", "math_ceil"],
        summary: "The whole number at or above a signal.",
        computes: "out = ⌈in⌉ = −⌊−in⌋, for each component.",
        rule: |lower, x| -lower.algebra.floor(&-x),
    }
    floor {
        aliases: &["round_down", "math_floor"],
        summary: "The whole number at or below a signal.",
        computes: "out = ⌊in⌋, for each component.",
        rule: |lower, x| lower.algebra.floor(x),
    }
    round {
        aliases: &["math_round", "nearest"],
        summary: "The whole number nearest to a signal.",
        computes: "out = ⌊in + ½⌋, for each component: halves go up.",
        rule: |lower, x| lower.algebra.floor(&x.offset(0.5)),
    }
}
