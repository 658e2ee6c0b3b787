//! Limiting to an interval.

use crate::componentwise::{ternary, transfer};
use crate::port::any;
use mipless_codegen::moments::Piecewise;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "clamp",
    aliases: &["limit", "saturate01", "math_clamp"],
    category: Category::Transfer,
    summary: "Limits a signal to an interval.",
    doc: Doc {
        computes: "out = max(min(in, high), low), for each component: low where the bounds are swapped.",
        statistics: "For a Gaussian input with mean m and standard deviation σ, and constant bounds: E = \
            low + h(low) − h(high) with h(t) = σ(zΦ(z) + φ(z)), z = (m − t)/σ; slope Φ(z_low) − \
            Φ(z_high); the distortion as a sum of squares over the three pieces. Exact. Bounds \
            that vary are limits by `min` and `max` (Clark 1961): each exact for Gaussians, the \
            second one approximate because the first result is not Gaussian.",
        accuracy: "For a Gaussian input the mean is within 1e-5 of the interval, the remainder’s \
            standard deviation within 1e-4 of it. Held by `codegen/src/moments/tests.rs` against \
            dense numerical integration in f64.",
        references: cite!(
            bussgang,
            "Clark 1961, *The Greatest of a Finite Set of Random Variables*, eqs. 2 and 4–6."; "clamp"
        ),
    },
    inputs: &[
        any("in", 0.0, "The signal."),
        any("low", 0.0, "The least result."),
        any("high", 1.0, "The largest result."),
    ],
    output: OutputType::Widest,
    reach: |inputs| (inputs.reach("in").min(inputs.reach("high"))).max(inputs.reach("low")),
    class: |_| Behaviour::Function,
    example: example! { "clamp", r#"
    "uv": { "type": "texcoord" },
    "u": { "type": "extract", "inputs": { "in": { "node": "uv" }, "index": 0 } },
    "turns": { "type": "multiply", "inputs": { "in1": { "node": "u" }, "in2": 25 } },
    "wave": { "type": "sin", "inputs": { "in": { "node": "turns" } } },
    "clamp": { "type": "clamp", "inputs": { "in": { "node": "wave" }, "low": -0.3, "high": 0.6 } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    ternary(lower, node, ["in", "low", "high"], |lower, x, low, high| {
        if low.is_certain() && high.is_certain() {
            let clamp = Piecewise::clamp(low.flat_mean(), high.flat_mean());
            return transfer(lower, x, &clamp);
        }
        // In the order of the piecewise function: low wins where the bounds are swapped.
        let below = lower.algebra.minimum(x, high);
        lower.algebra.maximum(&below, low)
    })
}
