//! Brick walls.

use crate::componentwise::product;
use crate::pattern::bond::Bond;
use crate::pattern::grid::TEXCOORD;
use crate::pattern::random::numbered;
use crate::pattern::separable::{Pattern, filtered};
use crate::pattern::slope::report_bricks;
use crate::pattern::unless::pattern_unless;
use crate::pattern::wall::Wall;
use crate::port;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Literal, Node, NodeSpec, OutputType, Range, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "brick",
    aliases: &["bricks", "brick_texture", "brick_wall", "tiles", "masonry"],
    category: Category::Pattern,
    summary: "A wall of bricks, 1 on their faces and 0 in the joints.",
    doc: Doc {
        computes: "With x = columns · u and y = rows · v, bricks of 1 × 1 in one of six bonds: \
            `running` (every other row is shifted by row_offset), `english` (rows of stretchers \
            and rows of headers of half the width), `flemish` (stretchers and headers alternate in \
            each row), `basket` (pairs of lying and of standing bricks), `herringbone` and `spanish` (a \
            pinwheel: in unit cells of 3/2 × 3, bricks from (0, 0) to (1/2, 2), (1/2, 0) to (3/2, 1), \
            (1, 1) to (3/2, 3) and (0, 2) to (1, 3) around a square from (1/2, 1) to (1, 2)). Standing \
            bricks are 1/2 × 2, which is a turned brick where rows = 2 columns. out rises from 0 at the \
            joint to 1 over the bevel; with the output `random`, out is a uniform random number of \
            [0, 1] for each brick and half of the joints around it. Joints and bevels are measured in rows and have the same \
            width in texture space in both directions.",
        statistics: "A sum over the bricks within reach of products of two periodic pulses, one a \
            coordinate. Each pulse has its closed form (a sum over its edges up to \
            σ = 0.11 periods, six damped harmonics beyond). Up to a correlation of the coordinates of 1/2 the \
            mean of a product is four terms of Mehler's series; of a larger one a part that both \
            share is integrated by the trapezoid rule, 19 nodes for 8:1 at 45 degrees. Where that takes longer, \
            the wall is the sum of its waves that the footprint leaves, each damped by e^{−2π²kᵀΣk}, whatever the \
            footprint's direction. Without a bevel the variance is P(1 − P); with one, from the mean of the \
            square, whose ramps are exact for their edges and approximate in waves. Random numbers are \
            weighted by the share of the footprint that each brick holds: a product of two shares near by, \
            the density of a Gaussian at each part of a brick under long footprints. They fade to their mean, 1/2, \
            where the footprint covers many bricks: from 8.5 bricks of √det Σ, or where it is much longer than a unit \
            cell and thin. Of varying parameters the means are used.",
        accuracy: "The mean is within 1e-3 for footprints along the axes and within 2e-3 for rotated \
            ones up to 10:1; longer ones are blurred across to 10:1 while they are narrow. Random numbers are \
            within 1e-3 under round footprints and 0.01 under rotated ones of 8:1 until they fade, and then \
            within 0.04. With a bevel the standard \
            deviation is within 0.03. Held by `nodes/src/pattern/tests.rs` against dense sums.",
        references: "Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8. \
            Mehler 1866. Trefethen & Weideman 2014, *The Exponentially Convergent Trapezoidal Rule*. Names of \
            bonds as masons use them, `spanish` as Material Maker does.",
    },
    inputs: &[
        TEXCOORD,
        port::choice("bond", &[
                "running",
                "english",
                "flemish",
                "herringbone",
                "basket",
                "spanish",
            ], "running", "How the bricks are laid."),
        port::choice("output", &["mask", "random"], "mask", "The faces of the bricks, or a random number for each."),
        port::integer("seed", 0, "Selects the random numbers.")
        .uniform()
        .range(Range::hard(i32::MIN as f32, i32::MAX as f32).with_soft(0.0, 100.0)),
        port::number("columns", 4.0, "How many bricks a unit of texture space holds along u.")
        .range(Range::soft(1.0, 32.0))
        .unit("bricks per uv"),
        port::number("rows", 8.0, "How many rows a unit of texture space holds along v.")
        .range(Range::soft(1.0, 64.0).nonzero())
        .unit("rows per uv"),
        port::number("row_offset", 0.5, "By how much every other row of the running bond is shifted; the other bonds have their own.")
        .range(Range::soft(0.0, 1.0))
        .unit("bricks"),
        port::number("mortar", 0.1, "The width of the joints.")
        .range(Range::hard(0.0, 1.0).with_soft(0.0, 0.5))
        .unit("rows"),
        port::number("bevel", 0.0, "The width over which a brick's edge rises, at most to its middle.")
        .range(Range::hard(0.0, 1.0).with_soft(0.0, 0.5))
        .unit("rows"),
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::of(0.0, 1.0),
    class: |inputs| pattern_unless(inputs, &["columns", "rows", "row_offset", "mortar", "bevel"]),
    example: example! { "brick", r#"
    "brick": { "type": "brick", "inputs": { "bond": "flemish", "columns": 4, "rows": 12, "mortar": 0.12, "bevel": 0.1 } }
"# },
};

/// Every brick has a number.
pub(super) fn things(node: &Node) -> bool {
    matches!(node.literal("output"), Literal::Text(text) if text == "random")
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let bond = Bond::named(lower.choice(node, "bond"));
    let texcoord = lower.bundle(node, "texcoord");
    let counts = ["columns", "rows"].map(|port| lower.signal(node, port));
    let cell = bond.cell();
    let position = [0, 1].map(|i| product(lower, &texcoord[i], &counts[i]) * (1.0 / cell[i]));
    let [offset, mortar, bevel] =
        ["row_offset", "mortar", "bevel"].map(|port| lower.number(node, port));
    if lower.choice(node, "output") == "random" {
        let seed = lower.integer(node, "seed");
        return numbered(lower, &position, bond, offset, seed);
    }
    let [columns, rows] = counts.map(|count| count.flat_mean().abs());
    let rows = rows.max(1e-6);
    // From rows to columns.
    let aspect = columns / rows;
    let [mortar, bevel] = [mortar, bevel].map(|v| v.clamp(0.0, 1.0));
    let [mortar_x, bevel_x] = [mortar, bevel].map(|v| v * aspect);
    let edges = [mortar_x, bevel_x, mortar, bevel];
    report_bricks(lower, &texcoord, [columns, rows], edges);
    let width = [bevel_x * (1.0 / cell[0]), bevel * (1.0 / cell[1])];
    let pattern = Pattern {
        cell: &Wall { bond },
        parameters: vec![offset, mortar_x, bevel_x, mortar, bevel],
        ramps: (!bevel.is_zero()).then_some(width),
    };
    vec![filtered(lower, &position, &pattern)]
}
