//! Sign.

use crate::componentwise::{transfer, unary};
use crate::port::any;
use mipless_codegen::moments::{Piecewise, Signal};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Range, Reach};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "sign",
    aliases: &["signum", "math_sign"],
    category: Category::Transfer,
    summary: "−1, 0 or 1: on which side of 0 a signal is.",
    doc: Doc {
        computes: "out = 1 where in > 0, −1 where in < 0, 0 where in = 0, for each component.",
        statistics: "A step of height 2: E = 2Φ(z) − 1, z = m/σ; slope 2φ(z)/σ; distortion 4(Φ(z)Φ(−z) − \
            φ(z)²). Exact for a Gaussian.",
        accuracy: "For a Gaussian input the mean is within 2e-6, the remainder’s standard deviation \
            within 2e-4. Held by `codegen/src/moments/tests.rs` against dense numerical \
            integration in f64.",
        references: cite!(bussgang; "sign"),
    },
    inputs: &[any("in", 0.0, "The signal.").range(Range::soft(-1.0, 1.0))],
    output: OutputType::Widest,
    reach: |_| Reach::of(-1.0, 1.0),
    class: |_| Behaviour::Function,
    example: example! { "sign", r#"
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 23}},
    "wave": {"type": "sin", "inputs": {"in": {"node": "turns"}}},
    "sign": {"type": "sign", "inputs": {"in": {"node": "wave"}}}
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let zero = lower.b().float(0.0);
    unary(lower, node, "in", |lower, x| {
        if lower.mode().spreads() && !x.is_certain() {
            return transfer(lower, x, &Piecewise::step(zero).affine(2.0, -1.0));
        }
        let mean = x.flat_mean();
        let sign = mean.gt(0.0).select(1.0, mean.lt(0.0).select(-1.0, 0.0));
        Signal::certain(sign).with_range([-1.0, 1.0])
    })
}
