//! Power.

use crate::componentwise::{binary, transfer};
use crate::port::any;
use mipless_codegen::moments::{Polynomial, RealPower, Transfer};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Doc, InputView, Interval, Node, NodeSpec, OutputType, Range, Reach,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "power",
    aliases: &["pow", "gamma", "exponent", "math_power"],
    category: Category::Transfer,
    summary: "A signal to a power.",
    doc: Doc {
        computes: "out = in1 ^ in2, for each component. Where the exponent is a literal whole number \
            from 0 to 8, a product of factors with the sign that it has; any other exponent, one \
            from an input of the graph included, acts on max(in1, 0).",
        statistics: "Whole literal exponents n: E[xᵏ] = m E[xᵏ⁻¹] + (k − 1) v E[xᵏ⁻²], distortion \
            Σ_{k ≥ 2} vᵏ/k! E[T⁽ᵏ⁾]²; exact for a Gaussian. Other exponents: ten-point \
            Gauss–Legendre quadrature over the part above 0 of the difference from a tangent, \
            approximate. A varying exponent joins the base in a cubature of degree 5 over the joint \
            Gaussian of both, with positive weights.",
        accuracy: "Whole exponents: exact to rounding. Others, from 0.5 to 3.5, for a Gaussian input: \
            the mean is within 1e-3 and the remainder’s standard deviation within 0.015 of \
            (|m| + σ) to that power. Held by `codegen/src/moments/tests.rs` against dense \
            numerical integration in f64; a varying exponent and a base near 1 to 2e-3, by \
            `nodes/src/tests/combination.rs`.",
        references: cite!(isserlis, bussgang; "power"),
    },
    inputs: &[
        any("in1", 0.0, "The base."),
        any("in2", 1.0, "The exponent.").range(Range::soft(0.0, 8.0)),
    ],
    output: OutputType::Widest,
    reach: powers,
    class,
    example: example! { "power", r#"
    "uv": { "type": "texcoord" },
    "u": { "type": "extract", "inputs": { "in": { "node": "uv" }, "index": 0 } },
    "turns": { "type": "multiply", "inputs": { "in1": { "node": "u" }, "in2": 25 } },
    "wave": { "type": "sin", "inputs": { "in": { "node": "turns" } } },
    "power": { "type": "power", "inputs": { "in1": { "node": "wave" }, "in2": 2 } }
"# },
};

/// A negative power has neither mean nor variance where the base reaches 0.
fn class(inputs: &dyn InputView) -> Behaviour {
    let [base, exponent] = ["in1", "in2"].map(|port| inputs.reach(port).0);
    let singular = |(base, exponent): (Interval, Interval)| base.low <= 0.0 && exponent.low < 0.0;
    if inputs.varies("in1") && base.into_iter().zip(exponent).any(singular) {
        Behaviour::NoMoments {
            port: "in1",
            reason: "a negative power has neither mean nor variance where the base reaches 0",
        }
    } else {
        Behaviour::Function
    }
}

/// Even whole powers are those of |x|; others act on max(x, 0), where they rise or fall everywhere.
fn powers(inputs: &dyn InputView) -> Reach {
    inputs
        .reach("in1")
        .zip(inputs.reach("in2"), |base, exponent| {
            let number = (exponent.low == exponent.high).then_some(exponent.low);
            match whole(number) {
                Some(n) if n % 2 == 0 => base.abs().monotone(|x| x.powi(n as i32)),
                Some(n) => base.monotone(|x| x.powi(n as i32)),
                None => {
                    let corners = [exponent.low, exponent.high]
                        .map(|power| base.monotone(|x| x.max(0.0).powf(power)));
                    corners[0].hull(corners[1])
                }
            }
        })
}

/// The exponent as a whole number that the closed form takes.
fn whole(exponent: Option<f32>) -> Option<u32> {
    let n = exponent.filter(|n| n.fract() == 0.0 && (0.0..=Polynomial::MOST as f32).contains(n));
    n.map(|n| n as u32)
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    binary(lower, node, ["in1", "in2"], |lower, x, exponent| {
        if lower.mode().spreads() && !exponent.is_certain() {
            let inputs = [x.clone(), exponent.clone()];
            let ranges = [[0.0, f32::INFINITY]];
            let mut out = (lower.algebra).cubature(&inputs, &ranges, |values| {
                vec![RealPower { power: values[1] }.value(values[0])]
            });
            return out.remove(0);
        }
        let power = exponent.flat_mean();
        match whole(power.as_constant()) {
            Some(1) => x.clone(),
            Some(power) => transfer(lower, x, &Polynomial { power }),
            None => transfer(lower, x, &RealPower { power }),
        }
    })
}
