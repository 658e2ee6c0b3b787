//! Choices by the comparison of two numbers.

use crate::componentwise::binary;
use crate::port;
use crate::port::{any, number};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, PortSpec, Range, Reach};

/// What is compared, and the results.
const fn ports(first: f32) -> [PortSpec; 5] {
    [
        number("value1", first, "The first number that is compared.").range(Range::soft(-1.0, 1.0)),
        number("value2", 0.0, "The second number that is compared.").range(Range::soft(-1.0, 1.0)),
        any("in1", 0.0, "The result where the condition holds."),
        any("in2", 0.0, "The result elsewhere."),
        port::choice(
            "signature",
            &["value", "boolean"],
            "value",
            "Whether the result is in1 or in2, or the truth of the condition: 1 or 0.",
        ),
    ]
}

macro_rules! comparisons {
    ($($node:ident {
        aliases: $aliases:expr,
        summary: $summary:literal,
        computes: $computes:literal,
        statistics: $statistics:literal,
        accuracy: $accuracy:literal,
        example: $before:literal => $values:literal, $other:literal,
        first: $value1:literal,
        condition: |$first:ident, $second:ident| $condition:expr,
        thresholds: $thresholds:expr,
        branches: |$yes:ident, $no:ident| $branches:expr,
    })*) => {$(
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: stringify!($node),
                aliases: $aliases,
                category: Category::Arithmetic,
                summary: $summary,
                doc: Doc {
                    computes: $computes,
                    statistics: concat!("Of the interval of value1 − value2 that is chosen: with S the \
                        difference and W the branches, mean Σ P_k m_k + cov(S, W_k) φ/σ and so on, the \
                        distortion as a sum of squares over the intervals and of the spread between \
                        the branches. Exact in mean and variance for jointly Gaussian signals, \
                        whatever their covariances.", $statistics),
                    accuracy: concat!("For jointly Gaussian inputs the mean and the standard deviation \
                        are ", $accuracy, "within 1e-3. Held by `nodes/src/tests/combination.rs` \
                        against dense numerical integration in f64."),
                    references: cite!(truncated, bussgang; stringify!($node)),
                },
                inputs: const { &ports($value1) },
                output: OutputType::Widest,
                reach: |inputs| match inputs.choice("signature") {
                    "boolean" => Reach::of(0.0, 1.0),
                    _ => inputs.reach("in1").hull(inputs.reach("in2")),
                },
                class: |_| Behaviour::Function,
                example: example! { stringify!($node), concat!(r#"
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
"#, $before, r#"    ""#, stringify!($node), r#"": {"type": ""#, stringify!($node),
                    r#"", "inputs": {"#, $values, r#", "in1": {"node": "bands"}, "in2": "#, $other, "}}\n") },
            };
            NodeDef::new(&SPEC, |lower, node| {
                let [$first, $second] = ["value1", "value2"].map(|port| lower.signal(node, port));
                chosen(lower, node, &$condition, &$thresholds, |$yes, $no| $branches)
            })
        }
    )*};
}

comparisons! {
    ifequal {
        aliases: &["if_equal", "equals"],
        summary: "One of two signals, by whether two numbers are equal.",
        computes: "out = in1 where value1 and value2 differ by less than 1e-5, else in2.",
        statistics: " For a condition with a spread the two numbers are equal with the probability of \
            that interval, which is next to nothing: right for smooth signals. Whole numbers such as \
            those of `floor` are equal often; there the result is right where the condition is fused \
            (functions of one bounded signal), and wrong elsewhere.",
        accuracy: "",
        example: r#"    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "whole": {"type": "floor", "inputs": {"in": {"node": "u"}}},
"# => r#""value1": {"node": "whole"}, "value2": 1"#, r#"{"node": "noise"}"#,
        first: 0.0,
        condition: |first, second| first - second,
        thresholds: [-CLOSE, CLOSE],
        branches: |yes, no| vec![no.clone(), yes.clone(), no.clone()],
    }
    ifgreater {
        aliases: &["if_greater", "compare"],
        summary: "One of two signals, by whether a number is greater than another.",
        computes: "out = in1 where value1 > value2, else in2.",
        statistics: "",
        accuracy: "those of the function, ",
        example: "" => r#""value1": {"node": "noise"}, "value2": 0.45"#, "0.2",
        first: 1.0,
        condition: |first, second| -(first - second),
        thresholds: [0.0],
        branches: |yes, no| vec![yes.clone(), no.clone()],
    }
    ifgreatereq {
        aliases: &["if_greater_equal", "greater_or_equal"],
        summary: "One of two signals, by whether a number is at least another.",
        computes: "out = in1 where value1 ≥ value2, else in2.",
        statistics: "",
        accuracy: "those of the function, ",
        example: "" => r#""value1": {"node": "noise"}, "value2": 0.45"#, "0.2",
        first: 1.0,
        condition: |first, second| first - second,
        thresholds: [0.0],
        branches: |yes, no| vec![no.clone(), yes.clone()],
    }
}

/// Closer than this is equal.
const CLOSE: f32 = 1e-5;

/// For each component that of `branches` in whose interval between the thresholds `condition` is.
fn chosen<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    condition: &Signal<'b>,
    thresholds: &[f32],
    branches: impl Fn(&Signal<'b>, &Signal<'b>) -> Vec<Signal<'b>>,
) -> Bundle<'b> {
    if lower.choice(node, "signature") == "boolean" {
        let [yes, no] = [1.0, 0.0].map(|truth| Signal::constant(lower.b(), truth));
        let branches = branches(&yes, &no);
        let truth = (lower.algebra).selection(condition, thresholds, &branches);
        return vec![truth; node.ty.components()];
    }
    binary(lower, node, ["in1", "in2"], |lower, yes, no| {
        (lower.algebra).selection(condition, thresholds, &branches(yes, no))
    })
}
