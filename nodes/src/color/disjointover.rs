//! Disjoint layers.

use crate::color::composite::{IMAGES, composite, composition, layered};
use crate::componentwise::{product, quotient};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "disjointover",
    aliases: &["disjoint_over"],
    category: Category::Color,
    summary: "One layer over another, which do not overlap while there is room.",
    doc: Doc {
        computes: composition!(
            "(F + B, f + b) where f + b ≤ 1, else (F + B (1 − f)/b, 1), of which the colour is 0 where b is"
        ),
        statistics: "The quotient and the minimum as `divide` and `min`, then a product with the \
            covariance. Approximate where the alphas vary.",
        accuracy: "For alphas at least four standard deviations above 0 the mean is within 0.005 and the \
            standard deviation within 0.02. Held by `nodes/src/tests/vector.rs` against dense \
            numerical integration in f64.",
        references: cite!(
            "MaterialX, *Physically Based Shading Nodes and Standard Nodes*.",
            isserlis; "disjointover"
        ),
    },
    inputs: IMAGES,
    output: OutputType::Exactly(Type::Color4),
    reach: |_| Reach::ANY,
    class: |_| Behaviour::Product,
    example: layered!("disjointover"),
};

/// MaterialX's smallest divisor.
const EMPTY: f32 = 1e-6;

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    composite(lower, node, |lower, fg, bg, k| {
        let one = Signal::constant(lower.b(), 1.0);
        if k == 3 {
            return lower.algebra.minimum(&(&fg[3] + &bg[3]), &one);
        }
        let share = quotient(lower, &(&one - &fg[3]), &bg[3]);
        if !(fg[3].is_certain() && bg[3].is_certain()) {
            let share = lower.algebra.minimum(&share, &one);
            return &fg[k] + product(lower, &bg[k], &share);
        }
        let (front, behind) = (fg[3].flat_mean(), bg[3].flat_mean());
        let room = (front + behind).le(1.0);
        let share = Signal::certain(room.select(1.0, share.flat_mean()));
        let sum = &fg[k] + product(lower, &bg[k], &share);
        // Without room and without an alpha behind, MaterialX's shader gives no colour.
        let some = behind.abs().lt(EMPTY).select(0.0, 1.0);
        sum * room.select(1.0, some)
    })
}
