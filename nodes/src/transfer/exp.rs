//! Exponential.

use crate::componentwise::{transfer, unary};
use crate::port::any;
use mipless_codegen::moments::Exponential;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Range};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "exp",
    aliases: &["exponential", "math_exp"],
    category: Category::Transfer,
    summary: "e to the power of a signal.",
    doc: Doc {
        computes: "out = e^in, for each component; in is limited to ±80.",
        statistics: "The lognormal distribution: E = M = e^{m + v/2}, slope M, distortion M²(eᵛ − 1 − v). \
            Exact for a Gaussian.",
        accuracy: "For a Gaussian input the mean is within 2e-6 of its value, the remainder’s standard \
            deviation within 2e-4 of e^{m + v}. Held by `codegen/src/moments/tests/curves.rs` \
            against dense numerical integration in f64.",
        references: cite!(
            "Aitchison & Brown 1957, *The Lognormal Distribution*, §2.3.",
            bussgang; "exp"
        ),
    },
    inputs: &[any("in", 0.0, "The exponent.").range(Range::soft(-4.0, 4.0))],
    output: OutputType::Widest,
    reach: |inputs| inputs.reach("in").monotone(f32::exp),
    class: |_| Behaviour::Function,
    example: example! { "exp", r#"
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 25}},
    "wave": {"type": "sin", "inputs": {"in": {"node": "turns"}}},
    "exp": {"type": "exp", "inputs": {"in": {"node": "wave"}}}
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    unary(lower, node, "in", |lower, x| {
        transfer(lower, x, &Exponential)
    })
}
