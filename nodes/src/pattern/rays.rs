//! Rays around a centre.

use crate::componentwise::{difference, sum, transfer};
use crate::pattern::angle::polar;
use crate::pattern::grid::TEXCOORD;
use crate::pattern::unless::pattern_unless;
use crate::port;
use mipless_codegen::moments::SquareWave;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "rays",
    aliases: &["sunburst", "starburst", "sectors", "radial_stripes"],
    category: Category::Pattern,
    summary: "Rays that go out from a centre.",
    doc: Doc {
        computes: "out = 1 on as many sectors as count says, each of which is the share width of a part of the \
            turn, else 0. One is centred on the u axis, turned by rotate counter-clockwise, and by twist \
            more a unit of the distance from the centre.",
        statistics: "The angle and the distance as `polar` has them, and a square wave of their sum: exact \
            where the footprint is short against its distance from the centre. On the centre the angle is \
            spread over the whole turn, and the mean goes to width.",
        accuracy: "For footprints that are less than a third of their distance from the centre the mean is \
            within 0.02; nearer by, within 0.12. Held by `nodes/tests/sources.rs` against dense sums.",
        references: cite!(arctangent, characteristic, bussgang),
    },
    inputs: &[
        TEXCOORD,
        port::pair("center", [0.5, 0.5], "The centre.").unit("uv"),
        port::integer("count", 12, "How many rays there are.")
            .uniform()
            .range(Range::hard(1.0, 1000.0).with_soft(2.0, 48.0)),
        port::number("width", 0.5, "The share of the turn that they take up.")
            .range(Range::hard(0.0, 1.0)),
        port::number("rotate", 0.0, "The angle, counter-clockwise.")
            .range(Range::soft(-180.0, 180.0))
            .unit("degrees"),
        port::number("twist", 0.0, "How far they wind around the centre.")
            .range(Range::soft(-720.0, 720.0))
            .unit("degrees per uv"),
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::of(0.0, 1.0),
    class: |inputs| pattern_unless(inputs, &["center", "width", "rotate", "twist"]),
    example: example! { "rays", r##"
    "rays": { "type": "rays", "inputs": { "count": 14, "twist": 120 } }
"## },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let (texcoord, centre) = (lower.bundle(node, "texcoord"), lower.bundle(node, "center"));
    let count = lower.integer(node, "count").max(1) as f32;
    let width = lower.number(node, "width");
    let [rotate, twist] =
        ["rotate", "twist"].map(|port| lower.number(node, port) * (count / 360.0));
    let [x, y] = [0, 1].map(|i| difference(&texcoord[i], &centre[i]));
    let [angle, length] = polar(lower, [&x, &y]);
    // A wave is 1 from 0 on, and a ray is centred.
    let turned = (angle * count).offset(width * 0.5 - rotate);
    let wound = if twist.is_zero() {
        turned
    } else {
        sum(&turned, &(length * -twist))
    };
    vec![transfer(lower, &wound, &SquareWave { width })]
}
