//! Squares of two colours.

use mipless_codegen::moments::SquareWave;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Range, Type,
};

use crate::componentwise::{binary, difference, product, transfer};

static SPEC: NodeSpec = NodeSpec {
    name: "checkerboard",
    aliases: &["checker", "checker_texture", "checkers", "chess"],
    category: Category::Pattern,
    summary: "A board of squares of two colours.",
    doc: Doc {
        computes: "out = color1 where ⌊u⌋ + ⌊v⌋ is even, else color2, with (u, v) = texcoord · uvtiling \
            − uvoffset.",
        statistics: "The parity is ½(1 + ab) with a and b square waves of ±1, one a coordinate, each in \
            closed form (see `stripes`); their product adds the covariance that a rotated \
            footprint gives them. Exact for footprints along the axes, approximate for rotated \
            ones, where the two waves are not jointly Gaussian. Over a large footprint the mean \
            is (color1 + color2)/2.",
        accuracy: "For a footprint along the axes the mean is within 1e-5 of the difference of the \
            colours. Held by `nodes/src/tests.rs`.",
        references: "Isserlis 1918, *On a formula for the product-moment coefficient of any order of a \
            normal frequency distribution* (fourth moments from second ones). Heckbert 1989, \
            *Fundamentals of Texture Mapping and Image Warping*, §3.5.8. MaterialX 1.39 \
            specification, node `checkerboard`.",
    },
    inputs: &[
        PortSpec::new(
            "color1",
            PortType::Exactly(Type::Color3),
            Default::Color3([1.0, 1.0, 1.0]),
            "The colour of the square at the origin.",
        ),
        PortSpec::new(
            "color2",
            PortType::Exactly(Type::Color3),
            Default::Color3([0.0, 0.0, 0.0]),
            "The other colour.",
        ),
        PortSpec::new(
            "uvtiling",
            PortType::Exactly(Type::Vector2),
            Default::Vector2([8.0, 8.0]),
            "How many squares a unit of texture space holds.",
        )
        .range(Range::soft(1.0, 64.0))
        .unit("squares per uv"),
        PortSpec::new(
            "uvoffset",
            PortType::Exactly(Type::Vector2),
            Default::Vector2([0.0, 0.0]),
            "The shift, which is subtracted.",
        )
        .range(Range::soft(-1.0, 1.0))
        .unit("squares"),
        PortSpec::new(
            "texcoord",
            PortType::Exactly(Type::Vector2),
            Default::Surface,
            "The coordinates.",
        )
        .unit("uv"),
    ],
    output: OutputType::Exactly(Type::Color3),
    class,
    example: r##"{
  "version": 1,
  "name": "checkerboard_example",
  "nodes": {
    "checkerboard": { "type": "checkerboard", "inputs": { "color1": "#e8c27a", "color2": "#20303c", "uvtiling": [6, 6] } }
  },
  "outputs": { "out": { "node": "checkerboard" } }
}"##,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// A function of position alone, unless a parameter varies.
fn class(inputs: &dyn InputView) -> Behaviour {
    let other = ["color1", "color2", "uvtiling", "uvoffset"];
    if other.into_iter().any(|port| inputs.varies(port)) {
        Behaviour::Function
    } else {
        Behaviour::Pattern
    }
}

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let [texcoord, tiling, offset] =
        ["texcoord", "uvtiling", "uvoffset"].map(|port| lower.bundle(node, port));
    let sign = |lower: &mut Lower<'_>, i: usize| {
        let tiled = product(lower, &texcoord[i], &tiling[i]);
        let tiled = difference(lower, &tiled, &offset[i]);
        let b = lower.b();
        let half = b.f32(0.5);
        let phase = tiled.scale(b, half);
        let wave = transfer(lower, &phase, &SquareWave { width: half });
        // 1 in even squares, −1 in odd ones.
        let b = lower.b();
        let (two, minus) = (b.f32(2.0), b.f32(-1.0));
        wave.scale(b, two).offset(b, minus)
    };
    let (x, y) = (sign(lower, 0), sign(lower, 1));
    let both = product(lower, &x, &y);
    let b = lower.b();
    let half = b.f32(0.5);
    // 1 where the sum of the cells is even.
    let parity = both.scale(b, half).offset(b, half);
    binary(lower, node, ["color1", "color2"], |lower, even, odd| {
        let across = even.sub(lower.b(), odd);
        let part = product(lower, &across, &parity);
        odd.add(lower.b(), &part)
    })
}
