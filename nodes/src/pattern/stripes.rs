//! Parallel stripes.

use crate::pattern::unless::pattern_unless;
use crate::port;
use mipless_codegen::moments::{Signal, SquareWave};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

use crate::componentwise::{product, sum, transfer};
use crate::coordinate::rotate2d::turn;

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "stripes",
    aliases: &["bands", "lines"],
    category: Category::Pattern,
    summary: "Parallel stripes of 0 and 1.",
    doc: Doc {
        computes: "out = 1 where the fraction of (u cos r + v sin r) · frequency is below width, else \
            0, with r = rotate. With a rotation of 0 the stripes run along v.",
        statistics: "A square wave of a Gaussian phase in closed form: Φ at the nearest two edges up to a \
            standard deviation of 0.11 periods, six damped Fourier harmonics beyond; variance \
            P(1 − P). Exact for a position. Over a large footprint the mean is width. Of a \
            varying width the mean is used.",
        accuracy: "For a Gaussian phase the mean is within 5e-6. Held by `codegen/src/moments/tests.rs` \
            against dense numerical integration in f64.",
        references: "Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8. Bussgang \
            1952, *Crosscorrelation functions of amplitude-distorted Gaussian signals*; Stein \
            1981, *Estimation of the mean of a multivariate normal distribution*, lemma 1.",
    },
    inputs: &[
        port::surface("The coordinates."),
        port::number("frequency", 8.0, "How many stripes.")
            .range(Range::soft(1.0, 64.0))
            .unit("cycles per uv"),
        port::number(
            "rotate",
            0.0,
            "The angle from the u axis to the direction across the stripes, counter-clockwise.",
        )
        .range(Range::soft(-180.0, 180.0))
        .unit("degrees"),
        port::number("width", 0.5, "The share of the period that is 1.")
            .range(Range::hard(0.0, 1.0)),
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::of(0.0, 1.0),
    class: |inputs| pattern_unless(inputs, &["frequency", "rotate", "width"]),
    example: example! { "stripes", r#"
    "stripes": { "type": "stripes", "inputs": { "frequency": 12, "rotate": 30, "width": 0.35 } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let texcoord = lower.bundle(node, "texcoord");
    let [frequency, rotate] = ["frequency", "rotate"].map(|port| lower.signal(node, port));
    let width = lower.number(node, "width").clamp(0.0, 1.0);
    let distance = along(lower, &texcoord, &rotate);
    let phase = product(lower, &distance, &frequency);
    vec![transfer(lower, &phase, &SquareWave { width })]
}

/// The distance of a position from the origin along a direction in degrees.
pub(crate) fn along<'b>(
    lower: &mut Lower<'_, 'b>,
    texcoord: &[Signal<'b>],
    rotate: &Signal<'b>,
) -> Signal<'b> {
    let [cosine, sine] = turn(lower, rotate);
    let x = product(lower, &texcoord[0], &cosine);
    let y = product(lower, &texcoord[1], &sine);
    sum(&x, &y)
}
