//! `valuenoise2d`: random values at lattice points, blended between them.

use crate::noise::kernel::Kernel;
use crate::noise::noise2d::tiled_octave;
use crate::noise::perlin::Kind;
use crate::noise::source::{
    FREQUENCY, PERIOD, SEED, TEXCOORD, octaves_of, position, practical, tiling,
};
use crate::noise::sum::Octaves;
use crate::port;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, Range, Type,
};

/// max |CDF − Φ|, measured over 4·10⁶ independent points.
const DEVIATION: f32 = 0.030;

/// The standard deviation of values uniform in [−½, ½], blended: (∫w²)/√12 with ∫w² = 181/231, and
/// 26/35 of Material Maker's window.
const SD: f32 = 0.226_191_3;
const CUBIC_SD: f32 = 0.214_444_4;

/// Whose noise it is.
const HASH: PortSpec = port::choice(
    "hash",
    &["mipless", "materialmaker"],
    "mipless",
    "Whose random numbers: `materialmaker` gives the blobs of Material Maker’s value noise.",
);

/// How it tiles along v.
const PERIOD_V: PortSpec = port::integer(
    "period_v",
    0,
    "After how many cells of the lattice the noise repeats along v, where that is not as along u; 0 \
     for the same.",
)
.uniform()
.range(Range::hard(0.0, 65536.0).with_soft(0.0, 64.0))
.unit("cells");

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
            (Perlin’s quintic fade). With the hash `materialmaker`, w(t) = 1 − 3t² + 2|t|³ and the values are \
            Material Maker’s for the same seed: fract(43758.5 cos(p·(13.9898, 8.141) mod 3.14)) of a lattice \
            point and a shift by the seed.",
        statistics: "Mean `pivot`, standard deviation 0.226 · amplitude over random lattices and \
            positions (0.289 at a lattice point, 0.151 in the middle of a cell); max |CDF − Φ| is \
            0.030. The range is pivot ± amplitude/2. The spectrum falls from frequency 0 on; times \
            the frequency, it peaks at a wavelength of 3.14 cells. Over a footprint of covariance Σ (in cells): up to a standard deviation of \
            0.16 cells by the polynomials of w, from 0.1 cells on by (1.003 + P(d_x) + P(d_y)) \
            e^{−d·d/2b²}, b = 0.3775, P(t) = 2.333t² − 6.760t⁴ + 3.180t⁶, in place of \
            w(d_x) w(d_y), which any Σ filters in closed form. The \
            remainder is the ensemble variance less the part of the derivatives. With the hash \
            `materialmaker` the standard deviation is 0.214 · amplitude, max |CDF − Φ| 0.026, the polynomials \
            give way between 0.05 and 0.08 cells, and the fit is (0.980 + P(d_x) + P(d_y)) e^{−d·d/2b²}, \
            b = 0.4325, P(t) = 0.384t² − 2.078t⁴ + 0.819t⁶.",
        accuracy: "Filtered mean within 0.018 standard deviations of the noise, for footprints of 8:1 \
            at any angle too, up to two wavelengths; held by `nodes/tests/perlin.rs`. The remainder is that \
            of random lattices: what a lattice line or a cell’s middle adds to it is not seen. Of `materialmaker` the filtered mean is \
            within 0.035, and values are those of Material Maker to 0.005: its hash multiplies a cosine by \
            43758.5, so that devices that do not round a product before they add to it have other blobs.",
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
        PERIOD_V,
        HASH,
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |inputs| practical(inputs, 1.0),
    class,
    example: r#"{ "version": 1, "name": "patches",
        "nodes": { "valuenoise2d": { "type": "valuenoise2d", "inputs": { "frequency": 8 } } },
        "outputs": { "out": { "node": "valuenoise2d" } } }"#,
};

/// A period along v alone is refused.
fn class(inputs: &dyn InputView) -> Behaviour {
    if inputs.number("period_v") > 0.0 && inputs.number("period") == 0.0 {
        return Behaviour::Refused {
            port: "period_v",
            reason: "it is how the noise repeats along v, and `period` says how along u",
        };
    }
    tiling(inputs, 1.0, 1.0, DEVIATION)
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let octave = tiled_octave(lower, node);
    let period_v = lower.integer(node, "period_v").max(0);
    let ratio = match (octave.period, period_v) {
        (0, _) | (_, 0) => 1.0,
        (period, period_v) => period_v as f32 / period as f32,
    };
    let octave = Octaves { ratio, ..octave };
    let (kind, sd) = match lower.choice(node, "hash") {
        "materialmaker" => (Kind::Materialmaker { seed: octave.seed }, CUBIC_SD),
        _ => (Kind::Value, SD),
    };
    let kernel = Kernel::Quintic(kind);
    let position = position(lower, node);
    let place = (&position[..], 0);
    vec![octaves_of(
        lower,
        node,
        (kernel, octave),
        (sd, 0.5 / sd),
        place,
    )]
}
