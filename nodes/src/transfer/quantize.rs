//! Levels of equal height.

use crate::componentwise::unary;
use crate::port::{any, number};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Range, Reach};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "quantize",
    aliases: &["posterize", "snap", "steps"],
    category: Category::Transfer,
    summary: "A signal in steps.",
    doc: Doc {
        computes: "out = ⌊in · steps⌋ / steps, for each component.",
        statistics: "⌊x⌋ is x less its fraction, whose moments are those of `fract`: E[⌊x⌋] = m − E[fract \
            x], slope 1 − α, the same distortion. Exact for a Gaussian, and a position keeps its \
            integer cell. Of varying steps the mean is used. What follows the steps of a coordinate is summed \
            step by step, as after `floor`.",
        accuracy: "For a Gaussian input the mean is within 4e-6, the remainder’s standard deviation \
            within 1e-3 of 1 + σ. Held by `codegen/src/moments/tests/waves.rs` against dense \
            numerical integration in f64.",
        references: cite!(characteristic, bussgang),
    },
    inputs: &[
        any("in", 0.0, "The signal."),
        number("steps", 4.0, "How many levels a unit has.")
            .range(Range::hard(0.001, 1e6).with_soft(1.0, 32.0)),
    ],
    output: OutputType::Widest,
    reach: |inputs| inputs.reach("in") + Reach::of(-1.0, 0.0) / inputs.reach("steps"),
    class: |_| Behaviour::Function,
    example: example! { "quantize", r#"
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 25}},
    "wave": {"type": "sin", "inputs": {"in": {"node": "turns"}}},
    "quantize": {"type": "quantize", "inputs": {"in": {"node": "wave"}, "steps": 5}}
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let steps = lower.number(node, "steps");
    unary(lower, node, "in", |lower, x| {
        lower.algebra.floor(&(x * steps)) * (1.0 / steps)
    })
}
