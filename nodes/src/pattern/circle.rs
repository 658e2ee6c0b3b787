//! A disc.

use crate::pattern::figure::{Figure, drawn_softly};
use crate::pattern::grid::TEXCOORD;
use crate::port;

use crate::pattern::unless::pattern_unless;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, PortSpec, Range, Reach, Type};

/// How soft.
pub(crate) const EDGE: PortSpec = port::number(
    "edge",
    0.0,
    "The width of the ramp from 0 to 1 across the outline; 0 for a sharp one.",
)
.range(Range::hard(0.0, f32::MAX).with_soft(0.0, 0.5))
.unit("uv");

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "circle",
    aliases: &["disc", "disk"],
    category: Category::Pattern,
    summary: "1 inside a circle, 0 outside.",
    doc: Doc {
        computes: "out = 1 where r = |texcoord − center| is below radius, else 0; with an edge, ½ + (radius \
            − r)/edge limited to [0, 1]. MaterialX's node has no edge.",
        statistics: "The measure of a disc under the Gaussian of the footprint, chord by chord along the \
            footprint's minor axis: exact for any covariance. Variance P(1 − P). An edge adds the \
            difference of a ramp and a step of the distance as a Gaussian, with the mean and the variance \
            that the distance from the centre has: exact where the outline is straight over the ramp and \
            the footprint, and where the footprint is large against the ramp or the ramp against \
            both.",
        accuracy: "The mean is within 1e-3 for any footprint; with an edge of half the radius within 0.003, and 0.017 at 8:1, the variance within 0.02. Held by `nodes/src/pattern/tests.rs` against \
            dense sums.",
        references: "Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8. MaterialX \
            1.39, node `circle` of its standard library.",
    },
    inputs: &[
        TEXCOORD,
        port::pair("center", [0.0, 0.0], "The centre.").unit("uv"),
        port::number("radius", 0.5, "The radius.")
            .range(Range::hard(0.0, f32::MAX).with_soft(0.0, 1.0))
            .unit("uv"),
        EDGE,
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::of(0.0, 1.0),
    class: |inputs| pattern_unless(inputs, &["center", "radius", "edge"]),
    example: example! { "circle", r##"
    "circle": { "type": "circle", "inputs": { "center": [0.5, 0.5], "radius": 0.35 } }
"## },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let edge = lower.number(node, "edge");
    drawn_softly(lower, node, Some(edge), |lower| {
        let radius = lower.number(node, "radius");
        Figure::Disc { radius }
    })
}
