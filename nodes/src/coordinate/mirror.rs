//! Coordinates that are mirrored back and forth.

use crate::componentwise::{product, transfer};
use crate::coordinate::place::TEXCOORD;
use crate::pattern::triangle::Triangle;
use crate::port;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "mirror",
    aliases: &["mirror_uv", "ping_pong", "mirror2d"],
    category: Category::Coordinate,
    summary: "Mirrors coordinates back and forth between 0 and 1.",
    doc: Doc {
        computes: "out = |x − 2⌊x/2 + ½⌋| with x = texcoord · uvtiling, for each coordinate along the \
            chosen axes; the others are unchanged. From 0 to 1, back to 0 at 2, and so on.",
        statistics: "A triangle wave of a Gaussian in closed form: its mean, slope and distortion from its \
            kinks one by one up to σ = 0.2 periods, from damped harmonics beyond. Inside and along \
            the folds exact in mean and variance; what reads the coordinates takes them for \
            Gaussian, which at a fold they are not.",
        accuracy: "The mean is within 1e-4 of the coordinate, its standard deviation within 0.01. Of a \
            noise of standard deviation 1 and six cells a tile that is read there, the mean is \
            within 0.001, 0.002 and 0.008 (RMS) at footprints of 0.02, 0.06 and 0.18 cells. Held by \
            `nodes/src/pattern/tests.rs`.",
        references: cite!(bussgang),
    },
    inputs: &[
        TEXCOORD,
        port::pair(
            "uvtiling",
            [1.0, 1.0],
            "How many unit squares a unit of texture space holds.",
        )
        .range(Range::soft(1.0, 16.0))
        .unit("tiles per uv"),
        port::choice(
            "axis",
            &["u", "v", "both"],
            "both",
            "Which coordinates are mirrored.",
        ),
    ],
    output: OutputType::Exactly(Type::Vector2),
    reach: |_| Reach::ANY,
    class: |_| Behaviour::Function,
    example: example! { "mirror" => "grain", r##"
    "mirror": { "type": "mirror", "inputs": { "uvtiling": [3, 2] } },
    "grain": { "type": "noise2d", "inputs": { "texcoord": { "node": "mirror" }, "frequency": 5, "pivot": 0.5 } }
"## },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let [texcoord, tiling] = ["texcoord", "uvtiling"].map(|port| lower.bundle(node, port));
    let axis = lower.choice(node, "axis");
    [("u", 0), ("v", 1)]
        .map(|(name, i)| {
            let tiled = product(lower, &texcoord[i], &tiling[i]);
            if axis != "both" && axis != name {
                return tiled;
            }
            transfer(lower, &(tiled * 0.5), &Triangle)
        })
        .to_vec()
}
