//! Polygons and stars.

use crate::pattern::circle::EDGE;
use crate::pattern::figure::{Figure, drawn_softly};
use crate::pattern::grid::TEXCOORD;
use crate::pattern::region::Outline;
use crate::pattern::unless::pattern_unless;
use crate::port;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "shape",
    aliases: &["polygon", "star", "ngon", "regular_polygon"],
    category: Category::Pattern,
    summary: "1 inside a regular polygon or a star, 0 outside.",
    doc: Doc {
        computes: "out = 1 inside the figure around center, else 0. A polygon has its corners at the \
            distance radius; a star has as many corners between them at the distance inner · radius. \
            One corner points along +v before the figure is turned by rotate. With an edge, ½ + d/edge \
            limited to [0, 1], d the distance from the outline, positive inside.",
        statistics: "The measure of a polygon under the Gaussian of the footprint, as a sum over its edges of \
            triangles seen from the mean: exact for any covariance, for stars too. Variance P(1 − \
            P). An edge adds the difference of a ramp and a step of the distance as a Gaussian, as in \
            `circle`. Of varying parameters the means are used.",
        accuracy: "The mean is within 1e-4 for any footprint; with an edge of half the radius within 0.004 for polygons, 0.03 at 8:1, and 0.045 for stars, at their corners. Held by `nodes/src/pattern/tests.rs` against \
            dense sums.",
        references: "Owen 1956, *Tables for Computing Bivariate Normal Probabilities*; Nicholson 1943, *The \
            Probability Integral for Two Variables* (the measure of a right triangle).",
    },
    inputs: &[
        TEXCOORD,
        port::choice("shape", &["polygon", "star"], "polygon", "Which figure."),
        port::integer(
            "sides",
            5,
            "How many corners a polygon, or points a star, has.",
        )
        .uniform()
        .range(Range::hard(3.0, 64.0).with_soft(3.0, 12.0)),
        port::pair("center", [0.5, 0.5], "The centre.").unit("uv"),
        port::number("radius", 0.4, "The distance of the corners.")
            .range(Range::hard(0.0, f32::MAX).with_soft(0.0, 1.0))
            .unit("uv"),
        port::number(
            "inner",
            0.5,
            "The distance of the corners between the points of a star, as a share of the radius.",
        )
        .uniform()
        .range(Range::hard(0.0, 1.0)),
        port::number("rotate", 0.0, "The angle, counter-clockwise.")
            .range(Range::soft(-180.0, 180.0))
            .unit("degrees"),
        EDGE,
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::of(0.0, 1.0),
    class: |inputs| pattern_unless(inputs, &["center", "radius", "rotate", "edge"]),
    example: example! { "shape", r##"
    "shape": { "type": "shape", "inputs": { "shape": "star", "sides": 7, "rotate": 10 } }
"## },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let edge = lower.number(node, "edge");
    drawn_softly(lower, node, Some(edge), |lower| {
        let sides = lower.integer(node, "sides").clamp(3, 64) as usize;
        let inner = f64::from(lower.float(node, "inner"));
        let first = std::f64::consts::FRAC_PI_2;
        let outline = if lower.choice(node, "shape") == "star" {
            Outline::around(2 * sides, &[1.0, inner], first)
        } else {
            Outline::around(sides, &[1.0], first)
        };
        let [radius, degrees] = ["radius", "rotate"].map(|port| lower.number(node, port));
        let angle = degrees * (std::f32::consts::PI / 180.0);
        let (s, c) = (angle.sin() * radius, angle.cos() * radius);
        let zero = lower.b().float(0.0);
        Figure::Polygon {
            outline,
            axes: [[c, s], [-s, c], [zero, zero]],
        }
    })
}
