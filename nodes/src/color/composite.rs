//! The Porter–Duff operations: premultiplied layers `fg` over `bg`, and the share `mix` of the result.

use crate::componentwise::{composed, exposed, product};
use crate::port::{exactly, number};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Doc, Node, NodeSpec, OutputType, PortSpec, Range, Reach, Type,
};

/// The two layers, and how much of the result is taken.
pub(super) const IMAGES: &[PortSpec] = &[
    exactly(
        Type::Color4,
        "fg",
        0.0,
        "The layer in front; premultiplied, but for `matte`.",
    ),
    exactly(Type::Color4, "bg", 0.0, "The layer behind, premultiplied."),
    number("mix", 1.0, "How much of the result is taken; 0 leaves bg.")
        .range(Range::soft(0.0, 1.0)),
];

/// What the pages of all operations say: the operation is `out = $out`.
macro_rules! composition {
    ($out:literal) => {
        concat!(
            "With F, f the colour and alpha of fg and B, b those of bg: out = ",
            $out,
            ", mixed with \
            bg by mix: bg + mix (… − bg)."
        )
    };
}

/// A layer of both sources before another, and the operation upon them.
macro_rules! layered {
    ($name:literal) => {
        example! { $name, concat!(r#"
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "front": {"type": "combine4", "inputs": {"in1": {"node": "bands"}, "in2": 0.4, "in3": 0.1, "in4": {"node": "noise"}}},
    "back": {"type": "combine4", "inputs": {"in1": 0.2, "in2": {"node": "noise"}, "in3": 0.7, "in4": 0.8}},
    ""#, $name, r#"": {"type": ""#, $name,
            r#"", "inputs": {"fg": {"node": "front"}, "bg": {"node": "back"}, "mix": 0.9}}
"#) }
    };
}

macro_rules! operations {
    ($($node:ident $name:literal {
        aliases: $aliases:expr,
        summary: $summary:literal,
        out: $out:literal,
        channel: $channel:expr,
    })*) => {$(
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: $name,
                aliases: $aliases,
                category: Category::Color,
                summary: $summary,
                doc: Doc {
                    computes: composition!($out),
                    statistics: "Products of varying signals take their covariance: exact in mean and \
                        variance for jointly Gaussian ones, with numbers linear and exact.",
                    accuracy: "For jointly Gaussian inputs with spreads up to 0.3 the mean is within \
                        1e-3 and the standard deviation within 0.01. Held by \
                        `nodes/src/tests/vector.rs` against dense numerical integration in f64.",
                    references: cite!(porter_duff, isserlis; $name),
                },
                inputs: IMAGES,
                output: OutputType::Exactly(Type::Color4),
                reach: |_| Reach::ANY,
                class: |_| Behaviour::Product,
                example: layered!($name),
            };
            NodeDef::new(&SPEC, |lower, node| composite(lower, node, $channel))
        }
    )*};
}

operations! {
    r#in "in" {
        aliases: &["composite_in"],
        summary: "A layer where another one is.",
        out: "(F b, f b)",
        channel: |lower, fg, bg, k| product(lower, &fg[k], &bg[3]),
    }
    mask "mask" {
        aliases: &["composite_mask"],
        summary: "The layer behind where the one in front is.",
        out: "(B f, b f)",
        channel: |lower, fg, bg, k| product(lower, &bg[k], &fg[3]),
    }
    matte "matte" {
        aliases: &["composite_matte"],
        summary: "A layer that is not premultiplied, over another.",
        out: "(F f + B (1 − f), f + b (1 − f))",
        channel: |lower, fg, bg, k| {
            let hidden = product(lower, &bg[k], &fg[3]);
            let front = match k {
                3 => fg[3].clone(),
                _ => product(lower, &fg[k], &fg[3]),
            };
            front + &bg[k] - hidden
        },
    }
    out "out" {
        aliases: &["composite_out"],
        summary: "A layer where another one is not.",
        out: "(F (1 − b), f (1 − b))",
        channel: |lower, fg, bg, k| &fg[k] - product(lower, &fg[k], &bg[3]),
    }
    over "over" {
        aliases: &["alpha_over", "normal_blend", "composite_over"],
        summary: "One layer over another.",
        out: "(F + B (1 − f), f + b (1 − f))",
        // B (1 − f) = B − B f.
        channel: |lower, fg, bg, k| (&fg[k] + &bg[k]) - product(lower, &bg[k], &fg[3]),
    }
}

/// bg + mix (result − bg) for each of four channels, alpha last; `operation` gives channel `k`.
pub(super) fn composite<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    operation: impl Fn(&mut Lower<'_, 'b>, &[Signal<'b>], &[Signal<'b>], usize) -> Signal<'b>,
) -> Bundle<'b> {
    let [fg, bg] = ["fg", "bg"].map(|port| exposed(lower, node, port));
    let share = lower.signal(node, "mix");
    composed(lower, |lower| {
        (0..4)
            .map(|k| {
                let result = operation(lower, &fg, &bg, k);
                lower.algebra.mix(&bg[k], &result, &share)
            })
            .collect()
    })
}

pub(super) use {composition, layered};
