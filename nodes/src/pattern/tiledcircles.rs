//! Discs in a lattice.

use crate::pattern::checkerboard::tiled as cells;
use crate::pattern::grid::{STAGGERED, TEXCOORD, UVOFFSET, UVTILING};
use crate::pattern::tiling::{Lattice, Tile, tiled};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "tiledcircles",
    aliases: &["dots", "polka_dots", "tiled_circles"],
    category: Category::Pattern,
    summary: "A disc in every cell.",
    doc: Doc {
        computes: "With (u, v) = texcoord · uvtiling − uvoffset: out = 1 inside a disc of diameter size in \
            the middle of every unit cell, else 0. Where the tiling is staggered, the figures stand \
            at the origin and in rows that are 0.866 cells apart and shifted by half a cell, so that \
            each has six neighbours.",
        statistics: "Footprints whose minor axis is below 0.16 cells and whose major axis is below 1.3 cells \
            sum the exact measures of the figures near them, disc by disc. All others damp the \
            Fourier series of the lattice by e^{−2π²kᵀΣk}, exact for any covariance; those that are \
            thinner are widened first, gradually from a length of 0.9 cells. Variance P(1 − P). Over \
            a large footprint the mean is the share of the plane that the figures cover.",
        accuracy: "The mean is within 2e-3, but for footprints that are longer than 0.9 cells and thinner \
            than 0.16: these are blurred across, which is within 0.01 at 8:1. Held by \
            `nodes/src/pattern/tests.rs` against dense sums.",
        references: "Watson 1944, *A Treatise on the Theory of Bessel Functions* (the transform of a disc). \
            Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8 (a footprint \
            as a low-pass). MaterialX 1.39, node `tiledcircles` of its standard library.",
    },
    inputs: &[
        TEXCOORD,
        UVTILING,
        UVOFFSET,
        PortSpec::new(
            "size",
            PortType::Exactly(Type::Float),
            Default::Float(0.5),
            "The diameter.",
        )
        .uniform()
        .range(Range::hard(0.0, 1.0))
        .unit("cells"),
        STAGGERED,
    ],
    output: OutputType::Exactly(Type::Color3),
    class,
    example: r##"{
  "version": 1,
  "name": "tiledcircles_example",
  "nodes": {
    "tiledcircles": { "type": "tiledcircles", "inputs": { "uvtiling": [7, 7], "size": 0.8, "staggered": true } }
  },
  "outputs": { "out": { "node": "tiledcircles" } }
}"##,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// A function of position alone, unless a parameter varies.
fn class(inputs: &dyn InputView) -> Behaviour {
    if ["uvtiling", "uvoffset"]
        .into_iter()
        .any(|port| inputs.varies(port))
    {
        Behaviour::Function
    } else {
        Behaviour::Pattern
    }
}

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let radius = 0.5 * f64::from(lower.float(node, "size"));
    tiles(lower, node, &Tile::Disc(radius))
}

/// The tiling of a node, as a colour.
pub(crate) fn tiles(lower: &mut Lower<'_>, node: &Node, tile: &Tile) -> Bundle {
    let lattice = if lower.flag(node, "staggered") {
        Lattice::Triangular
    } else {
        Lattice::Square
    };
    let position = cells(lower, node, [1.0, (1.0 / lattice.height()) as f32]);
    let tiling = tile.on(lower.b(), lattice);
    let figures = tiled(lower, &position, &tiling);
    vec![figures; 3]
}
