//! A gradient between four corners.

use crate::componentwise::{product, transfer};
use crate::pattern::ramp::between;
use crate::pattern::unless::pattern_unless;
use crate::port;
use mipless_codegen::moments::Piecewise;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, Reach};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "ramp4",
    aliases: &["four_corner_gradient", "bilinear"],
    category: Category::Pattern,
    summary: "Goes between the values of four corners.",
    doc: Doc {
        computes: "out = the bilinear mixture of the four values with s = u and t = v limited to [0, 1], \
            (u, v) = texcoord: valuebl at (0, 0), valuebr at (1, 0), valuetl at (0, 1), valuetr at \
            (1, 1): the top is where v is 1.",
        statistics: "s and t are clamps of Gaussians in closed form and their product carries the covariance \
            of their linear responses: exact where the footprint lies inside the unit square or \
            along the axes, approximate for rotated footprints across an edge of it.",
        accuracy: "The mean is within 1e-6 of the range of the values where exact, within 0.08 of it for \
            footprints of 8:1 across the edges. Held by `nodes/src/pattern/tests.rs`.",
        references: "Isserlis 1918, *On a formula for the product-moment coefficient of any order of a normal \
            frequency distribution*. MaterialX 1.39 specification, node `ramp4`.",
    },
    inputs: &[
        port::any("valuetl", 0.0, "The value at the top left."),
        port::any("valuetr", 0.0, "The value at the top right."),
        port::any("valuebl", 0.0, "The value at the bottom left."),
        port::any("valuebr", 0.0, "The value at the bottom right."),
        port::surface("The coordinates."),
    ],
    output: OutputType::Widest,
    reach: |inputs| {
        let corners = ["valuetl", "valuetr", "valuebl", "valuebr"].map(|port| inputs.reach(port));
        corners.into_iter().fold(corners[0], Reach::hull)
    },
    class: |inputs| pattern_unless(inputs, &["valuetl", "valuetr", "valuebl", "valuebr"]),
    example: example! { "ramp4", r##"
    "ramp4": { "type": "ramp4", "inputs": { "valuetl": "#20303c", "valuetr": "#e8c27a", "valuebl": "#7a4a2b", "valuebr": "#d8d4c8" } }
"## },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let texcoord = lower.bundle(node, "texcoord");
    let b = lower.b();
    let clamp = Piecewise::clamp(b.float(0.0), b.float(1.0));
    // What the clamps distort is in their product as well.
    let shares = lower.algebra.shares;
    lower.algebra.shares = true;
    let [s, t] = [0, 1].map(|i| transfer(lower, &texcoord[i], &clamp));
    lower.algebra.shares = shares;
    let both = product(lower, &s, &t);
    let corners = ["valuebl", "valuebr", "valuetl", "valuetr"].map(|port| lower.bundle(node, port));
    // bl + s (br − bl) + t (tl − bl) + st (tr − br − tl + bl).
    (0..corners[0].len())
        .map(|i| {
            let [bl, br, tl, tr] = [0, 1, 2, 3].map(|k| &corners[k][i]);
            let along = between(lower, bl, br, &s);
            let up = tl - bl;
            let twist = (tr - br) - &up;
            let up = product(lower, &up, &t);
            along + up + product(lower, &twist, &both)
        })
        .collect()
}
