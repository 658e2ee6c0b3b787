//! A colour from hue, saturation, value.

use crate::color::hsv::ABSENCE;
use crate::componentwise::{composed, exposed, product, transfer};
use mipless_codegen::moments::{LinearWave, Signal};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "hsvtorgb",
    aliases: &["hsv_to_rgb", "combine_hsv"],
    category: Category::Color,
    summary: "The colour of a hue, a saturation and a value.",
    doc: Doc {
        computes: "For each channel v (1 − s w(h − k)), k = 0, ⅓, ⅔, where the wave w of period 1 is 0 \
            within a sixth of a turn, 1 beyond a third, and straight between. The hue is in \
            turns; the colour is linear Rec. 709.",
        statistics: "The three waves as `trianglewave`: the piecewise function of the corners within \
            reach, or three damped harmonics; the products with the covariance that hue, \
            saturation and value have. A hue that turns fully gives the mean of all hues. Exact \
            in mean for independent Gaussian inputs; else third moments between them are left \
            out.",
        accuracy: "For jointly Gaussian inputs with spreads up to 0.2 the mean is within 5e-3 and the \
            standard deviation within 0.02. Held by `nodes/src/tests/color.rs` against dense \
            numerical integration in f64.",
        references: "Smith 1978, *Color Gamut Transform Pairs* (the hexcone). The characteristic function \
            of the normal distribution, in *Abramowitz & Stegun* 26.2. Isserlis 1918, *On a \
            formula for the product-moment coefficient of any order of a normal frequency \
            distribution* (fourth moments from second ones). MaterialX 1.39 specification, node \
            `hsvtorgb`.",
    },
    inputs: &[PortSpec::new(
        "in",
        PortType::Exactly(Type::Color3),
        Default::Float(0.0),
        "Hue in turns, saturation and value.",
    )],
    output: OutputType::Exactly(Type::Color3),
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "hsvtorgb_example",
  "nodes": {
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "other": {"type": "noise2d", "inputs": {"frequency": 4, "pivot": 0.4, "seed": 3}},
    "color": {"type": "combine3", "inputs": {"in1": {"node": "noise"}, "in2": 0.25, "in3": {"node": "other"}}},
    "hsvtorgb": {"type": "hsvtorgb", "inputs": {"in": {"node": "color"}}}
  },
  "outputs": { "out": { "node": "hsvtorgb" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let hsv = exposed(lower, node, "in");
    composed(lower, |lower| {
        let chroma = product(lower, &hsv[1], &hsv[2]);
        let wave = LinearWave::through(&ABSENCE);
        [0.0, -1.0 / 3.0, -2.0 / 3.0]
            .map(|turn| {
                let turn = lower.b().f32(turn);
                // The shifted hue is the same signal: it keeps its second Hermite polynomial.
                let hue = Signal {
                    hermite: hsv[0].hermite,
                    ..hsv[0].offset(lower.b(), turn)
                };
                let absence = transfer(lower, &hue, &wave);
                let part = product(lower, &chroma, &absence);
                hsv[2].sub(lower.b(), &part)
            })
            .to_vec()
    })
}
