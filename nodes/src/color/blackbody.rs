//! Colour of heat.

use crate::componentwise::{exposed, transfer};
use crate::port::number;
use mipless_codegen::moments::{Piecewise, Shape, Signal};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "blackbody",
    aliases: &["black_body", "temperature_to_color"],
    category: Category::Color,
    summary: "The colour of a body that glows at a temperature.",
    doc: Doc {
        computes: "out = the chromaticity of the Planckian locus at the temperature, limited to [1667, \
            25000] K, as linear Rec. 709 of luminance 1, by straight lines between twelve \
            temperatures; what is negative is 0.",
        statistics: "Each channel is a piecewise linear function in closed form. Exact for a Gaussian. The \
            channels share their second Hermite part.",
        accuracy: "At a point within 0.015 (red), 0.004 (green), 0.03 (blue) of the cubic formulas of \
            Kim et al., whose values reach 3; filtered, within 1e-5 of the piecewise function. \
            Held by `nodes/src/tests/color.rs` against dense numerical integration in f64.",
        references: cite!(
            "Kim, Kang, Kim & Kwak 2002, US patent 7024034 (cubic splines of the Planckian \
             locus). ITU-R BT.709-6.",
            bussgang; "blackbody"
        ),
    },
    inputs: &[number("temperature", 5000.0, "The temperature.")
        .unit("kelvin")
        .range(Range::soft(1667.0, 25000.0))],
    output: OutputType::Exactly(Type::Color3),
    reach: |_| Reach::ANY,
    class: |_| Behaviour::Function,
    example: example! { "blackbody", r#"
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "amplitude": 4000, "pivot": 5000}},
    "blackbody": {"type": "blackbody", "inputs": {"temperature": {"node": "noise"}}}
"# },
};

/// Kelvin and the linear Rec. 709 colour there.
const STOPS: [(f32, [f32; 3]); 12] = [
    (1667.0, [2.964_11, 0.520_95, 0.0]),
    (1905.0, [2.636_69, 0.614_17, 0.000_31]),
    (2222.0, [2.291_58, 0.709_66, 0.071_04]),
    (2600.0, [1.993_04, 0.788_79, 0.166_69]),
    (3100.0, [1.720_24, 0.856_53, 0.299_26]),
    (3800.0, [1.469_27, 0.912_66, 0.482_62]),
    (4800.0, [1.244_87, 0.955_41, 0.720_32]),
    (6000.0, [1.087_77, 0.978_62, 0.953_19]),
    (7800.0, [0.957_5, 0.991_09, 1.213_51]),
    (10_500.0, [0.859_17, 0.994_54, 1.469_08]),
    (15_000.0, [0.785_32, 0.992_55, 1.706_44]),
    (25_000.0, [0.727_31, 0.987_5, 1.927_4]),
];

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let kelvin = exposed(lower, node, "temperature");
    // In units in which slopes are neither large nor small.
    let x = Signal {
        hermite: kelvin[0].hermite,
        ..&kelvin[0] * 1e-3
    };
    let b = lower.b();
    let channel = |k: usize| {
        let stops = STOPS.map(|(at, color)| (b.float(at * 1e-3), b.float(color[k])));
        transfer(lower, &x, &Piecewise::ramp(&stops, Shape::Linear))
    };
    (0..3).map(channel).collect()
}
