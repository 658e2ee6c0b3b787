//! Coordinates that repeat.

use crate::componentwise::product;
use crate::coordinate::place::TEXCOORD;
use crate::pattern::separable::phase;
use crate::port;
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "repeat",
    aliases: &["tile", "fract_uv", "modulo_uv"],
    category: Category::Coordinate,
    summary: "Repeats the unit square of coordinates.",
    doc: Doc {
        computes: "out = texcoord · uvtiling − ⌊texcoord · uvtiling⌋, for each coordinate, with the integer \
            taken where the footprint has its centre.",
        statistics: "A position stays exactly Gaussian: the footprint goes on beyond the seam instead of \
            being cut in two, so that what reads the coordinates is filtered by its own shape. This \
            is exact inside and for textures that fit together at the seam; at a seam where they do \
            not, the footprint shows the texture of its centre's side alone, and the edge that the \
            seam makes is not smoothed. The other choice, the mean and variance of the wrapped \
            coordinate, has a standard deviation of a quarter of the square at 1.5 footprints from \
            the seam already, and blurs everything there.",
        accuracy: "Exact inside; at a seam that does not fit, off by up to half the jump: for a noise of \
            standard deviation 1 and six cells a tile, 0.014, 0.036 and 0.074 (RMS) at footprints of \
            0.02, 0.06 and 0.18 cells. Held by `nodes/src/pattern/tests.rs`.",
        references: "Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8 (linear maps \
            of a footprint).",
    },
    inputs: &[
        TEXCOORD,
        port::pair(
            "uvtiling",
            [1.0, 1.0],
            "How many repetitions a unit of texture space holds.",
        )
        .range(Range::soft(1.0, 16.0))
        .unit("tiles per uv"),
    ],
    output: OutputType::Exactly(Type::Vector2),
    reach: |_| Reach::ANY,
    // Linear within the tile of the centre: what shows it, or reads it where the seam does not fit, has an
    // edge there.
    class: |_| Behaviour::Function,
    example: example! { "repeat" => "disc", r##"
    "repeat": { "type": "repeat", "inputs": { "uvtiling": [3, 3] } },
    "disc": { "type": "ramplr", "inputs": { "texcoord": { "node": "repeat" }, "valuer": 1 } }
"## },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let [texcoord, tiling] = ["texcoord", "uvtiling"].map(|port| lower.bundle(node, port));
    (texcoord.iter().zip(&tiling))
        .map(|(coordinate, tiling)| {
            let tiled = product(lower, coordinate, tiling);
            // The cell is known to be 0 and no longer followed.
            Signal {
                mean: phase(&tiled),
                cell: None,
                range: [f32::NEG_INFINITY, f32::INFINITY],
                ..tiled
            }
        })
        .collect()
}
