//! Choice by comparison, equality included.

use crate::arithmetic::condition::CHOICE;
use crate::componentwise::binary;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType};

static SPEC: NodeSpec = NodeSpec {
    name: "ifgreatereq",
    aliases: &["if_greater_equal", "greater_or_equal"],
    category: Category::Arithmetic,
    summary: "One of two signals, by whether a number is at least another.",
    doc: Doc {
        computes: "out = in1 where value1 ≥ value2, else in2.",
        statistics: "Of the interval of value1 − value2 that is chosen: with S the difference and W the \
            branches, mean Σ P_k m_k + cov(S, W_k) φ/σ and so on, the distortion as a sum of \
            squares over the intervals and of the spread between the branches. Exact in mean and \
            variance for jointly Gaussian signals, whatever their covariances.",
        accuracy: "For jointly Gaussian inputs the mean and the standard deviation are those of the \
            function, within 1e-3. Held by `nodes/src/tests/combination.rs` against dense \
            numerical integration in f64.",
        references: "The truncated normal distribution, in Johnson, Kotz & Balakrishnan 1994, *Continuous \
            Univariate Distributions*, vol. 1, §13.10. Bussgang 1952, *Crosscorrelation functions \
            of amplitude-distorted Gaussian signals*; Stein 1981, *Estimation of the mean of a \
            multivariate normal distribution*, lemma 1. MaterialX 1.39 specification, node \
            `ifgreatereq`.",
    },
    inputs: CHOICE,
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "ifgreatereq_example",
  "nodes": {
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "ifgreatereq": {"type": "ifgreatereq", "inputs": {"value1": {"node": "noise"}, "value2": 0.45, "in1": {"node": "bands"}, "in2": 0.2}}
  },
  "outputs": { "out": { "node": "ifgreatereq" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let (first, second) = (lower.signal(node, "value1"), lower.signal(node, "value2"));
    let difference = first.sub(lower.b(), &second);
    let condition = difference;
    binary(lower, node, ["in1", "in2"], |lower, yes, no| {
        let branches = [no.clone(), yes.clone()];
        lower.algebra.selection(&condition, &[0.0], &branches)
    })
}
