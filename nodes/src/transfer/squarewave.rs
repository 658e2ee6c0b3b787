//! Square wave.

use crate::componentwise::{transfer, unary};
use crate::port::{any, number};
use mipless_codegen::moments::SquareWave;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Range, Reach};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "squarewave",
    aliases: &["square_wave", "pulse", "pulse_wave"],
    category: Category::Transfer,
    summary: "1 over a share of every unit, else 0.",
    doc: Doc {
        computes: "out = 1 where the fraction of in is below width, else 0, for each component.",
        statistics: "For σ ≤ 0.11 periods Φ at the nearest two edges, beyond it six harmonics \
            of the Fourier series, damped by e^{−2π²k²v}; the variance is P(1 − P). Exact for a \
            Gaussian. Over a large footprint the mean goes to width. Of a varying width the mean \
            is used.",
        accuracy: "For a Gaussian input the mean is within 5e-6, the remainder’s standard deviation \
            within 2e-3. Held by `codegen/src/moments/tests.rs` against dense numerical \
            integration in f64.",
        references: cite!(characteristic, bussgang),
    },
    inputs: &[
        any("in", 0.0, "The signal.").range(Range::soft(-1.0, 1.0)),
        number("width", 0.5, "The share of a unit that is 1.").range(Range::hard(0.0, 1.0)),
    ],
    output: OutputType::Widest,
    reach: |_| Reach::of(0.0, 1.0),
    class: |_| Behaviour::Function,
    example: example! { "squarewave", r#"
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "six": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 6.3}},
    "squarewave": {"type": "squarewave", "inputs": {"in": {"node": "six"}, "width": 0.3}}
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let width = lower.number(node, "width");
    unary(lower, node, "in", |lower, x| {
        transfer(lower, x, &SquareWave { width })
    })
}
