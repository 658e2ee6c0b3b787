//! Product.

use crate::componentwise::{binary, product};
use crate::port::any;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Interval, Node, NodeSpec, OutputType, Range};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "multiply",
    aliases: &["mul", "times", "math_multiply"],
    category: Category::Arithmetic,
    summary: "The product of two signals.",
    doc: Doc {
        computes: "out = in1 · in2, for each component.",
        statistics: "By a number, linear and exact. Of two varying signals, for jointly Gaussian ones: E \
            = m₁m₂ + cov, Var = m₁²v₂ + m₂²v₁ + 2m₁m₂cov + v₁v₂ + cov². The mean and its \
            covariance with everything Gaussian are exact; the variance needs the Gaussian \
            hypothesis.",
        accuracy: "Exact to rounding for Gaussian inputs. For others the mean is exact wherever the \
            carried covariance is. Held by `nodes/src/tests.rs`.",
        references: cite!(isserlis; "multiply"),
    },
    inputs: &[
        any("in1", 0.0, "The first operand.").range(Range::soft(-1.0, 1.0)),
        any("in2", 1.0, "The second operand.").range(Range::soft(-1.0, 1.0)),
    ],
    output: OutputType::Widest,
    reach: |inputs| {
        let [x, y] = ["in1", "in2"].map(|port| inputs.reach(port));
        if inputs.same("in1", "in2") {
            x.map(Interval::abs) * x.map(Interval::abs)
        } else {
            x * y
        }
    },
    class: |_| Behaviour::Product,
    example: example! { "multiply", r#"
    "bands": { "type": "stripes", "inputs": { "frequency": 6 } },
    "across": { "type": "stripes", "inputs": { "frequency": 4, "rotate": 90 } },
    "multiply": { "type": "multiply", "inputs": { "in1": { "node": "bands" }, "in2": { "node": "across" } } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    binary(lower, node, ["in1", "in2"], product)
}
