//! Threshold.

use crate::componentwise::{binary, difference, transfer};
use crate::port::any;
use mipless_codegen::moments::Piecewise;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Range, Reach};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "step",
    aliases: &["threshold", "tones_step", "histogram_scan", "greater_than"],
    category: Category::Transfer,
    summary: "1 where a signal reaches an edge, else 0.",
    doc: Doc {
        computes: "out = 1 where in ≥ edge, else 0, for each component.",
        statistics: "With m and σ the mean and standard deviation of in − edge, and z = m/σ: E = Φ(z), \
            slope φ(z)/σ, distortion Φ(z)Φ(−z) − φ(z)². Exact for a Gaussian in − edge, whether \
            the edge varies or not.",
        accuracy: "For a Gaussian input the mean is within 6e-7 (Abramowitz & Stegun 7.1.26). For a \
            noise the error is the distance of its distribution from a Gaussian, which its page \
            states. Held by `codegen/src/moments/tests.rs` against dense numerical integration \
            in f64.",
        references: cite!(bussgang, color_mapped),
    },
    inputs: &[
        any("in", 0.0, "The signal.").range(Range::soft(-1.0, 1.0)),
        any("edge", 0.0, "Where the result becomes 1.").range(Range::soft(-1.0, 1.0)),
    ],
    output: OutputType::Widest,
    reach: |_| Reach::of(0.0, 1.0),
    class: |_| Behaviour::Function,
    example: example! { "step", r#"
    "uv": { "type": "texcoord" },
    "u": { "type": "extract", "inputs": { "in": { "node": "uv" }, "index": 0 } },
    "turns": { "type": "multiply", "inputs": { "in1": { "node": "u" }, "in2": 25 } },
    "wave": { "type": "sin", "inputs": { "in": { "node": "turns" } } },
    "step": { "type": "step", "inputs": { "in": { "node": "wave" }, "edge": 0.3 } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let zero = lower.b().float(0.0);
    binary(lower, node, ["in", "edge"], |lower, x, edge| {
        // The difference is small where it matters: a position keeps its detail far from 0.
        transfer(lower, &difference(x, edge), &Piecewise::step(zero))
    })
}
