//! A hexagon.

use crate::pattern::figure::{Figure, drawn};
use crate::pattern::grid::TEXCOORD;
use crate::pattern::region::Outline;
use crate::pattern::unless::pattern_unless;
use crate::port;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "hexagon",
    aliases: &["hex"],
    category: Category::Pattern,
    summary: "1 inside a regular hexagon, 0 outside.",
    doc: Doc {
        computes: "out = 1 inside the regular hexagon around center whose sides are at the distance radius, \
            one of them to the left and one to the right, else 0.",
        statistics: "The measure of a polygon under the Gaussian of the footprint, as a sum over its edges of \
            triangles seen from the mean: exact for any covariance. Variance P(1 − P).",
        accuracy: "The mean is within 1e-4 for any footprint. Held by `nodes/src/pattern/tests.rs` against \
            dense sums.",
        references: "Owen 1956, *Tables for Computing Bivariate Normal Probabilities*; Nicholson 1943, *The \
            Probability Integral for Two Variables* (the measure of a right triangle). MaterialX \
            1.39, node `hexagon` of its standard library.",
    },
    inputs: &[
        TEXCOORD,
        port::pair("center", [0.0, 0.0], "The centre.").unit("uv"),
        port::number("radius", 0.5, "The distance of the sides from the centre.")
            .range(Range::hard(0.0, f32::MAX).with_soft(0.0, 1.0))
            .unit("uv"),
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::of(0.0, 1.0),
    class: |inputs| pattern_unless(inputs, &["center", "radius"]),
    example: example! { "hexagon", r##"
    "hexagon": { "type": "hexagon", "inputs": { "center": [0.5, 0.5], "radius": 0.35 } }
"## },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    drawn(lower, node, |lower| {
        let radius = lower.number(node, "radius");
        let zero = lower.b().float(0.0);
        Figure::Polygon {
            outline: hexagon(),
            axes: [[radius, zero], [zero, radius], [zero, zero]],
        }
    })
}

/// With sides at the distance 1.
pub(crate) fn hexagon() -> Outline {
    let corner = 2.0 / 3f64.sqrt();
    Outline::around(6, &[corner], std::f64::consts::FRAC_PI_6)
}
