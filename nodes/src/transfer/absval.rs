//! Magnitude.

use crate::componentwise::{transfer, unary};
use crate::port::any;
use mipless_codegen::moments::Piecewise;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Interval, Node, NodeSpec, OutputType, Range};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "absval",
    aliases: &["abs", "absolute", "folds"],
    category: Category::Transfer,
    summary: "The magnitude of a signal.",
    doc: Doc {
        computes: "out = |in|, for each component.",
        statistics: "The folded normal distribution: E = m(Φ(z) − Φ(−z)) + 2σφ(z), z = m/σ; slope Φ(z) − \
            Φ(−z); distortion 4σ²d(z) with d(z) = (z² + 1)Φ(z)Φ(−z) − |z|φ(z)|Φ(z) − Φ(−z)| − \
            φ(z)². Exact for a Gaussian.",
        accuracy: "For a Gaussian input the mean is within 2e-6 σ. Held by \
            `codegen/src/moments/tests.rs` against dense numerical integration in f64.",
        references: cite!(folded, bussgang; "absval"),
    },
    inputs: &[any("in", 0.0, "The signal.").range(Range::soft(-1.0, 1.0))],
    output: OutputType::Widest,
    reach: |inputs| inputs.reach("in").map(Interval::abs),
    class: |_| Behaviour::Function,
    example: example! { "absval", r#"
    "uv": { "type": "texcoord" },
    "u": { "type": "extract", "inputs": { "in": { "node": "uv" }, "index": 0 } },
    "turns": { "type": "multiply", "inputs": { "in1": { "node": "u" }, "in2": 25 } },
    "wave": { "type": "sin", "inputs": { "in": { "node": "turns" } } },
    "absval": { "type": "absval", "inputs": { "in": { "node": "wave" } } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let absolute = Piecewise::absolute(lower.b());
    unary(lower, node, "in", |lower, x| transfer(lower, x, &absolute))
}
