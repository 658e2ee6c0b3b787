//! Square root.

use crate::componentwise::{transfer, unary};
use crate::port::any;
use mipless_codegen::moments::RealPower;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "sqrt",
    aliases: &["square_root", "math_sqrt"],
    category: Category::Transfer,
    summary: "The square root of a signal.",
    doc: Doc {
        computes: "out = √max(in, 0), for each component.",
        statistics: "The part below 0 in closed form, the part above it by ten-point Gauss–Legendre \
            quadrature of the difference from a line; the distortion as a sum of squares. \
            Approximate. No moment is infinite, since what lies below 0 counts as 0.",
        accuracy: "For a Gaussian input the mean is within 1e-3, the standard deviation within 1e-3. \
            Held by `nodes/src/tests/law.rs` against dense numerical integration in f64.",
        references: cite!(bussgang; "sqrt"),
    },
    inputs: &[any("in", 0.0, "The radicand.")],
    output: OutputType::Widest,
    reach: |inputs| inputs.reach("in").monotone(|x| x.max(0.0).sqrt()),
    class: |_| Behaviour::Function,
    example: example! { "sqrt", r#"
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 25}},
    "wave": {"type": "sin", "inputs": {"in": {"node": "turns"}}},
    "lifted": {"type": "add", "inputs": {"in1": {"node": "wave"}, "in2": 1.2}},
    "sqrt": {"type": "sqrt", "inputs": {"in": {"node": "lifted"}}}
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let power = lower.b().float(0.5);
    unary(lower, node, "in", |lower, x| {
        transfer(lower, x, &RealPower { power })
    })
}
