//! A signal inside or outside of a mask.

use crate::componentwise::product;
use crate::port::{any, number};
use mipless_codegen::NodeDef;
use mipless_graph::{Behaviour, Category, Doc, NodeSpec, OutputType, Range, Reach};

macro_rules! mattes {
    ($($node:ident {
        summary: $summary:literal,
        computes: $computes:literal,
        default: $default:literal,
        reach: |$part:ident| $reach:expr,
        share: |$mask:ident| $share:expr,
    })*) => {$(
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: stringify!($node),
                aliases: &[],
                category: Category::Arithmetic,
                summary: $summary,
                doc: Doc {
                    computes: $computes,
                    statistics: "By a number, linear and exact. A varying mask is a product, with the \
                        covariance that it has with the signal: exact in mean and variance for jointly \
                        Gaussian ones.",
                    accuracy: "As `multiply`. Held by `tests/tests/parity.rs` at a point, and by \
                        `nodes/src/tests.rs` as the footprint goes to 0.",
                    references: cite!(isserlis; stringify!($node)),
                },
                inputs: &[
                    any("in", 0.0, "The signal."),
                    number("mask", $default, "The mask.").range(Range::soft(0.0, 1.0)),
                ],
                output: OutputType::Widest,
                reach: |inputs| {
                    let $part = inputs.reach("mask").component(0);
                    inputs.reach("in") * $reach
                },
                class: |inputs| match (inputs.varies("in"), inputs.varies("mask")) {
                    (true, true) => Behaviour::Product,
                    _ => Behaviour::Linear,
                },
                example: example! { stringify!($node), concat!(r#"
    "bands": { "type": "stripes", "inputs": { "frequency": 6 } },
    "across": { "type": "stripes", "inputs": { "frequency": 4, "rotate": 90 } },
    ""#, stringify!($node), r#"": { "type": ""#, stringify!($node),
                    r#"", "inputs": { "in": { "node": "bands" }, "mask": { "node": "across" } } }
"#) },
            };
            NodeDef::new(&SPEC, |lower, node| {
                let $mask = lower.signal(node, "mask");
                let share = $share;
                let signal = lower.bundle(node, "in");
                signal.iter().map(|x| product(lower, x, &share)).collect()
            })
        }
    )*};
}

mattes! {
    inside {
        summary: "What of a signal lies inside of a mask.",
        computes: "out = in · mask, for each component.",
        default: 1.0,
        reach: |mask| mask,
        share: |mask| mask,
    }
    outside {
        summary: "What of a signal lies outside of a mask.",
        computes: "out = in · (1 − mask), for each component.",
        default: 0.0,
        reach: |mask| Reach::point(1.0) - mask,
        share: |mask| (-mask).offset(1.0),
    }
}
