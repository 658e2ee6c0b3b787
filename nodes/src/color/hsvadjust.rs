//! Change of hue, saturation, value.

use crate::color::hsv::adjusted;
use crate::color::luminance::COLOR;
use crate::componentwise::{exposed, numbers};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Reach, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "hsvadjust",
    aliases: &["adjust_hsv", "hue_saturation", "hsv"],
    category: Category::Color,
    summary: "Turns the hue of a colour and scales its saturation and value.",
    doc: Doc {
        computes: "out = the colour of (h + amount₁, s · amount₂, v · amount₃), as in `rgbtohsv` and \
            `hsvtorgb`; nothing is limited, and an alpha is kept.",
        statistics: "Where the first amount is the number 0, amount₃ (M + amount₂ (in − M)) with M the \
            largest channel, by Clark’s moments: a sum with the covariance that its terms have. \
            Else: By a cubature of degree 5 over the joint Gaussian of the three channels, \
            thirteen evaluations with positive weights: the mean, the slope by each channel, and \
            the rest as a sum of squares. Approximate: the function bends where two channels are \
            equal. Of varying amounts the means are used.",
        accuracy: "Without a change of hue the mean is within 0.002 and the standard deviation within \
            0.01. With one, for a colour whose channels lie at least four standard deviations \
            apart, within 1e-3; where their order changes within the footprint the mean is within \
            0.02 and the standard deviation within 0.02. Held by `nodes/src/tests/color.rs` \
            against dense numerical integration in f64.",
        references: cite!(hexcone, stroud, clark; "hsvadjust"),
    },
    inputs: &[
        COLOR,
        PortSpec::new(
            "amount",
            PortType::Exactly(Type::Vector3),
            Default::Color3([0.0, 1.0, 1.0]),
            "Turns to add to the hue; factors of saturation and value.",
        ),
    ],
    output: OutputType::Colored,
    reach: |_| Reach::ANY,
    class: |_| Behaviour::Function,
    example: example! { "hsvadjust", r#"
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "other": {"type": "noise2d", "inputs": {"frequency": 4, "pivot": 0.4, "seed": 3}},
    "color": {"type": "combine3", "inputs": {"in1": {"node": "noise"}, "in2": 0.25, "in3": {"node": "other"}}},
    "hsvadjust": {"type": "hsvadjust", "inputs": {"in": {"node": "color"}, "amount": [0.2, 0.8, 1.1]}}
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let mut color = exposed(lower, node, "in");
    let alpha = color.split_off(3);
    let amounts = numbers(lower, node, "amount");
    let mut out = adjusted(lower, &color, [amounts[0], amounts[1], amounts[2]]);
    out.extend(alpha);
    out
}
