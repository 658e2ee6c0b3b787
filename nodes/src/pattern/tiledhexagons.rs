//! Hexagons in a lattice.

use crate::pattern::grid::{STAGGERED, TEXCOORD, UVOFFSET, UVTILING};
use crate::pattern::tiledcircles::tiles;
use crate::pattern::tiling::Tile;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "tiledhexagons",
    aliases: &["beehive", "honeycomb", "hexagons", "tiled_hexagons"],
    category: Category::Pattern,
    summary: "A hexagon in every cell.",
    doc: Doc {
        computes: "With (u, v) = texcoord · uvtiling − uvoffset: out = 1 inside a regular hexagon of width \
            size, with a corner up, in the middle of every unit cell, else 0. Where the tiling is \
            staggered, the figures stand at the origin and in rows that are 0.866 cells apart and \
            shifted by half a cell, so that each has six neighbours.",
        statistics: "Footprints whose minor axis is below 0.16 cells and whose major axis is below 1.3 cells \
            sum the exact measures of the figures near them, edge by edge. All others damp the \
            Fourier series of the lattice by e^{−2π²kᵀΣk}, exact for any covariance; those that are \
            thinner are widened first, gradually from a length of 0.9 cells. Variance P(1 − P). Over \
            a large footprint the mean is the share of the plane that the figures cover.",
        accuracy: "The mean is within 2e-3, but for footprints that are longer than 0.9 cells and thinner \
            than 0.16: these are blurred across, which is within 0.01 at 8:1. Held by \
            `nodes/src/pattern/tests.rs` against dense sums.",
        references: "Owen 1956, *Tables for Computing Bivariate Normal Probabilities*. Heckbert 1989, \
            *Fundamentals of Texture Mapping and Image Warping*, §3.5.8 (a footprint as a low-pass). \
            MaterialX 1.39, node `tiledhexagons` of its standard library.",
    },
    inputs: &[
        TEXCOORD,
        UVTILING,
        UVOFFSET,
        PortSpec::new(
            "size",
            PortType::Exactly(Type::Float),
            Default::Float(0.5),
            "The width; staggered hexagons of size 1 leave no gap.",
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
  "name": "tiledhexagons_example",
  "nodes": {
    "tiledhexagons": { "type": "tiledhexagons", "inputs": { "uvtiling": [7, 7], "size": 0.8, "staggered": true } }
  },
  "outputs": { "out": { "node": "tiledhexagons" } }
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
    let staggered = lower.flag(node, "staggered");
    let radius = 0.5 * f64::from(lower.float(node, "size"));
    let (side, top) = (radius / 3f64.sqrt(), 2.0 * radius / 3f64.sqrt());
    let sides = if top > 0.5 && !staggered {
        // What reaches beyond its cell is cut.
        vec![
            [0.0, radius],
            [side, radius],
            [0.5, (top - 0.5) * 3f64.sqrt()],
        ]
    } else {
        vec![[0.0, radius], [side, radius], [top, 0.0]]
    };
    tiles(lower, node, &Tile::Polygon(sides))
}
