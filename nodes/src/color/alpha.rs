//! A colour times its alpha, and without it.

use crate::componentwise::{composed, exposed, product, quotient};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Reach, Type,
};

macro_rules! operations {
    ($($node:ident {
        alias: $alias:literal,
        summary: $summary:literal,
        computes: $computes:literal,
        statistics: $statistics:literal,
        accuracy: $accuracy:literal,
        layer: $layer:literal,
        channel: $channel:expr,
    })*) => {$(
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: stringify!($node),
                aliases: &[$alias],
                category: Category::Color,
                summary: $summary,
                doc: Doc {
                    computes: $computes,
                    statistics: $statistics,
                    accuracy: concat!($accuracy, " Held by `nodes/src/tests/vector.rs` against dense \
                        numerical integration in f64."),
                    references: cite!(porter_duff, isserlis; stringify!($node)),
                },
                inputs: &[PortSpec::new(
                    "in",
                    PortType::Exactly(Type::Color4),
                    Default::Color3([0.0; 3]),
                    "The colour and its alpha.",
                )],
                output: OutputType::Exactly(Type::Color4),
                reach: |_| Reach::ANY,
                class: |_| Behaviour::Product,
                example: example! { stringify!($node), concat!(r#"
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "front": {"type": "combine4", "inputs": {"in1": {"node": "bands"}, "in2": 0.4, "in3": 0.1, "in4": {"node": "noise"}}},
    "back": {"type": "combine4", "inputs": {"in1": 0.2, "in2": {"node": "noise"}, "in3": 0.7, "in4": 0.8}},
    ""#, stringify!($node), r#"": {"type": ""#, stringify!($node),
                    r#"", "inputs": {"in": {"node": ""#, $layer, "\"}}}\n") },
            };
            NodeDef::new(&SPEC, |lower, node| beside_alpha(lower, node, $channel))
        }
    )*};
}

operations! {
    premult {
        alias: "premultiply",
        summary: "Multiplies a colour by its alpha.",
        computes: "out = (r a, g a, b a, a).",
        statistics: "Products of varying signals take their covariance: exact in mean and variance for \
            jointly Gaussian ones, with numbers linear and exact.",
        accuracy: "For jointly Gaussian inputs exact to rounding in mean and variance.",
        layer: "front",
        channel: product,
    }
    unpremult {
        alias: "unpremultiply",
        summary: "Divides a colour by its alpha.",
        computes: "out = (r/a, g/a, b/a, a); an alpha nearer to 0 than 1e-6 is moved to ±1e-6.",
        statistics: "As `divide`: exact by a number; by a varying alpha the moments exist only where it \
            stays away from 0, and its mean is kept at least four standard deviations from it. \
            Approximate.",
        accuracy: "For an alpha at least six standard deviations above 0 the mean is within 1e-3 and the \
            standard deviation within 0.01.",
        layer: "back",
        channel: quotient,
    }
}

/// What `channel` makes of each channel and the alpha, and the alpha.
fn beside_alpha<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    channel: impl Fn(&mut Lower<'_, 'b>, &Signal<'b>, &Signal<'b>) -> Signal<'b>,
) -> Bundle<'b> {
    let color = exposed(lower, node, "in");
    composed(lower, |lower| {
        let alpha = &color[3];
        let mut out: Bundle<'b> = color[..3]
            .iter()
            .map(|x| channel(lower, x, alpha))
            .collect();
        out.push(alpha.clone());
        out
    })
}
