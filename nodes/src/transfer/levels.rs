//! Levels with gamma.

use crate::componentwise::{composed, difference, exposed, numbers, product, transfer};
use crate::port;
use crate::port::any;
use mipless_codegen::ir::Float;
use mipless_codegen::moments::{Curve, Piecewise, RealPower, Reciprocal, Signal, Transfer};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, Range, Reach,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "levels",
    aliases: &["tones", "tone_curve"],
    category: Category::Transfer,
    summary: "Maps one range of numbers to another along a power curve.",
    doc: Doc {
        computes: "t = (in − inlow)/(inhigh − inlow), limited to [0, 1] if `doclamp` is set; out = \
            outlow + sign(t) |t|^(1/gamma) (outhigh − outlow), for each component: MaterialX’s \
            `range` with its gamma. A range narrower than 1e-6 counts as 1e-6 wide.",
        statistics: "By ten-point Gauss–Legendre quadrature between the places where the function bends \
            and closed forms where it is constant, of the difference from a line; the distortion \
            as a sum of squares. Approximate. With a gamma of 1, as `range`, exact for a \
            Gaussian. A varying inlow moves the signal, exactly; of varying inhigh − inlow and gamma \
            the means are used; outlow and outhigh multiply as `multiply` does.",
        accuracy: "For a Gaussian input and a gamma from 0.4 to 2.5 the mean is within 3e-4 of the \
            output range, the standard deviation within 5e-4. Held by `nodes/src/tests/law.rs` \
            against dense numerical integration in f64.",
        references: cite!(bussgang; "range"),
    },
    inputs: &[
        any("in", 0.0, "The signal."),
        any("inlow", 0.0, "What maps to outlow."),
        any("inhigh", 1.0, "What maps to outhigh."),
        GAMMA,
        any("outlow", 0.0, "The result at inlow."),
        any("outhigh", 1.0, "The result at inhigh."),
        DOCLAMP,
    ],
    output: OutputType::Widest,
    reach: |inputs| {
        if inputs.flag("doclamp") {
            inputs.reach("outlow").hull(inputs.reach("outhigh"))
        } else {
            Reach::ANY
        }
    },
    class: |inputs| vanishing(inputs).unwrap_or(Behaviour::Function),
    example: example! { "levels", r#"
    "uv": {"type": "texcoord"},
    "u": {"type": "extract", "inputs": {"in": {"node": "uv"}, "index": 0}},
    "turns": {"type": "multiply", "inputs": {"in1": {"node": "u"}, "in2": 25}},
    "wave": {"type": "sin", "inputs": {"in": {"node": "turns"}}},
    "levels": {"type": "levels", "inputs": {"in": {"node": "wave"}, "inlow": -0.8, "gamma": 2.2, "doclamp": true}}
"# },
};

/// Where the width of the range varies and may be 0, by which the signal is divided.
pub(super) fn vanishing(inputs: &dyn InputView) -> Option<Behaviour> {
    let varies = ["inlow", "inhigh"]
        .into_iter()
        .find(|port| inputs.varies(port))?;
    if inputs.same("inlow", "inhigh") {
        return None;
    }
    let width = inputs.reach("inhigh") - inputs.reach("inlow");
    (width.0.iter().any(|width| width.contains(0.0))).then_some(Behaviour::NoMoments {
        port: varies,
        reason: "inhigh − inlow divides and may be 0, where a quotient has neither mean nor variance",
    })
}

/// The inverse of the exponent.
pub(super) const GAMMA: PortSpec = any("gamma", 1.0, "The inverse of the exponent.")
    .range(Range::hard(0.01, 100.0).with_soft(0.2, 5.0));

/// Whether the result stays within the range of the output.
pub(super) const DOCLAMP: PortSpec = port::flag(
    "doclamp",
    false,
    "Whether the result is limited to lie between outlow and outhigh.",
)
.uniform();

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let limited = lower.flag(node, "doclamp");
    let input = lower.bundle(node, "in");
    let gamma = numbers(lower, node, "gamma");
    let ports = ["inlow", "inhigh", "outlow", "outhigh"];
    let [low, high, outlow, outhigh] = ports.map(|port| exposed(lower, node, port));
    composed(lower, |lower| {
        let component = |i: usize| {
            let share = passed(&input[i], &low[i], &high[i]);
            let share = curved(lower, &share, gamma[i], limited);
            interpolated(lower, &outlow[i], &outhigh[i], &share)
        };
        (0..input.len()).map(component).collect()
    })
}

/// sign(t) |t|^(1/gamma), of t limited to [0, 1] or not.
pub(crate) fn curved<'b>(
    lower: &mut Lower<'_, 'b>,
    share: &Signal<'b>,
    gamma: Float<'b>,
    limited: bool,
) -> Signal<'b> {
    let [zero, one] = [0.0, 1.0].map(|end| gamma.literal(end));
    if gamma.as_constant() == Some(1.0) {
        return if limited {
            transfer(lower, share, &Piecewise::clamp(zero, one))
        } else {
            share.clone()
        };
    }
    let power = 1.0 / gamma.max(0.01);
    let (kinks, flat, range) = if limited {
        (vec![zero, one], [Some(zero), Some(one)], [0.0, 1.0])
    } else {
        (vec![zero], [None; 2], [f32::NEG_INFINITY, f32::INFINITY])
    };
    let curve = Curve {
        function: move |t| signed_power(t, power, limited),
        kinks,
        flat,
        range,
    };
    transfer(lower, share, &curve)
}

/// sign(t) |t|^power, of t limited to [0, 1] or not.
pub(super) fn signed_power<'b>(t: Float<'b>, power: Float<'b>, limited: bool) -> Float<'b> {
    if limited {
        return RealPower { power }.value(t.clamp(0.0, 1.0).abs());
    }
    let raised = RealPower { power }.value(t.abs());
    t.lt(0.0).select(-raised, raised)
}

/// The share of the range that is passed, 0 at `low` and 1 at `high`; of the width of the range the
/// mean is used.
pub(super) fn passed<'b>(x: &Signal<'b>, low: &Signal<'b>, high: &Signal<'b>) -> Signal<'b> {
    difference(x, low) * Reciprocal.value(difference(high, low).flat_mean())
}

/// low + (high − low) share.
pub(super) fn interpolated<'b>(
    lower: &mut Lower<'_, 'b>,
    low: &Signal<'b>,
    high: &Signal<'b>,
    share: &Signal<'b>,
) -> Signal<'b> {
    low + product(lower, &(high - low), share)
}
