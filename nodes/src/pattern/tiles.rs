//! Figures in a lattice: discs, hexagons and cloverleafs.

use crate::pattern::checkerboard::tiled as cells;
use crate::pattern::cloverleaf::quadrant;
use crate::pattern::grid::{STAGGERED, TEXCOORD, UVOFFSET, UVTILING};
use crate::pattern::tiling::{Lattice, Tile, tiled};
use crate::pattern::unless::pattern_unless;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range, Reach, Type,
};

/// One row a node: what stands in a cell, of a radius and perhaps staggered, and how the pages say it.
macro_rules! figures {
    ($($(#[$doc:meta])* $node:ident {
        tile: $tile:expr,
        staggered: $lattice:ident, $rows:literal,
        aliases: $aliases:expr,
        summary: $summary:literal,
        inside: $inside:literal,
        summed: $summed:literal,
        within: $within:literal,
        references: $references:literal,
        size: $size:literal,
    })*) => {$(
        $(#[$doc])*
        pub(crate) const fn $node() -> NodeDef {
            static SPEC: NodeSpec = NodeSpec {
                name: stringify!($node),
                aliases: $aliases,
                category: Category::Pattern,
                summary: $summary,
                doc: Doc {
                    computes: concat!(
                        "With (u, v) = texcoord · uvtiling − uvoffset: out = 1 inside ", $inside,
                        " in the middle of every unit cell, else 0. Where the tiling is staggered, the \
                        figures stand ", $rows,
                    ),
                    statistics: concat!(
                        "Footprints whose minor axis is below 0.16 cells and whose major axis is below 1.3 \
                        cells sum the exact measures of the figures near them, ", $summed, ". All others \
                        damp the Fourier series of the lattice by e^{−2π²kᵀΣk}, exact for any covariance; \
                        those that are thinner are widened first, gradually from a length of 0.9 cells. \
                        Variance P(1 − P). Over a large footprint the mean is the share of the plane that \
                        the figures cover.",
                    ),
                    accuracy: concat!(
                        "The mean is within ", $within, ", but for footprints that are longer than 0.9 cells \
                        and thinner than 0.16: these are blurred across, which is within 0.01 at 8:1. Held \
                        by `nodes/src/pattern/tests.rs` against dense sums.",
                    ),
                    references: concat!(
                        $references, " MaterialX 1.39, node `", stringify!($node), "` of its standard library.",
                    ),
                },
                inputs: &[
                    TEXCOORD,
                    UVTILING,
                    UVOFFSET,
                    PortSpec::new("size", PortType::Exactly(Type::Float), Default::Float(0.5), $size)
                        .uniform()
                        .range(Range::hard(0.0, 1.0))
                        .unit("cells"),
                    STAGGERED,
                ],
                output: OutputType::Exactly(Type::Color3),
                reach: |_| Reach::of(0.0, 1.0),
                class: |inputs| pattern_unless(inputs, &["uvtiling", "uvoffset"]),
                example: concat!("{\n  \"version\": 1,\n  \"name\": \"", stringify!($node), "_example\",\n  \"nodes\": {\n    \"", stringify!($node), "\": { \"type\": \"", stringify!($node), "\", \"inputs\": { \"uvtiling\": [7, 7], \"size\": 0.8, \"staggered\": true } }\n  },\n  \"outputs\": { \"out\": { \"node\": \"", stringify!($node), "\" } }\n}"),
            };
            NodeDef::new(&SPEC, |lower, node| tiles(lower, node, Lattice::$lattice, $tile))
        }
    )*};
}

figures! {
    /// Discs.
    tiledcircles {
        tile: |radius, _| Tile::Disc(radius),
        staggered: Triangular, "at the origin and in rows that are 0.866 cells apart and shifted by half a \
            cell, so that each has six neighbours.",
        aliases: &["dots", "polka_dots", "tiled_circles"],
        summary: "A disc in every cell.",
        inside: "a disc of diameter size",
        summed: "disc by disc",
        within: "2e-3",
        references: "Watson 1944, *A Treatise on the Theory of Bessel Functions* (the transform of a disc). \
            Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8 (a footprint \
            as a low-pass).",
        size: "The diameter.",
    }
    /// Hexagons with a corner up.
    tiledhexagons {
        tile: hexagon,
        staggered: Triangular, "at the origin and in rows that are 0.866 cells apart and shifted by half a \
            cell, so that each has six neighbours.",
        aliases: &["beehive", "honeycomb", "hexagons", "tiled_hexagons"],
        summary: "A hexagon in every cell.",
        inside: "a regular hexagon of width size, with a corner up,",
        summed: "edge by edge",
        within: "2e-3",
        references: "Owen 1956, *Tables for Computing Bivariate Normal Probabilities*. Heckbert 1989, \
            *Fundamentals of Texture Mapping and Image Warping*, §3.5.8 (a footprint as a low-pass).",
        size: "The width; staggered hexagons of size 1 leave no gap.",
    }
    /// Cloverleafs.
    tiledcloverleafs {
        tile: cloverleaf,
        staggered: Quincunx, "at the corners and in the middles of the cells.",
        aliases: &["cloverleafs", "quatrefoils", "tiled_cloverleafs"],
        summary: "A cloverleaf in every cell.",
        inside: "a `cloverleaf` of width size, with 24 edges a half of its outline,",
        summed: "edge by edge",
        within: "3e-3",
        references: "Owen 1956, *Tables for Computing Bivariate Normal Probabilities*. Heckbert 1989, \
            *Fundamentals of Texture Mapping and Image Warping*, §3.5.8 (a footprint as a low-pass).",
        size: "The width from tip to tip.",
    }
}

/// The tiling of a node, as a colour; `tile` is what stands in a cell, of a radius and perhaps staggered,
/// then at the sites of the lattice `otherwise`.
fn tiles<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    otherwise: Lattice,
    tile: impl FnOnce(f64, bool) -> Tile,
) -> Bundle<'b> {
    let staggered = lower.flag(node, "staggered");
    let lattice = if staggered {
        otherwise
    } else {
        Lattice::Square
    };
    let tile = tile(0.5 * f64::from(lower.float(node, "size")), staggered);
    let position = cells(lower, node, [1.0, (1.0 / lattice.height()) as f32]);
    let tiling = tile.on(lower.b(), lattice);
    vec![tiled(lower, &position, &tiling); 3]
}

fn hexagon(radius: f64, staggered: bool) -> Tile {
    let (side, top) = (radius / 3f64.sqrt(), 2.0 * radius / 3f64.sqrt());
    Tile::Polygon(if top > 0.5 && !staggered {
        // What reaches beyond its cell is cut.
        vec![
            [0.0, radius],
            [side, radius],
            [0.5, (top - 0.5) * 3f64.sqrt()],
        ]
    } else {
        vec![[0.0, radius], [side, radius], [top, 0.0]]
    })
}

/// Edges of a quarter of a circle: a leaf is seldom large on the screen.
const EDGES: usize = 6;

fn cloverleaf(radius: f64, staggered: bool) -> Tile {
    let corners = quadrant(EDGES).into_iter();
    let quarter: Vec<[f64; 2]> = corners.map(|[x, y]| [radius * y, radius * x]).collect();
    Tile::Polygon(if staggered {
        within_diamond(&quarter)
    } else {
        quarter
    })
}

/// What of a figure is nearer to its site than to those of a quincunx around it, |x| + |y| ≤ ½. Leaves
/// larger than 0.83 reach into their neighbours', which are their mirror images: what is cut off lies in
/// these.
fn within_diamond(quarter: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let beyond = |[y, x]: [f64; 2]| x + y - 0.5;
    let mut cut = Vec::with_capacity(quarter.len() + 2);
    for pair in quarter.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        cut.push([from[0], from[1].min(0.5 - from[0])]);
        let [before, after] = [from, to].map(beyond);
        if before * after < 0.0 {
            let share = before / (before - after);
            cut.push([0, 1].map(|i| from[i] + share * (to[i] - from[i])));
        }
    }
    cut.extend(quarter.last().map(|&[y, x]| [y, x.min(0.5 - y)]));
    cut
}
