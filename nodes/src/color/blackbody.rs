//! Colour of heat.

use crate::componentwise::{exposed, transfer};
use mipless_codegen::moments::{Piecewise, Shape, Signal};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
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
        references: "Kim, Kang, Kim & Kwak 2002, US patent 7024034 (cubic splines of the Planckian locus). \
            ITU-R BT.709-6. Bussgang 1952, *Crosscorrelation functions of amplitude-distorted \
            Gaussian signals*; Stein 1981, *Estimation of the mean of a multivariate normal \
            distribution*, lemma 1. MaterialX 1.39 specification, node `blackbody`.",
    },
    inputs: &[PortSpec::new(
        "temperature",
        PortType::Exactly(Type::Float),
        Default::Float(5000.0),
        "The temperature.",
    )
    .unit("kelvin")
    .range(Range::soft(1667.0, 25000.0))],
    output: OutputType::Exactly(Type::Color3),
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "blackbody_example",
  "nodes": {
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "amplitude": 4000, "pivot": 5000}},
    "blackbody": {"type": "blackbody", "inputs": {"temperature": {"node": "noise"}}}
  },
  "outputs": { "out": { "node": "blackbody" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

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

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let kelvin = exposed(lower, node, "temperature");
    // In units in which slopes are neither large nor small.
    let unit = lower.b().f32(1e-3);
    let x = Signal {
        hermite: kelvin[0].hermite,
        ..kelvin[0].scale(lower.b(), unit)
    };
    (0..3)
        .map(|k| {
            let b = lower.b();
            let stops = STOPS.map(|(at, color)| (b.f32(at * 1e-3), b.f32(color[k])));
            let ramp = Piecewise::ramp(b, &stops, Shape::Linear);
            transfer(lower, &x, &ramp)
        })
        .collect()
}
