//! Unit vector.

use crate::arithmetic::vector::unit;
use crate::port::any;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Reach};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "normalize",
    aliases: &["normalise", "unit_vector"],
    category: Category::Arithmetic,
    summary: "A vector of length 1 in the same direction.",
    doc: Doc {
        computes: "out = in / √Σ inᵢ²; 0 for a vector shorter than 1e-6.",
        statistics: "By a cubature of degree 5 over the joint Gaussian of the inputs, with positive \
            weights: mean, the slopes by each input, and the rest as a sum of squares. \
            Approximate; near 0, where the direction turns within a footprint, by a large part of \
            the result.",
        accuracy: "For a vector at least five standard deviations long the mean and the standard \
            deviation are within 1e-3; nearer to 0 within 0.1 and 0.25. Held by \
            `nodes/src/tests/vector.rs` against dense numerical integration in f64.",
        references: cite!(stroud; "normalize"),
    },
    inputs: &[any("in", 1.0, "The vector.")],
    output: OutputType::Whole,
    reach: |_| Reach::of(-1.0, 1.0),
    class: |inputs| {
        if inputs.varies("in") {
            Behaviour::Rough {
                error: 0.1,
                place: "has a mean that is off by up to 0.1, and a standard deviation by 0.25, where the \
                    footprint holds 0 and the direction turns",
            }
        } else {
            Behaviour::Function
        }
    },
    example: example! { "normalize", r#"
    "uv": {"type": "texcoord"},
    "turned": {"type": "rotate2d", "inputs": {"in": {"node": "uv"}, "amount": 30}},
    "normalize": {"type": "normalize", "inputs": {"in": {"node": "turned"}}}
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let components = lower.bundle(node, "in");
    let ranges = vec![[-1.0, 1.0]; components.len()];
    lower.algebra.cubature(&components, &ranges, unit)
}
