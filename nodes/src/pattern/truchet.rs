//! Tiles of Truchet's, each of which lies one way or another.

use crate::noise::cellnoise2d::PERIOD;
use crate::noise::source::{FREQUENCY, SEED, TEXCOORD, position};
use crate::pattern::instances::{Kind, Scatter, filtered};
use crate::port;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "truchet",
    aliases: &["truchet_tiles", "smith_tiles", "maze", "pipes"],
    category: Category::Pattern,
    summary: "Square tiles that are turned at random: bands that meet, or half squares.",
    doc: Doc {
        computes: "Each cell of texcoord · frequency is a tile. With `arcs`, out = 1 within width/2 of the \
            circles of radius ½ around two opposite corners, which of the two pairs is a random bit, so \
            that the bands of all tiles meet in loops. With `triangles`, out = 1 on the half of the tile at \
            one of its four corners, each as likely. Elsewhere it is 0.",
        statistics: "A sum over the tiles in the footprint of the measures of their figures under its \
            Gaussian, exact but for the arcs, which are polygons of 16 edges. Where the footprint covers many \
            tiles, from √(σ₁σ₂) = 0.78 of them or 2.8 along an axis, the sum fades to the share of the plane \
            that is 1: each tile has the same, so that little is lost where the footprint is round.",
        accuracy: "The mean is within 0.005 until it fades, rotated footprints of 8:1 included. Then that of arcs \
            is within 0.006 and that of triangles, whose tiles differ more, within 0.04 under thin footprints. \
            Held by `nodes/tests/sources.rs` against dense sums.",
        references: "Truchet 1704, *Mémoire sur les combinaisons*; Smith 1987, *The Tiling Patterns of \
            Sebastien Truchet and the Topology of Structural Hierarchy* (arcs). Owen 1956, *Tables for \
            Computing Bivariate Normal Probabilities*.",
    },
    inputs: &[
        TEXCOORD,
        FREQUENCY,
        port::choice(
            "tile",
            &["arcs", "triangles"],
            "arcs",
            "What stands on a tile.",
        ),
        port::number("width", 0.2, "The width of the bands.")
            .uniform()
            .range(Range::hard(0.0, 0.4))
            .unit("cells"),
        SEED,
        PERIOD,
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::of(0.0, 1.0),
    class: |_| Behaviour::Random { deviation: 0.35 },
    example: example! { "truchet", r#"
    "truchet": { "type": "truchet", "inputs": { "frequency": 8 } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let position = position(lower, node);
    let scatter = Scatter {
        kind: match lower.choice(node, "tile") {
            "triangles" => Kind::Triangle,
            _ => Kind::Arcs,
        },
        size: 1.0,
        variation: 0.0,
        jitter: 0.0,
        turn: 0.0,
        density: 1.0,
        band: f64::from(lower.float(node, "width")).clamp(0.0, 0.4),
        seed: lower.integer(node, "seed"),
        period: lower.integer(node, "period"),
        is_mask: true,
    };
    filtered(lower, &position, &scatter)
}
