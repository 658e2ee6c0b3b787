//! Choice by number.

use crate::port::{any, number};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Range, Reach};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "switch",
    aliases: &["select", "selector"],
    category: Category::Arithmetic,
    summary: "One of up to ten signals, by a number.",
    doc: Doc {
        computes: "out = in1 where which < 1, in2 from 1, in3 from 2 and so on; in10 from there on.",
        statistics: "Of the interval of which that is chosen: with S the difference and W the branches, \
            mean Σ P_k m_k + cov(S, W_k) φ/σ and so on, the distortion as a sum of squares over \
            the intervals and of the spread between the branches. Exact in mean and variance for \
            jointly Gaussian signals, whatever their covariances.",
        accuracy: "For jointly Gaussian inputs the mean and the standard deviation are those of the \
            function, within 1e-3. Held by `nodes/src/tests/combination.rs` against dense \
            numerical integration in f64.",
        references: cite!(truncated, bussgang; "switch"),
    },
    inputs: &[
        any("in1", 0.0, "The result for 0."),
        any("in2", 0.0, "The result for 1."),
        any("in3", 0.0, "The result for 2."),
        any("in4", 0.0, "The result for 3."),
        any("in5", 0.0, "The result for 4."),
        any("in6", 0.0, "The result for 5."),
        any("in7", 0.0, "The result for 6."),
        any("in8", 0.0, "The result for 7."),
        any("in9", 0.0, "The result for 8."),
        any("in10", 0.0, "The result for 9."),
        number("which", 0.0, "The number that chooses.").range(Range::soft(0.0, 9.0)),
    ],
    output: OutputType::Widest,
    reach: |inputs| {
        let choices = SPEC.inputs.iter().filter(|port| port.name != "which");
        let reaches = choices.map(|port| inputs.reach(port.name));
        reaches.reduce(Reach::hull).unwrap_or(Reach::ANY)
    },
    class: |_| Behaviour::Function,
    example: example! { "switch", r#"
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "which": {"type": "multiply", "inputs": {"in1": {"node": "noise"}, "in2": 3}},
    "switch": {"type": "switch", "inputs": {"which": {"node": "which"}, "in1": {"node": "bands"}, "in2": 0.5, "in3": {"node": "noise"}}}
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let which = lower.signal(node, "which");
    let inputs: Vec<Bundle<'b>> = (SPEC.inputs.iter())
        .filter(|port| port.name != "which")
        .map(|port| lower.bundle(node, port.name))
        .collect();
    let number = |signal: &Signal<'b>| signal.mean.as_constant().filter(|_| signal.is_certain());
    (0..inputs[0].len())
        .map(|i| {
            // Neighbours that are the same number are one branch: most inputs are not connected.
            let mut thresholds = Vec::new();
            let mut branches = vec![inputs[0][i].clone()];
            for (k, input) in inputs.iter().enumerate().skip(1) {
                let last = branches.last().and_then(number);
                if last.is_none() || last != number(&input[i]) {
                    thresholds.push(k as f32);
                    branches.push(input[i].clone());
                }
            }
            lower.algebra.selection(&which, &thresholds, &branches)
        })
        .collect()
}
