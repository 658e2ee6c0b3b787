//! `valuenoise2d`: random values at lattice points, blended between them.

use crate::noise::kernel::Kernel;
use crate::noise::noise2d::tiled_octave;
use crate::noise::perlin::Kind;
use crate::noise::source::{
    FREQUENCY, PERIOD, SEED, TEXCOORD, octaves_of, position, practical, tiling,
};
use crate::port;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, Range, Type};

/// max |CDF − Φ|, measured over 4·10⁶ independent points.
const DEVIATION: f32 = 0.030;

/// The standard deviation of values uniform in [−½, ½], blended: (∫w²)/√12 with ∫w² = 181/231.
const SD: f32 = 0.226_191_3;

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "valuenoise2d",
    aliases: &[
        "valuenoise",
        "value noise",
        "noise_value",
        "fbm value",
        "smooth noise",
    ],
    category: Category::Noise,
    summary: "Random values at lattice points, blended smoothly between them.",
    doc: Doc {
        computes: "pivot + amplitude · (V(frequency · texcoord) − ½), where V blends values uniform \
            in [0, 1] at the lattice points by w(t) = 1 − 10|t|³ + 15t⁴ − 6|t|⁵ along each axis \
            (Perlin’s quintic fade).",
        statistics: "Mean `pivot`, standard deviation 0.226 · amplitude over random lattices and \
            positions (0.289 at a lattice point, 0.151 in the middle of a cell); max |CDF − Φ| is \
            0.030. The range is pivot ± amplitude/2. The spectrum falls from frequency 0 on; times \
            the frequency, it peaks at a wavelength of 3.14 cells. Over a footprint of covariance Σ (in cells): up to a standard deviation of \
            0.16 cells by the polynomials of w, from 0.1 cells on by (1.003 + P(d_x) + P(d_y)) \
            e^{−d·d/2b²}, b = 0.3775, P(t) = 2.333t² − 6.760t⁴ + 3.180t⁶, in place of \
            w(d_x) w(d_y), which any Σ filters in closed form. The \
            remainder is the ensemble variance less the part of the derivatives.",
        accuracy: "Filtered mean within 0.018 standard deviations of the noise, for footprints of 8:1 \
            at any angle too, up to two wavelengths; held by `nodes/tests/perlin.rs`. The remainder is that \
            of random lattices: what a lattice line or a cell’s middle adds to it is not seen.",
        references: "Perlin 2002, *Improving Noise* (the fade); Bruneton & Neyret 2012 §2.2; \
            Hermite–Parseval identity for the remainder.",
    },
    inputs: &[
        TEXCOORD,
        FREQUENCY,
        port::number("amplitude", 1.0, "The largest value less the smallest one.")
            .range(Range::soft(0.0, 2.0)),
        port::number("pivot", 0.5, "The mean of the noise.").range(Range::soft(-1.0, 1.0)),
        SEED,
        PERIOD,
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |inputs| practical(inputs, 1.0),
    class: |inputs| tiling(inputs, 1.0, 1.0, DEVIATION),
    example: r#"{ "version": 1, "name": "patches",
        "nodes": { "valuenoise2d": { "type": "valuenoise2d", "inputs": { "frequency": 8 } } },
        "outputs": { "out": { "node": "valuenoise2d" } } }"#,
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let octave = tiled_octave(lower, node);
    let kernel = Kernel::Quintic(Kind::Value);
    let position = position(lower, node);
    let place = (&position[..], 0);
    vec![octaves_of(
        lower,
        node,
        (kernel, octave),
        (SD, 0.5 / SD),
        place,
    )]
}
