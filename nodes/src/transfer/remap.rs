//! Affine map from a range to a range, without limits.

use crate::port::any;
use crate::transfer::levels::{interpolated, passed, vanishing};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Reach};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "remap",
    aliases: &["rescale"],
    category: Category::Transfer,
    summary: "Maps one range of numbers to another, without limits.",
    doc: Doc {
        computes: "out = outlow + t (outhigh − outlow) with t = (in − inlow)/(inhigh − inlow), for each \
            component. A range narrower than 1e-6 counts as 1e-6 wide.",
        statistics: "Linear and exact; varying outlow or outhigh multiply t as `multiply` does. A varying \
            inlow moves the signal, exactly; of inhigh − inlow the mean is used, and the class says \
            so.",
        accuracy: "Exact to rounding. Held by `tests/tests/parity.rs` at a point, and by \
            `nodes/src/tests.rs` as the footprint goes to 0.",
        references: cite!(linear; "remap"),
    },
    inputs: &[
        any("in", 0.0, "The signal."),
        any("inlow", 0.0, "What maps to outlow."),
        any("inhigh", 1.0, "What maps to outhigh."),
        any("outlow", 0.0, "The result at inlow."),
        any("outhigh", 1.0, "The result at inhigh."),
    ],
    output: OutputType::Widest,
    reach: |inputs| {
        let ports = ["in", "inlow", "inhigh", "outlow", "outhigh"];
        let [x, from, to, low, high] = ports.map(|port| inputs.reach(port));
        Reach::mixed(low, high, (x - from) / (to - from))
    },
    class: |inputs| {
        if let Some(vanishing) = vanishing(inputs) {
            return vanishing;
        }
        let varies = |ports: &[&str]| ports.iter().any(|port| inputs.varies(port));
        match (varies(&["inlow", "inhigh"]), varies(&["outlow", "outhigh"])) {
            (true, _) => Behaviour::Function,
            (false, true) if inputs.varies("in") => Behaviour::Product,
            _ => Behaviour::Linear,
        }
    },
    example: example! { "remap", r#"
    "bands": {"type": "stripes", "inputs": {"frequency": 6}},
    "remap": {"type": "remap", "inputs": {"in": {"node": "bands"}, "outlow": 0.3, "outhigh": 0.7}}
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let ports = ["in", "inlow", "inhigh", "outlow", "outhigh"];
    let [input, low, high, outlow, outhigh] = ports.map(|port| lower.bundle(node, port));
    let component = |i: usize| {
        let share = passed(&input[i], &low[i], &high[i]);
        interpolated(lower, &outlow[i], &outhigh[i], &share)
    };
    (0..input.len()).map(component).collect()
}
