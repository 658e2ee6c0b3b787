//! Cubic step between two bounds.

use mipless_codegen::moments::Piecewise;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType,
};

use crate::componentwise::{ternary, transfer};

static SPEC: NodeSpec = NodeSpec {
    name: "smoothstep",
    aliases: &["smooth_step", "tones_range", "ease"],
    category: Category::Transfer,
    summary: "Rises from 0 to 1 between two bounds, without kinks.",
    doc: Doc {
        computes: "out = 3t² − 2t³ with t = (in − low)/(high − low) limited to [0, 1], for each \
            component; a step at high where the bounds are closer than 1e-6 or swapped.",
        statistics: "For a Gaussian input: the mean and its derivatives by the truncated moments of the \
            cubic, or by Gauss–Legendre quadrature where the cubic is narrower than 1.2 standard \
            deviations; the distortion as a sum of squares over positive weights. Of low and \
            high the means are used: their own spread is ignored.",
        accuracy: "For a Gaussian input the mean is within 1e-4, the remainder’s standard deviation \
            within 3e-3. Held by `codegen/src/moments/tests.rs` against dense numerical \
            integration in f64.",
        references: "Bussgang 1952, *Crosscorrelation functions of amplitude-distorted Gaussian signals*; \
            Stein 1981, *Estimation of the mean of a multivariate normal distribution*, lemma 1. \
            MaterialX 1.39 specification, node `smoothstep`.",
    },
    inputs: &[
        PortSpec::new("in", PortType::Any, Default::Float(0.0), "The signal."),
        PortSpec::new(
            "low",
            PortType::Any,
            Default::Float(0.0),
            "Where the rise begins.",
        ),
        PortSpec::new(
            "high",
            PortType::Any,
            Default::Float(1.0),
            "Where the rise ends.",
        ),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "smoothstep_example",
  "nodes": {
    "uv": { "type": "texcoord" },
    "u": { "type": "extract", "inputs": { "in": { "node": "uv" }, "index": 0 } },
    "turns": { "type": "multiply", "inputs": { "in1": { "node": "u" }, "in2": 25 } },
    "wave": { "type": "sin", "inputs": { "in": { "node": "turns" } } },
    "smoothstep": { "type": "smoothstep", "inputs": { "in": { "node": "wave" }, "low": -0.2, "high": 0.4 } }
  },
  "outputs": { "out": { "node": "smoothstep" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    ternary(lower, node, ["in", "low", "high"], |lower, x, low, high| {
        let b = lower.b();
        let (low, high) = (low.flat_mean(b), high.flat_mean(b));
        let smooth = Piecewise::smoothstep(b, low, high);
        transfer(lower, x, &smooth)
    })
}
