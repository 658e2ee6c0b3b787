//! The sum and the difference of two signals.

use crate::componentwise::{OPERANDS, binary};
use mipless_codegen::NodeDef;
use mipless_graph::{Behaviour, Category, Doc, NodeSpec, OutputType};

macro_rules! sums {
    ($($node:ident {
        aliases: $aliases:expr,
        summary: $summary:literal,
        computes: $computes:literal,
        statistics: $statistics:literal,
        sign: $sign:tt,
        rule: $rule:expr,
    })*) => {$(
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: stringify!($node),
                aliases: $aliases,
                category: Category::Arithmetic,
                summary: $summary,
                doc: Doc {
                    computes: $computes,
                    statistics: $statistics,
                    accuracy: "Exact to rounding: the rule is an identity. Held by \
                        `nodes/src/tests.rs`, which compares every node with its point value as the \
                        footprint goes to 0, in each mode.",
                    references: cite!(linear; stringify!($node)),
                },
                inputs: OPERANDS,
                output: OutputType::Widest,
                reach: |inputs| inputs.reach("in1") $sign inputs.reach("in2"),
                class: |_| Behaviour::Linear,
                example: example! { stringify!($node), concat!(r#"
    "bands": { "type": "stripes", "inputs": { "frequency": 6 } },
    "across": { "type": "stripes", "inputs": { "frequency": 4, "rotate": 90 } },
    ""#, stringify!($node), r#"": { "type": ""#, stringify!($node),
                    r#"", "inputs": { "in1": { "node": "bands" }, "in2": { "node": "across" } } }
"#) },
            };
            NodeDef::new(&SPEC, |lower, node| binary(lower, node, ["in1", "in2"], $rule))
        }
    )*};
}

sums! {
    add {
        aliases: &["sum", "linear_dodge"],
        summary: "The sum of two signals.",
        computes: "out = in1 + in2, for each component.",
        statistics: "Exact for any distribution: means and coefficients add, so Var(out) = Var(in1) + \
            Var(in2) + 2 cov(in1, in2), with the covariance of what both inputs share.",
        sign: +,
        rule: |_, x, y| x + y,
    }
    subtract {
        aliases: &["sub"],
        summary: "The difference of two signals.",
        computes: "out = in1 − in2, for each component.",
        statistics: "Exact for any distribution: coefficients subtract, so Var(out) = Var(in1) + Var(in2) \
            − 2 cov(in1, in2); the difference of a signal with itself is 0 without spread.",
        sign: -,
        rule: |_, x, y| x - y,
    }
}
