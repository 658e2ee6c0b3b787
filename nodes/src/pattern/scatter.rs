//! Scattered figures.

use crate::noise::cellnoise2d::PERIOD;
use crate::noise::source::{FREQUENCY, SEED, TEXCOORD, position};
use crate::pattern::instances::{Kind, Scatter, filtered};
use crate::port;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Doc, Literal, Node, NodeSpec, OutputType, Range, Reach, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "scatter",
    aliases: &[
        "tiler",
        "splatter",
        "tile_sampler",
        "bombing",
        "instances",
        "speckles",
        "pebbles",
        "sprinkles",
    ],
    category: Category::Pattern,
    summary: "Figures that are scattered over cells, each with a place, a size, a turn and a number of its own.",
    doc: Doc {
        computes: "Each cell of texcoord · frequency holds a figure with the probability density: a disc of \
            the diameter d, or a regular polygon with its corners on such a circle, where d is size times a \
            uniform number of [1 − variation, 1]. It stands off the cell's middle by jitter times a uniform \
            number of ±(1 − d)/2 along each coordinate, so that it does not leave its cell, and a polygon is \
            turned by a uniform angle of ±rotate. out = 1 inside the figures and 0 elsewhere; with the \
            output `random`, a uniform number of [0, 1) for each figure, and 0 elsewhere.",
        statistics: "A sum over the figures in the footprint of their measures under its Gaussian: exact for \
            footprints that are thinner than a figure; of wider ones the density of the Gaussian convolved \
            with the figure's own covariance, times its area. What follows the numbers is evaluated for \
            each figure and for the ground, and summed. Where the footprint covers many cells, from √(σ₁σ₂) = 1.3 of them or 2.8 \
            along an axis, the sum fades to the mean over all figures.",
        accuracy: "The mean is within 0.005 until it fades, rotated footprints of 8:1 included, and then within \
            0.03. Held by `nodes/tests/sources.rs` against dense sums.",
        references: "Schacter & Ahuja 1979, *Random Pattern Generation Processes* (bombing). Owen 1956, \
            *Tables for Computing Bivariate Normal Probabilities*. Material Maker's `tiler` and Substance's \
            Tile Sampler scatter pictures.",
    },
    inputs: &[
        TEXCOORD,
        FREQUENCY,
        port::choice("shape", &["disc", "polygon"], "disc", "Which figure."),
        port::integer("sides", 6, "How many corners a polygon has.")
            .uniform()
            .range(Range::hard(3.0, 64.0).with_soft(3.0, 12.0)),
        port::number("size", 0.8, "The diameter of the largest.")
            .uniform()
            .range(Range::hard(0.0, 1.0))
            .unit("cells"),
        port::number(
            "variation",
            0.5,
            "By what share of it the diameter may be smaller.",
        )
        .uniform()
        .range(Range::hard(0.0, 1.0)),
        port::number(
            "jitter",
            1.0,
            "What share of the room in the cell the places take up.",
        )
        .uniform()
        .range(Range::hard(0.0, 1.0)),
        port::number("rotate", 180.0, "By how much polygons may be turned.")
            .uniform()
            .range(Range::hard(0.0, 180.0))
            .unit("degrees"),
        port::number("density", 1.0, "What share of the cells has a figure.")
            .uniform()
            .range(Range::hard(0.0, 1.0)),
        SEED,
        PERIOD,
        port::choice(
            "output",
            &["mask", "random"],
            "mask",
            "The figures, or a random number for each.",
        ),
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::of(0.0, 1.0),
    class: |_| Behaviour::Random { deviation: 0.35 },
    example: example! { "scatter", r#"
    "scatter": { "type": "scatter", "inputs": { "frequency": 8, "shape": "polygon", "output": "random" } }
"# },
};

/// Every figure has a number.
pub(super) fn things(node: &Node) -> bool {
    matches!(node.literal("output"), Literal::Text(text) if text == "random")
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let position = position(lower, node);
    let number = |port: &str| f64::from(lower.float(node, port));
    let scatter = Scatter {
        kind: match lower.choice(node, "shape") {
            "polygon" => Kind::Polygon(lower.integer(node, "sides").clamp(3, 64) as usize),
            _ => Kind::Disc,
        },
        size: number("size").clamp(0.0, 1.0),
        variation: number("variation").clamp(0.0, 1.0),
        jitter: number("jitter").clamp(0.0, 1.0),
        turn: number("rotate").clamp(0.0, 180.0).to_radians(),
        density: number("density").clamp(0.0, 1.0),
        band: 0.0,
        seed: lower.integer(node, "seed"),
        period: lower.integer(node, "period"),
        is_mask: !things(node),
    };
    filtered(lower, &position, &scatter)
}
