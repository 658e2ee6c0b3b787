//! Cloverleafs in a lattice.

use crate::pattern::cloverleaf::quadrant;
use crate::pattern::grid::{STAGGERED, TEXCOORD, UVOFFSET, UVTILING};
use crate::pattern::tiledcircles::tiles;
use crate::pattern::tiling::Tile;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "tiledcloverleafs",
    aliases: &["cloverleafs", "quatrefoils", "tiled_cloverleafs"],
    category: Category::Pattern,
    summary: "A cloverleaf in every cell.",
    doc: Doc {
        computes: "With (u, v) = texcoord · uvtiling − uvoffset: out = 1 inside a `cloverleaf` of width \
            size, with 24 edges a half of its outline, in the middle of every unit cell, else 0. Where the tiling is \
            staggered, the figures stand at the origin and in rows that are 0.866 cells apart and \
            shifted by half a cell, so that each has six neighbours.",
        statistics: "Footprints whose minor axis is below 0.16 cells and whose major axis is below 1.3 cells \
            sum the exact measures of the figures near them, edge by edge. All others damp the \
            Fourier series of the lattice by e^{−2π²kᵀΣk}, exact for any covariance; those that are \
            thinner are widened first, gradually from a length of 0.9 cells. Variance P(1 − P). Over \
            a large footprint the mean is the share of the plane that the figures cover.",
        accuracy: "The mean is within 3e-3, but for footprints that are longer than 0.9 cells and thinner \
            than 0.16: these are blurred across, which is within 0.01 at 8:1. Held by \
            `nodes/src/pattern/tests.rs` against dense sums.",
        references: "Owen 1956, *Tables for Computing Bivariate Normal Probabilities*. Heckbert 1989, \
            *Fundamentals of Texture Mapping and Image Warping*, §3.5.8 (a footprint as a low-pass). \
            MaterialX 1.39, node `tiledcloverleafs` of its standard library.",
    },
    inputs: &[
        TEXCOORD,
        UVTILING,
        UVOFFSET,
        PortSpec::new(
            "size",
            PortType::Exactly(Type::Float),
            Default::Float(0.5),
            "The width from tip to tip.",
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
  "name": "tiledcloverleafs_example",
  "nodes": {
    "tiledcloverleafs": { "type": "tiledcloverleafs", "inputs": { "uvtiling": [7, 7], "size": 0.8, "staggered": true } }
  },
  "outputs": { "out": { "node": "tiledcloverleafs" } }
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

/// Edges of a quarter of a circle: a leaf is seldom large on the screen.
const EDGES: usize = 6;

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let radius = 0.5 * f64::from(lower.float(node, "size"));
    let corners = quadrant(EDGES).into_iter();
    let sides = corners.map(|[x, y]| [radius * y, radius * x]).collect();
    tiles(lower, node, &Tile::Polygon(sides))
}
