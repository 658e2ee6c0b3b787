//! Squares of two colours.

use crate::pattern::unless::pattern_unless;
use crate::port;
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range, Type,
};

use crate::componentwise::{binary, difference, product};
use crate::pattern::pulse::Pulse;
use crate::pattern::separable::{Pattern, Term, Terms, filtered};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "checkerboard",
    aliases: &["checker", "checker_texture", "checkers", "chess"],
    category: Category::Pattern,
    summary: "A board of squares of two colours.",
    doc: Doc {
        computes: "out = color2 where ⌊u⌋ + ⌊v⌋ is even, else color1, with (u, v) = texcoord · uvtiling \
            − uvoffset. The square at the origin is color2, as in MaterialX.",
        statistics: "The parity is 1 − X − Y + 2XY with X and Y square waves of one coordinate each. \
            Each wave has its closed form (a sum of Φ over the edges up to σ = 0.22 \
            squares, six damped harmonics beyond). Up to a correlation of the coordinates of 1/2 the \
            mean of a product is four terms of Mehler's series; of a larger one a part that both \
            share is integrated by the trapezoid rule, 19 nodes for 8:1 at 45 degrees. Variance P(1 − P). Over a large footprint the mean is (color1 + color2)/2.",
        accuracy: "The mean is within 1e-5 of the difference of the colours for footprints along the \
            axes and within 2e-3 for rotated ones up to 10:1; longer ones are blurred across to \
            10:1. Held by `nodes/src/pattern/tests.rs` against dense sums.",
        references: "Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8. \
            Mehler 1866. Trefethen & Weideman 2014, *The Exponentially Convergent Trapezoidal Rule*. MaterialX \
            1.39, node `checkerboard` of its standard library.",
    },
    inputs: &[
        PortSpec::new(
            "color1",
            PortType::Exactly(Type::Color3),
            Default::Color3([1.0, 1.0, 1.0]),
            "The colour of the squares beside the one at the origin.",
        ),
        PortSpec::new(
            "color2",
            PortType::Exactly(Type::Color3),
            Default::Color3([0.0, 0.0, 0.0]),
            "The colour of the square at the origin.",
        ),
        port::pair(
            "uvtiling",
            [8.0, 8.0],
            "How many squares a unit of texture space holds.",
        )
        .range(Range::soft(1.0, 64.0))
        .unit("squares per uv"),
        port::pair("uvoffset", [0.0, 0.0], "The shift, which is subtracted.")
            .range(Range::soft(-1.0, 1.0))
            .unit("squares"),
        port::surface("The coordinates."),
    ],
    output: OutputType::Exactly(Type::Color3),
    reach: |inputs| inputs.reach("color1").hull(inputs.reach("color2")),
    class: |inputs| pattern_unless(inputs, &["color1", "color2", "uvtiling", "uvoffset"]),
    example: example! { "checkerboard", r##"
    "checkerboard": { "type": "checkerboard", "inputs": { "color1": "#e8c27a", "color2": "#20303c", "uvtiling": [6, 6] } }
"## },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let position = tiled(lower, node, [0.5, 0.5]);
    let terms = Terms {
        key: "checkerboard".to_owned(),
        of: &|b, _| {
            let quarter = b.float(0.25);
            let pulse = Pulse {
                repeat: 1.0,
                centre: quarter,
                half: quarter,
                bevel: b.float(0.0),
                short: true,
            };
            let (x, y) = (Some(pulse), Some(pulse));
            let terms = [(-1.0, x, None), (-1.0, None, y), (2.0, x, y)];
            let terms = terms.map(|(coefficient, x, y)| Term { coefficient, x, y });
            (1.0, terms.to_vec())
        },
    };
    let pattern = Pattern {
        cell: &terms,
        parameters: Vec::new(),
        ramps: None,
    };
    // 1 where the sum of the cells is even.
    let parity = filtered(lower, &position, &pattern);
    binary(lower, node, ["color2", "color1"], |lower, even, odd| {
        odd + product(lower, &(even - odd), &parity)
    })
}

/// (texcoord · uvtiling − uvoffset) · scale.
pub(crate) fn tiled<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    scale: [f32; 2],
) -> [Signal<'b>; 2] {
    let [texcoord, tiling, offset] =
        ["texcoord", "uvtiling", "uvoffset"].map(|port| lower.bundle(node, port));
    [0, 1].map(|i| {
        let tiled = product(lower, &texcoord[i], &tiling[i]);
        difference(&tiled, &offset[i]) * scale[i]
    })
}
