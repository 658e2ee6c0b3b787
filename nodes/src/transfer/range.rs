//! Affine map from a range to a range.

use crate::componentwise::{numbers, transfer};
use crate::port::any;
use crate::transfer::levels::{self, DOCLAMP, GAMMA, interpolated, passed, vanishing};
use mipless_codegen::moments::Piecewise;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Doc, InputView, Interval, Node, NodeSpec, OutputType, Reach,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "range",
    aliases: &["map_range", "maprange", "fit", "histogram_range"],
    category: Category::Transfer,
    summary: "Maps one range of numbers to another.",
    doc: Doc {
        computes: "out = outlow + sign(t) |t|^(1/gamma) (outhigh − outlow) with t = (in − inlow)/(inhigh \
            − inlow), limited to [0, 1] if `doclamp` is set, for each component. A range narrower \
            than 1e-6 counts as 1e-6 wide.",
        statistics: "With a gamma that is not the number 1, as `levels`. Else, without `doclamp`, linear and exact; varying outlow or outhigh multiply t as \
            `multiply` does. With it, the transfer min(max(t, 0), 1) in closed form, exact for a \
            Gaussian input. A varying inlow moves the signal, exactly; of inhigh − inlow the mean \
            is used, and the class says so.",
        accuracy: "Without `doclamp`, exact to rounding. With it, the mean is within 1e-5 of the output \
            range for a Gaussian input. Held by `codegen/src/moments/tests.rs` against dense \
            numerical integration in f64.",
        references: cite!(linear, bussgang; "range"),
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
        if !straight(inputs) && !inputs.flag("doclamp") {
            return Reach::ANY;
        }
        let [low, high] = ["outlow", "outhigh"].map(|port| inputs.reach(port));
        if inputs.flag("doclamp") {
            return low.hull(high);
        }
        let [from, to] = ["inlow", "inhigh"].map(|port| inputs.reach(port));
        Reach::mixed(low, high, (inputs.reach("in") - from) / (to - from))
    },
    class,
    example: example! { "range", r#"
    "uv": { "type": "texcoord" },
    "u": { "type": "extract", "inputs": { "in": { "node": "uv" }, "index": 0 } },
    "turns": { "type": "multiply", "inputs": { "in1": { "node": "u" }, "in2": 25 } },
    "wave": { "type": "sin", "inputs": { "in": { "node": "turns" } } },
    "range": { "type": "range", "inputs": { "in": { "node": "wave" }, "inlow": -0.5, "inhigh": 0.5, "doclamp": true } }
"# },
};

/// Limiting bends; varying bounds of the output multiply, and of the input count by their means.
fn class(inputs: &dyn InputView) -> Behaviour {
    if let Some(vanishing) = vanishing(inputs) {
        return vanishing;
    }
    let varies = |ports: &[&str]| ports.iter().any(|port| inputs.varies(port));
    if inputs.flag("doclamp") || varies(&["inlow", "inhigh"]) || !straight(inputs) {
        Behaviour::Function
    } else if inputs.varies("in") && varies(&["outlow", "outhigh"]) {
        Behaviour::Product
    } else {
        Behaviour::Linear
    }
}

/// Whether there is no power.
fn straight(inputs: &dyn InputView) -> bool {
    !inputs.varies("gamma") && inputs.reach("gamma").whole(4) == Interval::point(1.0)
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let gamma = numbers(lower, node, "gamma");
    if gamma.iter().any(|gamma| gamma.as_constant() != Some(1.0)) {
        return levels::lower(lower, node);
    }
    let limited = lower.flag(node, "doclamp");
    let ports = ["in", "inlow", "inhigh", "outlow", "outhigh"];
    let [input, low, high, outlow, outhigh] = ports.map(|port| lower.bundle(node, port));
    let component = |i: usize| {
        let mut share = passed(&input[i], &low[i], &high[i]);
        if limited {
            let b = lower.b();
            share = transfer(lower, &share, &Piecewise::clamp(b.float(0.0), b.float(1.0)));
        }
        interpolated(lower, &outlow[i], &outhigh[i], &share)
    };
    (0..input.len()).map(component).collect()
}
