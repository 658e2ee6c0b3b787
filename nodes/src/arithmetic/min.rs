//! Minimum.

use crate::componentwise::{OPERANDS, binary, minimum};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType};

static SPEC: NodeSpec = NodeSpec {
    name: "min",
    aliases: &["minimum", "math_min"],
    category: Category::Arithmetic,
    summary: "The smaller of two signals.",
    doc: Doc {
        computes: "out = min(in1, in2), for each component.",
        statistics: "min(x, y) = −max(−x, −y): for jointly Gaussian inputs with θ² = Var(in1 − in2) and a \
            = (m₁ − m₂)/θ, E = m₁Φ(−a) + m₂Φ(a) − θφ(a); the coefficients are Φ(−a)·in1 + \
            Φ(a)·in2. Exact in mean, variance and covariance with Gaussians.",
        accuracy: "For Gaussian inputs the mean is within 1e-6 θ (the error of the normal distribution \
            function); for others the error follows their distance from a Gaussian. Held by \
            `nodes/src/tests.rs`.",
        references: "Clark 1961, *The Greatest of a Finite Set of Random Variables*, eqs. 2 and 4–6. \
            MaterialX 1.39 specification, node `min`.",
    },
    inputs: OPERANDS,
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "min_example",
  "nodes": {
    "bands": { "type": "stripes", "inputs": { "frequency": 6 } },
    "across": { "type": "stripes", "inputs": { "frequency": 4, "rotate": 90 } },
    "min": { "type": "min", "inputs": { "in1": { "node": "bands" }, "in2": { "node": "across" } } }
  },
  "outputs": { "out": { "node": "min" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    binary(lower, node, ["in1", "in2"], minimum)
}
