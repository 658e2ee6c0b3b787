//! The encoding of displays, and back.

use crate::componentwise::transfer;
use crate::port::any;
use mipless_codegen::NodeDef;
use mipless_codegen::ir::Float;
use mipless_codegen::moments::{Curve, RealPower, Transfer};
use mipless_graph::{Behaviour, Category, Doc, NodeSpec, OutputType, Type};

macro_rules! encodings {
    ($($node:ident {
        aliases: $aliases:expr,
        summary: $summary:literal,
        computes: $computes:literal,
        bend: $bend:literal,
        rule: $rule:expr,
        narrow: $narrow:expr,
    })*) => {$(
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: stringify!($node),
                aliases: $aliases,
                category: Category::Color,
                summary: $summary,
                doc: Doc {
                    computes: concat!($computes, " for each component but an alpha, which is kept."),
                    statistics: "By ten-point Gauss–Legendre quadrature on both sides of the bend, of the \
                        difference from a line; the distortion as a sum of squares. Approximate.",
                    accuracy: "As `levels` with a gamma of 2.4. At a point and as the footprint goes to 0 \
                        held by `nodes/src/tests.rs`.",
                    references: cite!("IEC 61966-2-1 (sRGB), §5.2.", bussgang),
                },
                inputs: &[any("in", 0.0, "The colour or number.")],
                output: OutputType::Widest,
                reach: |inputs| inputs.reach("in").monotone($narrow),
                class: |_| Behaviour::Function,
                example: example! { stringify!($node), concat!(r#"
    "noise": { "type": "noise2d", "inputs": { "frequency": 5, "pivot": 0.5 } },
    ""#, stringify!($node), r#"": { "type": ""#, stringify!($node),
                    r#"", "inputs": { "in": { "node": "noise" } } }
"#) },
            };
            NodeDef::new(&SPEC, |lower, node| {
                let curve = Curve {
                    function: $rule,
                    kinks: vec![lower.b().float($bend)],
                    flat: [None; 2],
                    range: [f32::NEG_INFINITY, f32::INFINITY],
                };
                let mut components = lower.bundle(node, "in");
                let colors = if node.ty == Type::Color4 { 3 } else { components.len() };
                for component in &mut components[..colors] {
                    *component = transfer(lower, component, &curve);
                }
                components
            })
        }
    )*};
}

encodings! {
    lineartosrgb {
        aliases: &["linear_to_srgb", "srgb_encode"],
        summary: "A linear number as displays encode it.",
        computes: "out = 12.92 in up to 0.0031308, else 1.055 in^(1/2.4) − 0.055,",
        bend: 0.003_130_8,
        rule: encoded,
        narrow: |x| if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 },
    }
    srgbtolinear {
        aliases: &["srgb_to_linear", "srgb_decode"],
        summary: "A number that is encoded for displays, made linear.",
        computes: "out = in/12.92 up to 0.04045, else ((in + 0.055)/1.055)^2.4,",
        bend: 0.040_45,
        rule: decoded,
        narrow: |x| if x <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) },
    }
}

fn power<'b>(x: Float<'b>, power: f32) -> Float<'b> {
    let power = x.literal(power);
    RealPower { power }.value(x)
}

fn encoded(x: Float<'_>) -> Float<'_> {
    let high = power(x.max(0.003), 1.0 / 2.4) * 1.055 + -0.055;
    x.le(0.003_130_8).select(x * 12.92, high)
}

fn decoded(x: Float<'_>) -> Float<'_> {
    let high = power((x.max(0.04) + 0.055) * (1.0 / 1.055), 2.4);
    x.le(0.040_45).select(x * (1.0 / 12.92), high)
}
