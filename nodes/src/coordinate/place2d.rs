//! Placement of texture coordinates.

use crate::componentwise::{difference, quotient, sum};
use crate::coordinate::rotate2d::rotated;
use crate::port;
use crate::port::number;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType, Range, Reach, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "place2d",
    aliases: &[
        "mapping",
        "transform",
        "transform2",
        "transformation",
        "transform_2d",
        "translate",
        "scale",
    ],
    category: Category::Coordinate,
    summary: "Scales, turns and moves texture coordinates.",
    doc: Doc {
        computes: "With R the rotation of `rotate2d`: for `SRT`, out = R((texcoord − pivot)/scale) − \
            offset + pivot; for `TRS`, out = R(texcoord − pivot − offset)/scale + pivot. Scale \
            divides, so a scale of 2 makes the texture twice as large, and a rotation turns the \
            texture counter-clockwise.",
        statistics: "With constant parameters, linear and exact: a position stays exactly Gaussian with \
            its footprint transformed. A varying rotation or scale goes through the closed forms \
            of `sin` and `divide` and a product, approximate.",
        accuracy: "Exact to rounding; a position keeps its integer cell and its fraction. Held by \
            `nodes/src/tests.rs`.",
        references: cite!(heckbert; "place2d"),
    },
    inputs: &[
        port::pair("texcoord", [0.0, 0.0], "The coordinates.").unit("uv"),
        port::pair("pivot", [0.0, 0.0], "The point that stays in place.")
            .range(Range::soft(-1.0, 1.0))
            .unit("uv"),
        port::pair(
            "scale",
            [1.0, 1.0],
            "The size, which divides; 0 is refused.",
        )
        .range(Range::soft(0.1, 10.0).nonzero())
        .unit("dimensionless"),
        number(
            "rotate",
            0.0,
            "The angle by which the texture turns counter-clockwise.",
        )
        .range(Range::soft(-180.0, 180.0))
        .unit("degrees"),
        port::pair("offset", [0.0, 0.0], "The shift, which is subtracted.")
            .range(Range::soft(-1.0, 1.0))
            .unit("uv"),
        port::choice(
            "operationorder",
            &["SRT", "TRS"],
            "SRT",
            "Scale, rotate, translate; or translate, rotate, scale.",
        ),
    ],
    output: OutputType::Exactly(Type::Vector2),
    reach: |_| Reach::ANY,
    class,
    example: example! { "place2d" => "board", r#"
    "uv": { "type": "texcoord" },
    "place2d": { "type": "place2d", "inputs": { "texcoord": { "node": "uv" }, "pivot": [0.5, 0.5], "scale": [0.5, 0.25], "rotate": 20 } },
    "board": { "type": "checkerboard", "inputs": { "texcoord": { "node": "place2d" } } }
"# },
};

/// Linear in position, pivot and offset; a varying angle or scale multiplies.
fn class(inputs: &dyn InputView) -> Behaviour {
    let others = ["texcoord", "pivot", "offset"];
    match (
        others.iter().any(|port| inputs.varies(port)),
        inputs.varies("rotate") || inputs.varies("scale"),
    ) {
        (_, false) => Behaviour::Linear,
        (false, true) => Behaviour::Function,
        (true, true) => Behaviour::Product,
    }
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let [texcoord, pivot, scale, offset] =
        ["texcoord", "pivot", "scale", "offset"].map(|port| lower.bundle(node, port));
    let angle = -lower.signal(node, "rotate");
    let scaled_first = lower.choice(node, "operationorder") == "SRT";
    let mut place = [0, 1].map(|i| difference(&texcoord[i], &pivot[i]));
    if scaled_first {
        place = [0, 1].map(|i| quotient(lower, &place[i], &scale[i]));
        place = rotated(lower, [&place[0], &place[1]], &angle);
        place = [0, 1].map(|i| difference(&place[i], &offset[i]));
    } else {
        place = [0, 1].map(|i| difference(&place[i], &offset[i]));
        place = rotated(lower, [&place[0], &place[1]], &angle);
        place = [0, 1].map(|i| quotient(lower, &place[i], &scale[i]));
    }
    (0..2).map(|i| sum(&place[i], &pivot[i])).collect()
}
