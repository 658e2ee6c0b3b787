//! Natural logarithm.

use crate::componentwise::{transfer, unary};
use crate::port::any;
use mipless_codegen::ir::Float;
use mipless_codegen::moments::Curve;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType, Range};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "ln",
    aliases: &["log", "logarithm", "math_log"],
    category: Category::Transfer,
    summary: "The natural logarithm of a signal.",
    doc: Doc {
        computes: "out = ln max(in, 0.001), for each component: the limit keeps the moments finite.",
        statistics: "The part below 0.001 in closed form, the part above it by ten-point Gauss–Legendre \
            quadrature of the difference from a line; the distortion as a sum of squares. \
            Approximate near the pole.",
        accuracy: "For a Gaussian input at least four standard deviations above 0, the mean and the \
            standard deviation are within 5e-4; nearer, both are within 0.02 of values that reach \
            from −6.9 up. Held by `nodes/src/tests/law.rs` against dense numerical integration in \
            f64.",
        references: cite!(bussgang; "ln"),
    },
    inputs: &[any("in", 1.0, "The number.").range(Range::soft(0.0, 4.0))],
    output: OutputType::Widest,
    reach: |inputs| inputs.reach("in").monotone(|x| x.max(LEAST).ln()),
    class,
    example: example! { "ln", r#"
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 25}},
    "wave": {"type": "sin", "inputs": {"in": {"node": "turns"}}},
    "lifted": {"type": "add", "inputs": {"in1": {"node": "wave"}, "in2": 1.5}},
    "ln": {"type": "ln", "inputs": {"in": {"node": "lifted"}}}
"# },
};

/// The logarithm itself has no moments near 0.
fn class(inputs: &dyn InputView) -> Behaviour {
    if inputs.varies("in") && inputs.reach("in").0.iter().any(|x| x.low < LEAST) {
        Behaviour::NoMoments {
            port: "in",
            reason: "what lies below 0.001 counts as that: the logarithm goes to −∞ there",
        }
    } else {
        Behaviour::Function
    }
}

/// What lies below counts as this.
const LEAST: f32 = 1e-3;

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let least = lower.b().float(LEAST);
    let logarithm = Curve {
        function: limited_logarithm,
        kinks: vec![least],
        flat: [Some(least.ln()), None],
        range: [LEAST.ln(), f32::INFINITY],
    };
    unary(lower, node, "in", |lower, x| transfer(lower, x, &logarithm))
}

fn limited_logarithm(x: Float<'_>) -> Float<'_> {
    x.max(LEAST).ln()
}
