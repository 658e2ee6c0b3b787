//! Gradients along a coordinate.

use crate::componentwise::{binary, product, transfer};
use crate::pattern::unless::pattern_unless;
use crate::port;
use mipless_codegen::moments::{Piecewise, Signal};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType};

/// One row a node: which coordinate, and its ends by their ports and by what the pages call them.
macro_rules! ramps {
    ($($(#[$doc:meta])* $node:ident {
        along: ($axis:literal, $coordinate:literal),
        ends: ($from:literal, $from_side:literal, $to:literal, $to_side:literal),
        aliases: $aliases:expr,
        remark: $remark:literal,
    })*) => {$(
        $(#[$doc])*
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: stringify!($node),
                aliases: $aliases,
                category: Category::Pattern,
                summary: concat!("Goes from one value to another, along ", $coordinate, "."),
                doc: Doc {
                    computes: concat!(
                        "out = ", $from, " + t (", $to, " − ", $from, ") with t = ", $coordinate,
                        " limited to [0, 1] and (u, v) = texcoord.", $remark,
                    ),
                    statistics: "A clamp of a Gaussian in closed form, with slope and distortion: exact between \
                        constants. Between varying values, a product, as `mix`.",
                    accuracy: "Within 1e-6 of the difference of the values. Held by `nodes/src/pattern/tests.rs`.",
                    references: concat!(
                        "Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8. Bussgang \
                        1952, *Crosscorrelation functions of amplitude-distorted Gaussian signals*. MaterialX \
                        1.39 specification, node `", stringify!($node), "`.",
                    ),
                },
                inputs: &[
                    PortSpec::new($from, PortType::Any, Default::Float(0.0), concat!("The value at the ", $from_side, ".")),
                    PortSpec::new($to, PortType::Any, Default::Float(0.0), concat!("The value at the ", $to_side, ".")),
                    port::surface("The coordinates."),
                ],
                output: OutputType::Widest,
                reach: |inputs| inputs.reach($from).hull(inputs.reach($to)),
                class: |inputs| pattern_unless(inputs, &[$from, $to]),
                example: concat!("{\n  \"version\": 1,\n  \"name\": \"", stringify!($node), "_example\",\n  \"nodes\": {\n    \"", stringify!($node), "\": { \"type\": \"", stringify!($node), "\", \"inputs\": { \"", $from, "\": \"#20303c\", \"", $to, "\": \"#e8c27a\" } }\n  },\n  \"outputs\": { \"out\": { \"node\": \"", stringify!($node), "\" } }\n}"),
            };
            NodeDef::new(&SPEC, |lower, node| along(lower, node, $axis, [$from, $to]))
        }
    )*};
}

ramps! {
    /// From left to right.
    ramplr {
        along: (0, "u"),
        ends: ("valuel", "left", "valuer", "right"),
        aliases: &["linear_gradient", "gradient_linear", "gradient_texture"],
        remark: "",
    }
    /// From bottom to top.
    ramptb {
        along: (1, "v"),
        ends: ("valueb", "bottom", "valuet", "top"),
        aliases: &["vertical_gradient"],
        remark: " The top is where v is 1.",
    }
}

fn along<'b>(lower: &mut Lower<'_, 'b>, node: &Node, axis: usize, ends: [&str; 2]) -> Bundle<'b> {
    let texcoord = lower.bundle(node, "texcoord");
    let b = lower.b();
    let clamp = Piecewise::clamp(b.float(0.0), b.float(1.0));
    let share = transfer(lower, &texcoord[axis], &clamp);
    binary(lower, node, ends, |lower, from, to| {
        between(lower, from, to, &share)
    })
}

/// from + share · (to − from).
pub(crate) fn between<'b>(
    lower: &mut Lower<'_, 'b>,
    from: &Signal<'b>,
    to: &Signal<'b>,
    share: &Signal<'b>,
) -> Signal<'b> {
    from + product(lower, &(to - from), share)
}
