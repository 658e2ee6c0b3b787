//! A colour from hue, saturation, value.

use crate::color::hsv::ABSENCE;
use crate::componentwise::{composed, exposed, product, transfer};
use mipless_codegen::moments::{LinearWave, Piecewise, Signal};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Reach,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "hsvtorgb",
    aliases: &["hsv_to_rgb", "combine_hsv"],
    category: Category::Color,
    summary: "The colour of a hue, a saturation and a value.",
    doc: Doc {
        computes: "For each channel v (1 − s w(h − k)), k = 0, ⅓, ⅔, where the wave w of period 1 is 0 \
            within a sixth of a turn, 1 beyond a third, and straight between. The hue is in \
            turns; the colour is linear Rec. 709. A saturation below 0 counts as 0; an alpha is kept.",
        statistics: "The three waves as `trianglewave`: the piecewise function of the corners within \
            reach, or three damped harmonics; the products with the covariance that hue, \
            saturation and value have. A hue that turns fully gives the mean of all hues. Exact \
            in mean for independent Gaussian inputs; else third moments between them are left \
            out.",
        accuracy: "For jointly Gaussian inputs with spreads up to 0.2 the mean is within 5e-3 and the \
            standard deviation within 0.02. Held by `nodes/src/tests/color.rs` against dense \
            numerical integration in f64.",
        references: cite!(hexcone, characteristic, isserlis; "hsvtorgb"),
    },
    inputs: &[PortSpec::new(
        "in",
        PortType::Color,
        Default::Color3([0.0; 3]),
        "Hue in turns, saturation and value.",
    )],
    output: OutputType::Colored,
    reach: |_| Reach::ANY,
    class: |_| Behaviour::Function,
    example: example! { "hsvtorgb", r#"
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "other": {"type": "noise2d", "inputs": {"frequency": 4, "pivot": 0.4, "seed": 3}},
    "color": {"type": "combine3", "inputs": {"in1": {"node": "noise"}, "in2": 0.25, "in3": {"node": "other"}}},
    "hsvtorgb": {"type": "hsvtorgb", "inputs": {"in": {"node": "color"}}}
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let mut hsv = exposed(lower, node, "in");
    let alpha = hsv.split_off(3);
    composed(lower, |lower| {
        if hsv[1].range[0] < 0.0 {
            let hinge = Piecewise::hinge(lower.b());
            hsv[1] = transfer(lower, &hsv[1], &hinge);
        }
        let chroma = product(lower, &hsv[1], &hsv[2]);
        let wave = LinearWave::through(&ABSENCE);
        let channel = |turn: f32| {
            // The shifted hue is the same signal: it keeps its second Hermite polynomial.
            let hue = Signal {
                hermite: hsv[0].hermite,
                ..hsv[0].offset(turn)
            };
            let absence = transfer(lower, &hue, &wave);
            &hsv[2] - product(lower, &chroma, &absence)
        };
        let mut out = [0.0, -1.0 / 3.0, -2.0 / 3.0].map(channel).to_vec();
        out.extend(alpha);
        out
    })
}
