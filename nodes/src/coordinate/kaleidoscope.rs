//! Mirrored sectors around a centre.

use crate::componentwise::{sum, transfer};
use crate::coordinate::place::{CENTER, TEXCOORD, centred};
use crate::pattern::angle::turns;
use crate::port;
use mipless_codegen::moments::Piecewise;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "kaleidoscope",
    aliases: &["radial_mirror", "mirror_radial"],
    category: Category::Coordinate,
    summary: "Repeats one sector around a centre, mirrored.",
    doc: Doc {
        computes: "With p = texcoord − center, each of the segments around the centre is turned onto the \
            one that lies around the u axis, and its half below the axis is mirrored up: out = \
            center + (x, |y|). The result is continuous.",
        statistics: "In the sector of the footprint's centre, a turn, which is exact, and |y| in closed form, \
            as `absval`. Beyond the edge of the sector the footprint goes on in a straight line \
            instead of being mirrored: exact where it lies within a sector.",
        accuracy: "Exact within a sector; at its edges approximate: for a noise of standard deviation 1 and \
            six cells a uv, 0.008, 0.027 and 0.062 (RMS) at footprints of 0.02, 0.06 and 0.18 cells. \
            Held by `nodes/src/pattern/tests.rs`.",
        references: cite!(heckbert, arctangent),
    },
    inputs: &[
        TEXCOORD,
        CENTER,
        port::integer("segments", 6, "How many sectors a turn holds.")
            .uniform()
            .range(Range::hard(1.0, 1000.0).with_soft(2.0, 24.0))
            .unit("sectors"),
    ],
    output: OutputType::Exactly(Type::Vector2),
    reach: |_| Reach::ANY,
    class: |_| Behaviour::Function,
    example: example! { "kaleidoscope" => "grain", r##"
    "tile": { "type": "repeat" },
    "kaleidoscope": { "type": "kaleidoscope", "inputs": { "texcoord": { "node": "tile" }, "segments": 7 } },
    "grain": { "type": "noise2d", "inputs": { "texcoord": { "node": "kaleidoscope" }, "frequency": 9, "pivot": 0.5 } }
"## },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let (centre, [x, y]) = centred(lower, node);
    let segments = lower.integer(node, "segments").max(1) as f32;
    // The sector around the axis is number 0.
    let sector = (turns([&x, &y]) * segments + 0.5).floor();
    let back = sector * (std::f32::consts::TAU / segments);
    let (sine, cosine) = (back.sin(), back.cos());
    let [along, across] = [[cosine, sine], [-sine, cosine]].map(|[p, q]| &x * p + &y * q);
    let folded = transfer(lower, &across, &Piecewise::absolute(lower.b()));
    vec![sum(&along, &centre[0]), sum(&folded, &centre[1])]
}
