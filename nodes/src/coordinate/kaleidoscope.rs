//! Mirrored sectors around a centre.

use crate::componentwise::{difference, sum, transfer};
use crate::pattern::angle::turns;
use mipless_codegen::moments::Piecewise;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
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
        references: "Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8. Abramowitz & \
            Stegun 1964, 4.4.49 (arctangent).",
    },
    inputs: &[
        PortSpec::new(
            "texcoord",
            PortType::Exactly(Type::Vector2),
            Default::Surface,
            "The coordinates.",
        )
        .unit("uv"),
        PortSpec::new(
            "center",
            PortType::Exactly(Type::Vector2),
            Default::Vector2([0.5, 0.5]),
            "The centre.",
        )
        .unit("uv"),
        PortSpec::new(
            "segments",
            PortType::Exactly(Type::Integer),
            Default::Integer(6),
            "How many sectors a turn holds.",
        )
        .uniform()
        .range(Range::hard(1.0, 1000.0).with_soft(2.0, 24.0))
        .unit("sectors"),
    ],
    output: OutputType::Exactly(Type::Vector2),
    class,
    example: r##"{
  "version": 1,
  "name": "kaleidoscope_example",
  "nodes": {
    "tile": { "type": "repeat" },
    "kaleidoscope": { "type": "kaleidoscope", "inputs": { "texcoord": { "node": "tile" }, "segments": 7 } },
    "grain": { "type": "noise2d", "inputs": { "texcoord": { "node": "kaleidoscope" }, "frequency": 9, "pivot": 0.5 } }
  },
  "outputs": { "out": { "node": "grain" } }
}"##,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// A function of both coordinates.
fn class(_: &dyn InputView) -> Behaviour {
    Behaviour::Function
}

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let (texcoord, centre) = (lower.bundle(node, "texcoord"), lower.bundle(node, "center"));
    let segments = lower.integer(node, "segments").max(1) as f32;
    let [x, y] = [0, 1].map(|i| difference(lower, &texcoord[i], &centre[i]));
    let angle = turns(lower, [&x, &y]);
    let b = lower.b();
    // The sector around the axis is number 0.
    let sector = b.scale(angle, segments);
    let sector = b.offset(sector, 0.5);
    let sector = b.floor(sector);
    let back = b.scale(sector, std::f32::consts::TAU / segments);
    let (sine, cosine) = (b.sin(back), b.cos(back));
    let minus = b.neg(sine);
    let [along, across] = [[cosine, sine], [minus, cosine]].map(|[p, q]| {
        let (of_x, of_y) = (x.scale(b, p), y.scale(b, q));
        of_x.add(b, &of_y)
    });
    let absolute = Piecewise::absolute(b);
    let folded = transfer(lower, &across, &absolute);
    vec![
        sum(lower, &along, &centre[0]),
        sum(lower, &folded, &centre[1]),
    ]
}
