//! Remainder.

use crate::componentwise::{binary, composed, product, quotient, transfer};
use crate::port::any;
use mipless_codegen::moments::LinearWave;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Range, Reach};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "modulo",
    aliases: &["mod", "fmod", "math_modulo", "wrap"],
    category: Category::Transfer,
    summary: "What a division leaves over.",
    doc: Doc {
        computes: "out = in1 − in2 ⌊in1 / in2⌋, for each component: it has the sign of in2. A divisor \
            nearer to 0 than 1e-6 is moved to ±1e-6.",
        statistics: "in2 times the fraction of in1/in2. By a number, exact for a Gaussian, as `fract`. By \
            a varying signal, the quotient as `divide`, taken for a Gaussian, and a product: \
            approximate.",
        accuracy: "By a number, the mean is within 4e-6 of in2. By a varying signal with a spread of a \
            tenth of its mean: see `nodes/src/tests/law.rs`, which holds the mean within 0.01 and \
            the standard deviation within 0.015 against dense numerical integration in f64.",
        references: cite!(characteristic, bussgang; "modulo"),
    },
    inputs: &[
        any("in1", 0.0, "The dividend."),
        any("in2", 1.0, "The divisor; 0 is refused.").range(Range::soft(0.1, 4.0).nonzero()),
    ],
    output: OutputType::Widest,
    reach: |inputs| inputs.reach("in2").hull(Reach::point(0.0)),
    class: |_| Behaviour::Function,
    example: example! { "modulo", r#"
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "modulo": {"type": "modulo", "inputs": {"in1": {"node": "u"}, "in2": 0.21}}
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let mut divisor = None;
    let out = binary(lower, node, ["in1", "in2"], |lower, x, y| {
        let is_number = y.cell.is_none() && y.is_certain();
        divisor = y.mean.as_constant().filter(|_| is_number).map(f32::abs);
        composed(lower, |lower| {
            let y = lower.algebra.expose(y);
            let turns = quotient(lower, x, &y);
            let fraction = transfer(lower, &turns, &LinearWave::sawtooth());
            product(lower, &fraction, &y)
        })
    });
    lower.algebra.repeats(divisor);
    out
}
