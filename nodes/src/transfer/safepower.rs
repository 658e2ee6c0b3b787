//! Power with the sign of its base.

use crate::componentwise::{binary, transfer};
use crate::port::any;
use crate::transfer::levels::signed_power;
use mipless_codegen::moments::{Curve, Polynomial};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType, Range, Reach,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "safepower",
    aliases: &["safe_power", "signed_power"],
    category: Category::Transfer,
    summary: "A signal to a power, with the sign that it has.",
    doc: Doc {
        computes: "out = sign(in1) |in1| ^ in2, for each component.",
        statistics: "Odd whole literal exponents to 7 are those of `power`, exact for a Gaussian. Others: \
            ten-point Gauss–Legendre quadrature on both sides of 0 of the difference from a tangent, \
            approximate. A varying exponent joins the base in a cubature of degree 5 over the joint \
            Gaussian of both, with positive weights.",
        accuracy: "As `power`, of which it is the odd continuation. Held by `tests/tests/parity.rs` at a \
            point, and by `nodes/src/tests.rs` as the footprint goes to 0.",
        references: cite!(bussgang; "safepower"),
    },
    inputs: &[
        any("in1", 0.0, "The base."),
        any("in2", 1.0, "The exponent.").range(Range::soft(0.0, 8.0)),
    ],
    output: OutputType::Widest,
    reach: |_| Reach::ANY,
    class,
    example: example! { "safepower", r#"
    "uv": { "type": "texcoord" },
    "u": { "type": "extract", "inputs": { "in": { "node": "uv" }, "index": 0 } },
    "turns": { "type": "multiply", "inputs": { "in1": { "node": "u" }, "in2": 25 } },
    "wave": { "type": "sin", "inputs": { "in": { "node": "turns" } } },
    "safepower": { "type": "safepower", "inputs": { "in1": { "node": "wave" }, "in2": 1.7 } }
"# },
};

/// A negative power has neither mean nor variance where the base reaches 0.
fn class(inputs: &dyn InputView) -> Behaviour {
    let pairs = (inputs.reach("in1").0.into_iter()).zip(inputs.reach("in2").0);
    let mut singular = pairs.map(|(base, exponent)| base.contains(0.0) && exponent.low < 0.0);
    if inputs.varies("in1") && singular.any(|singular| singular) {
        Behaviour::NoMoments {
            port: "in1",
            reason: "a negative power has neither mean nor variance where the base reaches 0",
        }
    } else {
        Behaviour::Function
    }
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    binary(lower, node, ["in1", "in2"], |lower, x, exponent| {
        let ends = [f32::NEG_INFINITY, f32::INFINITY];
        if lower.mode().spreads() && !exponent.is_certain() {
            let inputs = [x.clone(), exponent.clone()];
            let mut out = (lower.algebra)
                .cubature(&inputs, &[ends], |v| vec![signed_power(v[0], v[1], false)]);
            return out.remove(0);
        }
        let power = exponent.flat_mean();
        if let Some(odd) = power
            .as_constant()
            .filter(|n| [1.0, 3.0, 5.0, 7.0].contains(n))
        {
            let power = odd as u32;
            return if power == 1 {
                x.clone()
            } else {
                transfer(lower, x, &Polynomial { power })
            };
        }
        let curve = Curve {
            function: move |x| signed_power(x, power, false),
            kinks: vec![power.literal(0.0)],
            flat: [None; 2],
            range: ends,
        };
        transfer(lower, x, &curve)
    })
}
