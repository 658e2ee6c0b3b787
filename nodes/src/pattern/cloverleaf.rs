//! Four leaves.

use crate::pattern::figure::{Figure, drawn};
use crate::pattern::grid::TEXCOORD;
use crate::pattern::region::Outline;
use crate::pattern::unless::pattern_unless;
use crate::port;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};
use std::f64::consts::FRAC_PI_2;

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "cloverleaf",
    aliases: &["clover", "quatrefoil", "four_leaf"],
    category: Category::Pattern,
    summary: "1 inside four overlapping circles around a centre, 0 outside.",
    doc: Doc {
        computes: "out = 1 inside one of four circles of half the radius, whose centres lie half a radius from \
            center along both axes, else 0: a square and four half circles, each of which is drawn with 24 \
            corners (within 0.001 radii of the circle).",
        statistics: "The measure of a polygon under the Gaussian of the footprint, as a sum over its edges of \
            triangles seen from the mean: exact for any covariance. Variance P(1 − P). Of varying \
            parameters the means are used.",
        accuracy: "The mean is within 1e-4 for any footprint. Held by `nodes/src/pattern/tests.rs` against \
            dense sums.",
        references: "Owen 1956, *Tables for Computing Bivariate Normal Probabilities*; Nicholson 1943, *The \
            Probability Integral for Two Variables* (the measure of a right triangle). MaterialX 1.39, \
            node `cloverleaf` of its standard library, with the centre where it says.",
    },
    inputs: &[
        TEXCOORD,
        port::pair("center", [0.0, 0.0], "The centre.").unit("uv"),
        port::number("radius", 0.5, "From the centre to the tip of a leaf.")
            .range(Range::hard(0.0, f32::MAX).with_soft(0.0, 1.0))
            .unit("uv"),
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::of(0.0, 1.0),
    class: |inputs| pattern_unless(inputs, &["center", "radius"]),
    example: example! { "cloverleaf", r##"
    "cloverleaf": { "type": "cloverleaf", "inputs": { "center": [0.5, 0.5], "radius": 0.4 } }
"## },
};

/// Edges of a quarter of a circle.
const EDGES: usize = 12;

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    drawn(lower, node, |lower| {
        let radius = lower.number(node, "radius");
        let zero = lower.b().float(0.0);
        Figure::Polygon {
            outline: outline(),
            axes: [[radius, zero], [zero, radius], [zero, zero]],
        }
    })
}

/// The corners of the quadrant of both axes, from the tip on one to that on the other, for tips at 1.
pub(crate) fn quadrant(edges: usize) -> Vec<[f64; 2]> {
    let arc = |i: usize| {
        let angle = FRAC_PI_2 * i as f64 / edges as f64;
        [0.5 * angle.cos(), 0.5 * angle.sin()]
    };
    let right = (0..=edges).map(|i| {
        let [x, y] = arc(i);
        [0.5 + x, y]
    });
    let top = (1..edges).map(|i| {
        let [x, y] = arc(i);
        [x, 0.5 + y]
    });
    right.chain(top).chain([[0.0, 1.0]]).collect()
}

fn outline() -> Outline {
    let quarter = quadrant(EDGES);
    let mut vertices = Vec::new();
    for (c, s) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)] {
        // The next quadrant begins with the tip that this one ends with.
        for [x, y] in &quarter[..quarter.len() - 1] {
            vertices.push([(c * x - s * y) as f32, (s * x + c * y) as f32, 0.0]);
        }
    }
    Outline { vertices }
}
