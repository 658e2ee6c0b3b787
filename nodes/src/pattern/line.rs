//! A line between two points.

use crate::componentwise::numbers;
use crate::pattern::figure::{Figure, drawn};
use crate::pattern::grid::TEXCOORD;
use crate::pattern::region::Outline;
use crate::pattern::unless::pattern_unless;
use crate::port;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};
use std::f64::consts::PI;

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "line",
    aliases: &["segment", "capsule"],
    category: Category::Pattern,
    summary: "1 near the line between two points, 0 elsewhere.",
    doc: Doc {
        computes: "out = 1 where texcoord − center is within radius of the segment from point1 to point2, \
            else 0. The ends are round: half circles of 24 corners, which lie within 0.003 radii of \
            the circle.",
        statistics: "The measure of a polygon under the Gaussian of the footprint, as a sum over its edges of \
            triangles seen from the mean: exact for any covariance. Variance P(1 − P). Of varying \
            parameters the means are used.",
        accuracy: "The mean is within 1e-4 of that of the polygon for any footprint, and the polygon \
            that stands for the round ends within 0.006 of the line. Held by \
            `nodes/src/pattern/tests.rs` against dense sums.",
        references: "Owen 1956, *Tables for Computing Bivariate Normal Probabilities*; Nicholson 1943, *The \
            Probability Integral for Two Variables* (the measure of a right triangle). MaterialX \
            1.39, node `line` of its standard library.",
    },
    inputs: &[
        TEXCOORD,
        port::pair("center", [0.0, 0.0], "The centre.").unit("uv"),
        port::number("radius", 0.1, "Half the width.")
            .range(Range::hard(0.0, f32::MAX).with_soft(0.0, 0.5))
            .unit("uv"),
        port::pair("point1", [0.25, 0.25], "One end, from the centre.").unit("uv"),
        port::pair("point2", [0.75, 0.75], "The other end, from the centre.").unit("uv"),
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::of(0.0, 1.0),
    class: |inputs| pattern_unless(inputs, &["center", "radius", "point1", "point2"]),
    example: example! { "line", r##"
    "line": { "type": "line", "inputs": { "radius": 0.08, "point1": [0.2, 0.3], "point2": [0.8, 0.6] } }
"## },
};

/// Corners of a half circle; their number keeps the area.
const CORNERS: usize = 24;

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    drawn(lower, node, |lower| {
        let radius = lower.number(node, "radius");
        let [from, to] = ["point1", "point2"].map(|port| numbers(lower, node, port));
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let square = dx * dx + dy * dy;
        let distinct = square.gt(0.0);
        let length = distinct.select(square, 1.0).sqrt();
        let c = distinct.select(dx / length, 1.0) * radius;
        let s = dy / length * radius;
        Figure::Line {
            outline: capsule(),
            axes: [[c, s], [-s, c], [dx, dy]],
            from: [from[0], from[1]],
        }
    })
}

/// Around the segment from 0 to E, with a half circle of radius A at each end.
fn capsule() -> Outline {
    let step = PI / CORNERS as f64;
    // A polygon of this radius has the circle's area.
    let radius = (step / step.sin()).sqrt();
    let half = |from: f64, end: f32| {
        (0..=CORNERS).map(move |i| {
            let angle = from + step * i as f64;
            [
                (radius * angle.cos()) as f32,
                (radius * angle.sin()) as f32,
                end,
            ]
        })
    };
    let vertices = half(-PI / 2.0, 1.0).chain(half(PI / 2.0, 0.0)).collect();
    Outline { vertices }
}
