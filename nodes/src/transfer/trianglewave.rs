//! Triangle wave.

use crate::componentwise::{transfer, unary};
use mipless_codegen::moments::LinearWave;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range,
};

static SPEC: NodeSpec = NodeSpec {
    name: "trianglewave",
    aliases: &["triangle", "triangle_wave", "pingpong"],
    category: Category::Transfer,
    summary: "Rises from 0 to 1 and falls back once in every unit.",
    doc: Doc {
        computes: "out = 2|in − ⌊in + ½⌋|, for each component: 0 at whole numbers, 1 halfway between \
            them.",
        statistics: "For σ ≤ 0.2 periods the piecewise function of the corners within reach in closed \
            form, beyond it three harmonics of the Fourier series, damped by e^{−2π²k²v}; the \
            distortion as a sum of squares over the pieces, or from the series of the square. \
            Exact for a Gaussian. Over a large footprint the mean goes to ½ and the variance to \
            1/12.",
        accuracy: "For a Gaussian input the mean is within 4e-6, the remainder’s standard deviation \
            within 1e-3. Held by `codegen/src/moments/tests/waves.rs` against dense numerical \
            integration in f64.",
        references: "The characteristic function of the normal distribution, in *Abramowitz & Stegun* \
            26.2. Bussgang 1952, *Crosscorrelation functions of amplitude-distorted Gaussian \
            signals*; Stein 1981, *Estimation of the mean of a multivariate normal distribution*, \
            lemma 1. MaterialX 1.39 specification, node `trianglewave`.",
    },
    inputs: &[
        PortSpec::new("in", PortType::Any, Default::Float(0.0), "The signal.")
            .range(Range::soft(-1.0, 1.0)),
    ],
    output: OutputType::Widest,
    class: |_| Behaviour::Function,
    example: r#"{
  "version": 1,
  "name": "trianglewave_example",
  "nodes": {
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "six": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 6.3}},
    "trianglewave": {"type": "trianglewave", "inputs": {"in": {"node": "six"}}}
  },
  "outputs": { "out": { "node": "trianglewave" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let wave = LinearWave::triangle();
    unary(lower, node, "in", |lower, x| transfer(lower, x, &wave))
}
