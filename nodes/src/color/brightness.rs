//! Brightness and contrast.

use crate::componentwise::unary;
use crate::port::{any, number};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType, Range, Reach,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "brightness",
    aliases: &["brightness_contrast", "bright_contrast"],
    category: Category::Color,
    summary: "Adds to a signal and stretches it about ½.",
    doc: Doc {
        computes: "out = (in − ½) · contrast + ½ + brightness, for each component; nothing is limited.",
        statistics: "By numbers, linear and exact. Of a varying contrast the mean is used.",
        accuracy: "Exact to rounding. Held by `nodes/src/tests/color.rs` against dense numerical \
            integration in f64.",
        references: cite!(linear),
    },
    inputs: &[
        any("in", 0.0, "The signal."),
        number("brightness", 0.0, "What is added.").range(Range::soft(-1.0, 1.0)),
        number("contrast", 1.0, "The factor.").range(Range::soft(0.0, 4.0)),
    ],
    output: OutputType::Widest,
    reach: |_| Reach::ANY,
    class,
    example: example! { "brightness", r#"
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "color": {"type": "combine3", "inputs": {"in1": {"node": "noise"}, "in2": 0.3, "in3": {"node": "bands"}}},
    "brightness": {"type": "brightness", "inputs": {"in": {"node": "color"}, "brightness": 0.1, "contrast": 1.4}}
"# },
};

/// Linear but for a varying contrast.
fn class(inputs: &dyn InputView) -> Behaviour {
    if inputs.varies("contrast") {
        Behaviour::Function
    } else {
        Behaviour::Linear
    }
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let contrast = lower.number(node, "contrast");
    let brightness = lower.signal(node, "brightness");
    unary(lower, node, "in", |_, x| {
        (x.offset(-0.5) * contrast).offset(0.5) + &brightness
    })
}
