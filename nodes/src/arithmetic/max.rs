//! Maximum.

use crate::componentwise::{OPERANDS, binary, maximum};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType};

static SPEC: NodeSpec = NodeSpec {
    name: "max",
    aliases: &["maximum", "math_max"],
    category: Category::Arithmetic,
    summary: "The larger of two signals.",
    doc: Doc {
        computes: "out = max(in1, in2), for each component.",
        statistics: "For jointly Gaussian inputs with θ² = Var(in1 − in2) and a = (m₁ − m₂)/θ: E = m₁Φ(a) \
            + m₂Φ(−a) + θφ(a); the coefficients are Φ(a)·in1 + Φ(−a)·in2, and what they leave of \
            the variance, θ²d(a) with d(a) = (a² + 1)Φ(a)Φ(−a) − |a|φ(a)|Φ(a) − Φ(−a)| − φ(a)², \
            joins an uncorrelated remainder. Exact in mean, variance and covariance with \
            Gaussians.",
        accuracy: "For Gaussian inputs the mean is within 1e-6 θ (the error of the normal distribution \
            function); for others the error follows their distance from a Gaussian. Held by \
            `nodes/src/tests.rs`.",
        references: "Clark 1961, *The Greatest of a Finite Set of Random Variables*, eqs. 2 and 4–6. \
            MaterialX 1.39 specification, node `max`.",
    },
    inputs: OPERANDS,
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "max_example",
  "nodes": {
    "bands": { "type": "stripes", "inputs": { "frequency": 6 } },
    "across": { "type": "stripes", "inputs": { "frequency": 4, "rotate": 90 } },
    "max": { "type": "max", "inputs": { "in1": { "node": "bands" }, "in2": { "node": "across" } } }
  },
  "outputs": { "out": { "node": "max" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    binary(lower, node, ["in1", "in2"], maximum)
}
