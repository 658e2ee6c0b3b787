//! Choice by number.

use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
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
        references: "The truncated normal distribution, in Johnson, Kotz & Balakrishnan 1994, *Continuous \
            Univariate Distributions*, vol. 1, §13.10. Bussgang 1952, *Crosscorrelation functions \
            of amplitude-distorted Gaussian signals*; Stein 1981, *Estimation of the mean of a \
            multivariate normal distribution*, lemma 1. MaterialX 1.39 specification, node \
            `switch`.",
    },
    inputs: &[
        PortSpec::new(
            "in1",
            PortType::Any,
            Default::Float(0.0),
            "The result for 0.",
        ),
        PortSpec::new(
            "in2",
            PortType::Any,
            Default::Float(0.0),
            "The result for 1.",
        ),
        PortSpec::new(
            "in3",
            PortType::Any,
            Default::Float(0.0),
            "The result for 2.",
        ),
        PortSpec::new(
            "in4",
            PortType::Any,
            Default::Float(0.0),
            "The result for 3.",
        ),
        PortSpec::new(
            "in5",
            PortType::Any,
            Default::Float(0.0),
            "The result for 4.",
        ),
        PortSpec::new(
            "in6",
            PortType::Any,
            Default::Float(0.0),
            "The result for 5.",
        ),
        PortSpec::new(
            "in7",
            PortType::Any,
            Default::Float(0.0),
            "The result for 6.",
        ),
        PortSpec::new(
            "in8",
            PortType::Any,
            Default::Float(0.0),
            "The result for 7.",
        ),
        PortSpec::new(
            "in9",
            PortType::Any,
            Default::Float(0.0),
            "The result for 8.",
        ),
        PortSpec::new(
            "in10",
            PortType::Any,
            Default::Float(0.0),
            "The result for 9.",
        ),
        PortSpec::new(
            "which",
            PortType::Exactly(Type::Float),
            Default::Float(0.0),
            "The number that chooses.",
        )
        .range(Range::soft(0.0, 9.0)),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "switch_example",
  "nodes": {
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "noise": {"type": "noise2d", "inputs": {"frequency": 5, "pivot": 0.5}},
    "which": {"type": "multiply", "inputs": {"in1": {"node": "noise"}, "in2": 3}},
    "switch": {"type": "switch", "inputs": {"which": {"node": "which"}, "in1": {"node": "bands"}, "in2": 0.5, "in3": {"node": "noise"}}}
  },
  "outputs": { "out": { "node": "switch" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// The inputs, in order.
const INPUTS: [&str; 10] = [
    "in1", "in2", "in3", "in4", "in5", "in6", "in7", "in8", "in9", "in10",
];

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let which = lower.signal(node, "which");
    let inputs = INPUTS.map(|port| lower.bundle(node, port));
    (0..inputs[0].len())
        .map(|i| {
            // Neighbours that are the same number are one branch: most inputs are not connected.
            let mut thresholds = Vec::new();
            let mut branches = vec![inputs[0][i].clone()];
            for (k, input) in inputs.iter().enumerate().skip(1) {
                let b = lower.b();
                let mut number = |signal: &Signal| {
                    let certain = signal.is_certain(b);
                    b.as_constant(signal.mean).filter(|_| certain)
                };
                let last = branches.last().and_then(&mut number);
                if last.is_none() || last != number(&input[i]) {
                    thresholds.push(k as f32);
                    branches.push(input[i].clone());
                }
            }
            lower.algebra.selection(&which, &thresholds, &branches)
        })
        .collect()
}
