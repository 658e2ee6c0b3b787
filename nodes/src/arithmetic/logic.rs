//! Truth values, which are numbers: 1 and 0.

use crate::componentwise::{composed, exposed, product};
use crate::port::number;
use mipless_codegen::moments::Signal;
use mipless_codegen::{Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, Reach, Type,
};

/// The two truth values.
const PAIR: &[PortSpec] = &[
    number("in1", 0.0, "The first truth value."),
    number("in2", 0.0, "The second truth value."),
];

macro_rules! connectives {
    ($($node:ident $name:literal {
        aliases: $aliases:expr,
        summary: $summary:literal,
        computes: $computes:literal,
        inputs: $inputs:expr,
        wired: $wired:literal,
        class: $class:expr,
        lower: $lower:expr,
    })*) => {$(
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: $name,
                aliases: $aliases,
                category: Category::Arithmetic,
                summary: $summary,
                doc: Doc {
                    computes: $computes,
                    statistics: "Of 0 and 1 these are sums and products: the mean is the probability that \
                        the result is true, with the covariance of the two. Exact in mean as far as \
                        the covariance is.",
                    accuracy: "As `multiply`. Held by `tests/tests/parity.rs` at a point, and by \
                        `nodes/src/tests.rs` as the footprint goes to 0.",
                    references: cite!(isserlis; $name),
                },
                inputs: $inputs,
                output: OutputType::Exactly(Type::Float),
                reach: |_| Reach::of(0.0, 1.0),
                class: $class,
                example: example! { $name, concat!(r#"
    "bands": { "type": "stripes", "inputs": { "frequency": 6 } },
    "across": { "type": "stripes", "inputs": { "frequency": 4, "rotate": 90 } },
    ""#, $name, r#"": { "type": ""#, $name, r#"", "inputs": {"#, $wired, "}}\n") },
            };
            NodeDef::new(&SPEC, $lower)
        }
    )*};
}

connectives! {
    and "and" {
        aliases: &["logical_and", "both"],
        summary: "Whether two truth values are both true.",
        computes: "out = in1 · in2, of truth values 0 and 1.",
        inputs: PAIR,
        wired: r#""in1": { "node": "bands" }, "in2": { "node": "across" }"#,
        class: joint,
        lower: |lower, node| {
            let [x, y] = ["in1", "in2"].map(|port| lower.signal(node, port));
            vec![product(lower, &x, &y)]
        },
    }
    not "not" {
        aliases: &["logical_not"],
        summary: "Whether a truth value is false.",
        computes: "out = 1 − in, of truth values 0 and 1.",
        inputs: &[number("in", 0.0, "The truth value.")],
        wired: r#""in": { "node": "bands" }"#,
        class: |_| Behaviour::Linear,
        lower: |lower, node| vec![(-lower.signal(node, "in")).offset(1.0)],
    }
    or "or" {
        aliases: &["logical_or", "either"],
        summary: "Whether any of two truth values is true.",
        computes: "out = in1 + in2 − in1 · in2, of truth values 0 and 1.",
        inputs: PAIR,
        wired: r#""in1": { "node": "bands" }, "in2": { "node": "across" }"#,
        class: joint,
        lower: |lower, node| vec![without(lower, node, 1.0)],
    }
    xor "xor" {
        aliases: &["logical_xor", "exclusive_or"],
        summary: "Whether one of two truth values is true, and not both.",
        computes: "out = in1 + in2 − 2 in1 · in2, of truth values 0 and 1.",
        inputs: PAIR,
        wired: r#""in1": { "node": "bands" }, "in2": { "node": "across" }"#,
        class: joint,
        lower: |lower, node| vec![without(lower, node, 2.0)],
    }
}

/// in1 + in2 − times · in1 · in2.
fn without<'b>(lower: &mut Lower<'_, 'b>, node: &Node, times: f32) -> Signal<'b> {
    let [x, y] = ["in1", "in2"].map(|port| exposed(lower, node, port));
    composed(lower, |lower| {
        (&x[0] + &y[0]) - product(lower, &x[0], &y[0]) * times
    })
}

/// A product where both vary.
fn joint(inputs: &dyn InputView) -> Behaviour {
    if inputs.varies("in1") && inputs.varies("in2") {
        Behaviour::Product
    } else {
        Behaviour::Linear
    }
}
