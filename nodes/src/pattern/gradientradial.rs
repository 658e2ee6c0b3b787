//! A gradient around a centre.

use crate::componentwise::{difference, transfer};
use crate::pattern::angle::polar;
use crate::pattern::grid::TEXCOORD;
use crate::pattern::unless::pattern_unless;
use crate::port;
use mipless_codegen::moments::Piecewise;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "gradientradial",
    aliases: &["radial_gradient", "spherical_gradient", "circular_gradient"],
    category: Category::Pattern,
    summary: "Falls from 1 at a centre to 0 at a radius.",
    doc: Doc {
        computes: "out = max(1 − |texcoord − center|/radius, 0).",
        statistics: "The distance as `polar` has it, with its mean and variance at the centre too, and a \
            clamp of it in closed form, which takes the distance for Gaussian; no more than \
            R²/(6√det Σ), which the density of the footprint allows.",
        accuracy: "The mean is within 0.03 for round footprints and within 0.09 for footprints of 8:1. Held \
            by `nodes/src/pattern/tests.rs` against dense sums.",
        references: "Rice 1945, *Mathematical Analysis of Random Noise* (the distribution of a distance). \
            Bussgang 1952, *Crosscorrelation functions of amplitude-distorted Gaussian signals*.",
    },
    inputs: &[
        TEXCOORD,
        port::pair("center", [0.5, 0.5], "The centre.").unit("uv"),
        port::number("radius", 0.5, "Where the gradient ends.")
            .range(Range::hard(1e-6, f32::MAX).with_soft(0.01, 1.0))
            .unit("uv"),
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::of(0.0, 1.0),
    class: |inputs| pattern_unless(inputs, &["center", "radius"]),
    example: example! { "gradientradial", r##"
    "gradientradial": { "type": "gradientradial", "inputs": { "radius": 0.6 } }
"## },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let (texcoord, centre) = (lower.bundle(node, "texcoord"), lower.bundle(node, "center"));
    let radius = lower.number(node, "radius");
    let [x, y] = [0, 1].map(|i| difference(&texcoord[i], &centre[i]));
    let [_, length] = polar(lower, [&x, &y]);
    let height = (length * -(1.0 / radius)).offset(1.0);
    let b = lower.b();
    let cone = transfer(
        lower,
        &height,
        &Piecewise::clamp(b.float(0.0), b.float(1.0)),
    );
    if cone.is_certain() {
        return vec![cone];
    }
    // The density of the footprint is at most 1/(2π√det Σ), and the cone's volume πR²/3.
    let determinant = x.variance() * y.variance() - x.covariance(&y).total.square();
    let most = radius.square() / determinant.max(1e-20).sqrt() * (1.0 / 6.0);
    let share = (most / cone.mean.max(1e-20)).min(1.0);
    vec![(cone * share).with_range([0.0, 1.0])]
}
