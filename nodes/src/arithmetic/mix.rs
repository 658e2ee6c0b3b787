//! Linear interpolation.

use crate::port::any;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Range, Reach,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "mix",
    aliases: &["blend", "lerp", "mixrgb", "mix_color", "interpolate"],
    category: Category::Arithmetic,
    summary: "Goes from one signal to another by a mask.",
    doc: Doc {
        computes: "out = bg + mix · (fg − bg), for each component; the mask is one number, or \
            one for each component. It is not limited to [0, 1].",
        statistics: "With a constant mask, or with a varying mask between constants, linear and exact. \
            With both varying, a product of the mask and fg − bg: exact in mean and variance for \
            jointly Gaussian signals, with the covariance between the mask and what it masks.",
        accuracy: "Exact to rounding where it is linear; as `multiply` otherwise. Held by \
            `nodes/src/tests.rs`.",
        references: cite!(isserlis; "mix"),
    },
    inputs: &[
        any("bg", 0.0, "The result where the mask is 0."),
        any("fg", 0.0, "The result where the mask is 1."),
        PortSpec::new("mix", PortType::Each, Default::Float(0.0), "The mask.")
            .range(Range::soft(0.0, 1.0)),
    ],
    output: OutputType::Widest,
    reach: |inputs| Reach::mixed(inputs.reach("bg"), inputs.reach("fg"), inputs.reach("mix")),
    class,
    example: example! { "mix", r##"
    "bands": { "type": "stripes", "inputs": { "frequency": 6 } },
    "mix": { "type": "mix", "inputs": { "bg": "#20303c", "fg": "#e8c27a", "mix": { "node": "bands" } } }
"## },
};

/// Linear unless the mask varies together with what it masks.
fn class(inputs: &dyn InputView) -> Behaviour {
    if inputs.varies("mix") && (inputs.varies("bg") || inputs.varies("fg")) {
        Behaviour::Product
    } else {
        Behaviour::Linear
    }
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let [bg, fg, mask] = ["bg", "fg", "mix"].map(|port| lower.bundle(node, port));
    (bg.iter().zip(&fg).enumerate())
        .map(|(i, (bg, fg))| lower.algebra.mix(bg, fg, &mask[i.min(mask.len() - 1)]))
        .collect()
}
