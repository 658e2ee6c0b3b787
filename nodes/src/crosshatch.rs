//! Diagonal lines both ways.

use crate::checkerboard::tiled;
use crate::grid::{TEXCOORD, UVOFFSET, UVTILING};
use crate::pattern::pulse::Pulse;
use crate::pattern::separable::{Pattern, Term, Terms, filtered};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
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
            of its cell, measured in cells, else 0, in each channel. MaterialX's `staggered`, which shifts \
            every other row by half a cell, is not offered: its zigzags are no product of two waves.",
        statistics: "One less the product of two pulses of p₁ − p₂ and p₁ + p₂ over a Gaussian, in closed \
            form where the two are independent and by a trapezoid rule over what they share where they \
            are not, as in `grid`: exact for any covariance up to 10:1 across a line. Variance P(1 − P). \
            Of a varying thickness the mean is used.",
        accuracy: "The mean is within 1e-3 for footprints of up to 8:1 in any direction. Held by \
            `nodes/src/pattern/tests.rs` against dense sums.",
        references: "Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8. Trefethen & \
            Weideman 2014, *The Exponentially Convergent Trapezoidal Rule*. MaterialX 1.39, node \
            `crosshatch` of its standard library.",
    },
    inputs: &[
        TEXCOORD,
        UVTILING,
        UVOFFSET,
        PortSpec::new(
            "thickness",
            PortType::Exactly(Type::Float),
            Default::Float(0.05),
            "The width of a line.",
        )
        .range(Range::hard(0.0, 1.0))
        .unit("cells"),
    ],
    output: OutputType::Exactly(Type::Color3),
    class,
    example: r#"{
  "version": 1,
  "name": "crosshatch_example",
  "nodes": {
    "crosshatch": { "type": "crosshatch", "inputs": { "uvtiling": [8, 8], "thickness": 0.2 } }
  },
  "outputs": { "out": { "node": "crosshatch" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// A function of position alone, unless a parameter varies.
fn class(inputs: &dyn InputView) -> Behaviour {
    if ["uvtiling", "uvoffset", "thickness"]
        .into_iter()
        .any(|port| inputs.varies(port))
    {
        Behaviour::Function
    } else {
        Behaviour::Pattern
    }
}

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let [x, y] = tiled(lower, node, [1.0; 2]);
    let thickness = lower.number(node, "thickness");
    let b = lower.b();
    // Both coordinates of the diagonals are whole on the lines; a cell across is √2 of theirs.
    let position = [x.sub(b, &y), x.add(b, &y)];
    let thickness = b.clamp(thickness, 0.0, 1.0);
    let terms = Terms {
        key: "crosshatch".to_owned(),
        of: &|b, parameters| {
            let reach = b.scale(parameters[0], std::f32::consts::FRAC_1_SQRT_2);
            let half = b.f32(0.5);
            let open = b.sub(half, reach);
            let zero = b.f32(0.0);
            let pulse = Pulse {
                repeat: 1.0,
                centre: half,
                half: b.max(open, zero),
                bevel: zero,
                short: true,
            };
            (1.0, vec![Term::product(pulse, pulse).times(-1.0)])
        },
    };
    let pattern = Pattern {
        cell: &terms,
        parameters: vec![thickness],
        ramps: None,
    };
    let lines = filtered(lower, &position, &pattern);
    vec![lines; 3]
}
