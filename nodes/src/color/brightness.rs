//! Brightness and contrast.

use crate::componentwise::unary;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "brightness",
    aliases: &["brightness_contrast", "bright_contrast"],
    category: Category::Color,
    summary: "Adds to a signal and stretches it about ½.",
    doc: Doc {
        computes: "out = (in − ½) · contrast + ½ + brightness, for each component; nothing is limited.",
        statistics: "By numbers, linear and exact. Of a varying contrast the mean is used.",
        accuracy: "Exact to rounding. Held by `nodes/src/tests/color.rs` against dense numerical \
            integration in f64.",
        references: "Bruneton & Neyret 2012, *A Survey of Non-linear Pre-filtering Methods for Efficient \
            and Accurate Surface Shading*, §2.2 (linear maps of a mean and a covariance).",
    },
    inputs: &[
        PortSpec::new("in", PortType::Any, Default::Float(0.0), "The signal."),
        PortSpec::new(
            "brightness",
            PortType::Exactly(Type::Float),
            Default::Float(0.0),
            "What is added.",
        )
        .range(Range::soft(-1.0, 1.0)),
        PortSpec::new(
            "contrast",
            PortType::Exactly(Type::Float),
            Default::Float(1.0),
            "The factor.",
        )
        .range(Range::soft(0.0, 4.0)),
    ],
    output: OutputType::Widest,
    class,
    example: r#"{
  "version": 1,
  "name": "brightness_example",
  "nodes": {
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "color": {"type": "combine3", "inputs": {"in1": {"node": "noise"}, "in2": 0.3, "in3": {"node": "bands"}}},
    "brightness": {"type": "brightness", "inputs": {"in": {"node": "color"}, "brightness": 0.1, "contrast": 1.4}}
  },
  "outputs": { "out": { "node": "brightness" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// Linear but for a varying contrast.
fn class(inputs: &dyn InputView) -> Behaviour {
    if inputs.varies("contrast") {
        Behaviour::Function
    } else {
        Behaviour::Linear
    }
}

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let contrast = lower.number(node, "contrast");
    let brightness = lower.signal(node, "brightness");
    unary(lower, node, "in", |lower, x| {
        let b = lower.b();
        let (half, minus) = (b.f32(0.5), b.f32(-0.5));
        let stretched = x.offset(b, minus).scale(b, contrast);
        stretched.offset(b, half).add(b, &brightness)
    })
}
