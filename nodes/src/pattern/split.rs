//! Two halves along a coordinate.

use crate::componentwise::{binary, transfer};
use crate::pattern::ramp::between;
use crate::pattern::unless::pattern_unless;
use crate::port;
use mipless_codegen::moments::Piecewise;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType};

/// One row a node: which coordinate, and its halves by their ports and by what the pages call them.
macro_rules! splits {
    ($($(#[$doc:meta])* $node:ident {
        along: ($axis:literal, $coordinate:literal),
        halves: ($from:literal, $from_side:literal, $to:literal, $to_side:literal),
        remark: $remark:literal,
    })*) => {$(
        $(#[$doc])*
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: stringify!($node),
                aliases: &[],
                category: Category::Pattern,
                summary: concat!("One value on one side and another on the other, along ", $coordinate, "."),
                doc: Doc {
                    computes: concat!(
                        "out = ", $to, " where ", $coordinate, " ≥ center, else ", $from,
                        $remark,
                    ),
                    statistics: "A step of a Gaussian, Φ in closed form, variance P(1 − P): exact between constants. \
                        Between varying values, a product, as `mix`.",
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
                    port::number("center", 0.5, "Where one value meets the other.").unit("uv"),
                    port::surface("The coordinates."),
                ],
                output: OutputType::Widest,
                reach: |inputs| inputs.reach($from).hull(inputs.reach($to)),
                class: |inputs| pattern_unless(inputs, &[$from, $to, "center"]),
                example: concat!("{\n  \"version\": 1,\n  \"name\": \"", stringify!($node), "_example\",\n  \"nodes\": {\n    \"", stringify!($node), "\": { \"type\": \"", stringify!($node), "\", \"inputs\": { \"", $from, "\": \"#20303c\", \"", $to, "\": \"#e8c27a\" } }\n  },\n  \"outputs\": { \"out\": { \"node\": \"", stringify!($node), "\" } }\n}"),
            };
            NodeDef::new(&SPEC, |lower, node| along(lower, node, $axis, [$from, $to]))
        }
    )*};
}

splits! {
    /// Left and right.
    splitlr {
        along: (0, "u"),
        halves: ("valuel", "left", "valuer", "right"),
        remark: ", with (u, v) = texcoord.",
    }
    /// Bottom and top.
    splittb {
        along: (1, "v"),
        halves: ("valueb", "bottom", "valuet", "top"),
        remark: ", with (u, v) = texcoord. The top is where v is 1.",
    }
}

fn along<'b>(lower: &mut Lower<'_, 'b>, node: &Node, axis: usize, halves: [&str; 2]) -> Bundle<'b> {
    let texcoord = lower.bundle(node, "texcoord");
    let step = Piecewise::step(lower.number(node, "center"));
    let share = transfer(lower, &texcoord[axis], &step);
    binary(lower, node, halves, |lower, from, to| {
        between(lower, from, to, &share)
    })
}
