//! Tangent.

use crate::componentwise::{composed, quotient, transfer, unary};
use crate::port::any;
use mipless_codegen::moments::Sine;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType, Range, Reach,
};
use std::f32::consts::FRAC_PI_2;

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "tan",
    aliases: &["tangent", "math_tangent"],
    category: Category::Transfer,
    summary: "The tangent of a signal in radians.",
    doc: Doc {
        computes: "out = sin(in) / cos(in), for each component; a cosine nearer to 0 than 1e-6 is moved \
            to ±1e-6.",
        statistics: "A varying input reaches the poles, where no moment exists: filtered methods give \
            the quotient of the two filtered waves, which is only bounded, and `auto` samples \
            where that is far off.",
        accuracy: "Exact at a point to 1e-5 away from the poles; filtered, not stated. Held by \
            `nodes/src/tests.rs`, which compares every node with its point value as the footprint \
            goes to 0.",
        references: cite!(marsaglia; "tan"),
    },
    inputs: &[any("in", 0.0, "The angle.")
        .range(Range::soft(-1.5, 1.5))
        .unit("radians")],
    output: OutputType::Widest,
    reach: |_| Reach::ANY,
    class,
    example: example! { "tan", r#"
    "tan": {"type": "tan", "inputs": {"in": 0.7}}
"# },
};

/// Of a number, a number.
fn class(inputs: &dyn InputView) -> Behaviour {
    if inputs.varies("in") {
        Behaviour::NoMoments {
            port: "in",
            reason: "the tangent of an angle that varies passes its poles, where neither mean nor \
                     variance exist; between two poles a `colorramp` of the angle can take its place",
        }
    } else {
        Behaviour::Function
    }
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    unary(lower, node, "in", |lower, x| {
        composed(lower, |lower| {
            let x = lower.algebra.expose(x);
            let [sine, cosine] = [0.0, FRAC_PI_2].map(|phase| transfer(lower, &x, &Sine { phase }));
            quotient(lower, &sine, &cosine)
        })
    })
}
