//! Diagonal lines both ways.

use crate::pattern::checkerboard::tiled;
use crate::pattern::grid::{STAGGERED, TEXCOORD, UVOFFSET, UVTILING};
use crate::pattern::pulse::Pulse;
use crate::pattern::separable::{Pattern, Term, Terms, filtered};
use crate::pattern::tiling::{self, hatch};
use crate::pattern::unless::pattern_unless;
use crate::port;
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "crosshatch",
    aliases: &[
        "hatch",
        "hatching",
        "diagonal_grid",
        "lattice_pattern",
        "diamonds",
    ],
    category: Category::Pattern,
    summary: "White lines along both diagonals of square cells on black.",
    doc: Doc {
        computes: "With p = texcoord · uvtiling − uvoffset: 1 where p lies within thickness/2 of a diagonal \
            of its cell, measured in cells, else 0, in each channel. Where the hatch is staggered, the cells \
            of every other row are shifted by half a cell along p₁, so that lines meet in zigzags.",
        statistics: "One less the product of two pulses of p₁ − p₂ and p₁ + p₂ over a Gaussian, in closed \
            form where the two are independent and by a trapezoid rule over what they share where they \
            are not, as in `grid`: exact for any covariance up to 10:1 across a line. Staggered, it is no \
            product of two pulses: footprints whose minor axis is below 0.16 cells and whose major axis is \
            below 1.3 cells sum the exact measures of the diamonds and triangles that the lines leave, \
            all others damp the Fourier series of the lattice by e^{−2π²kᵀΣk}, of which each \
            amplitude is a closed form of the thickness; those that are thinner than 0.08 cells are widened first, \
            gradually from a length of 0.9 cells. Variance P(1 − P). Of a varying thickness the mean is used.",
        accuracy: "The mean is within 1e-3 for footprints of up to 8:1 in any direction. Staggered, it is within \
            1e-4 for round ones, 3e-4 up to 16:1, 3e-3 at 20:1 and, blurred across, 0.12 at 40:1. Held by \
            `nodes/src/pattern/tests.rs` against dense sums and by `nodes/src/pattern/tests/hatch.rs` \
            against integrals.",
        references: "Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8. Trefethen & \
            Weideman 2014, *The Exponentially Convergent Trapezoidal Rule*. Owen 1956, *Tables for Computing \
            Bivariate Normal Probabilities* (measures of polygons). MaterialX 1.39, node `crosshatch` of \
            its standard library.",
    },
    inputs: &[
        TEXCOORD,
        UVTILING,
        UVOFFSET,
        port::number("thickness", 0.05, "The width of a line.")
            .range(Range::hard(0.0, 1.0))
            .unit("cells"),
        STAGGERED,
    ],
    output: OutputType::Exactly(Type::Color3),
    reach: |_| Reach::of(0.0, 1.0),
    class: |inputs| pattern_unless(inputs, &["uvtiling", "uvoffset", "thickness"]),
    example: example! { "crosshatch", r#"
    "crosshatch": { "type": "crosshatch", "inputs": { "uvtiling": [8, 8], "thickness": 0.2 } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let lines = if lower.flag(node, "staggered") {
        staggered(lower, node)
    } else {
        plain(lower, node)
    };
    vec![lines; 3]
}

/// Cells in columns: both coordinates of the diagonals are periodic.
fn plain<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Signal<'b> {
    let [x, y] = tiled(lower, node, [1.0; 2]);
    let thickness = lower.number(node, "thickness");
    // Both coordinates of the diagonals are whole on the lines; a cell across is √2 of theirs.
    let position = [&x - &y, &x + &y];
    let terms = Terms {
        key: "crosshatch".to_owned(),
        of: &|b, parameters| {
            let open = 0.5 - parameters[0] * std::f32::consts::FRAC_1_SQRT_2;
            let pulse = Pulse {
                repeat: 1.0,
                centre: b.float(0.5),
                half: open.max(0.0),
                bevel: b.float(0.0),
                short: true,
            };
            (1.0, vec![Term::product(pulse, pulse).times(-1.0)])
        },
    };
    let pattern = Pattern {
        cell: &terms,
        parameters: vec![thickness.clamp(0.0, 1.0)],
        ramps: None,
    };
    filtered(lower, &position, &pattern)
}

/// Rows of cells that alternate.
fn staggered<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Signal<'b> {
    // Two rows are a unit cell, whose origin is in the middle of the first.
    let [x, y] = tiled(lower, node, [1.0, 0.5]);
    let thickness = lower.number(node, "thickness").clamp(0.0, 1.0);
    tiling::tiled(lower, &[x, y.offset(-0.25)], &hatch::lines(thickness))
}
