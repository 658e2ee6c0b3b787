//! Quotient.

use crate::componentwise::{binary, quotient};
use crate::port::any;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType, Range};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "divide",
    aliases: &["div", "math_divide"],
    category: Category::Arithmetic,
    summary: "The quotient of two signals.",
    doc: Doc {
        computes: "out = in1 / in2, for each component. A divisor nearer to 0 than 1e-6 is moved to \
            ±1e-6.",
        statistics: "By a number, linear and exact. By a varying signal: the product of in1 with the \
            reciprocal of in2, whose moments under a Gaussian come from seven standard scores \
            with positive weights. They exist only where in2 stays away from 0: its mean is kept \
            at least four standard deviations from it. Approximate.",
        accuracy: "By a number, exact to rounding. By a varying signal with |mean| ≥ 6 standard \
            deviations, the mean is within 2e-5 of its value; nearer to 0 the quotient has no \
            moments and the result is only bounded. Held by `codegen/src/moments/tests.rs` \
            against dense numerical integration in f64.",
        references: cite!(marsaglia, isserlis; "divide"),
    },
    inputs: &[
        any("in1", 0.0, "The numerator.").range(Range::soft(-1.0, 1.0)),
        any("in2", 1.0, "The divisor; 0 is refused.").range(Range::soft(0.1, 4.0).nonzero()),
    ],
    output: OutputType::Widest,
    reach: |inputs| inputs.reach("in1") / inputs.reach("in2"),
    class,
    example: example! { "divide", r#"
    "bands": { "type": "stripes", "inputs": { "frequency": 6 } },
    "divide": { "type": "divide", "inputs": { "in1": { "node": "bands" }, "in2": 4 } }
"# },
};

/// By a number, linear; a varying divisor bends, and beside a varying numerator makes a product.
fn class(inputs: &dyn InputView) -> Behaviour {
    match (inputs.varies("in1"), inputs.varies("in2")) {
        (_, false) => Behaviour::Linear,
        (false, true) => Behaviour::Function,
        (true, true) => Behaviour::Product,
    }
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    binary(lower, node, ["in1", "in2"], quotient)
}
