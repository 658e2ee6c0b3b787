//! A gradient that goes around a centre.

use crate::componentwise::{difference, sum, transfer};
use crate::pattern::angle::polar;
use crate::pattern::grid::TEXCOORD;
use crate::pattern::sawtooth::Sawtooth;
use crate::pattern::unless::pattern_unless;
use crate::port;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "gradientangular",
    aliases: &[
        "angular_gradient",
        "conical_gradient",
        "sweep_gradient",
        "angle_gradient",
    ],
    category: Category::Pattern,
    summary: "Rises from 0 to 1 around a centre.",
    doc: Doc {
        computes: "out = the angle of texcoord − center in turns, counter-clockwise from the u axis, plus \
            rotate/360, less whole turns.",
        statistics: "The angle as `polar` has it, and the fraction of it in closed form: the jump from 1 to 0 \
            is smoothed like any edge. Approximate within two footprints of the centre, where the \
            result goes to 1/2 only by its variance.",
        accuracy: "For footprints that do not reach the centre the mean is within 0.02. Held by \
            `nodes/src/pattern/tests.rs` against dense sums.",
        references: "Abramowitz & Stegun 1964, 4.4.49 (arctangent). Bussgang 1952, *Crosscorrelation \
            functions of amplitude-distorted Gaussian signals*.",
    },
    inputs: &[
        TEXCOORD,
        port::pair("center", [0.5, 0.5], "The centre.").unit("uv"),
        port::number("rotate", 0.0, "What is added to the angle.")
            .range(Range::soft(-180.0, 180.0))
            .unit("degrees"),
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::of(0.0, 1.0),
    class: |inputs| pattern_unless(inputs, &["center", "rotate"]),
    example: example! { "gradientangular", r##"
    "gradientangular": { "type": "gradientangular", "inputs": { "rotate": 40 } }
"## },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let (texcoord, centre) = (lower.bundle(node, "texcoord"), lower.bundle(node, "center"));
    let degrees = lower.signal(node, "rotate");
    let [x, y] = [0, 1].map(|i| difference(&texcoord[i], &centre[i]));
    let [angle, _] = polar(lower, [&x, &y]);
    let turned = sum(&angle, &(degrees * (1.0 / 360.0)));
    vec![transfer(lower, &turned, &Sawtooth)]
}
