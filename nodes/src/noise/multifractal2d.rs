//! `multifractal2d`: a product of octaves.

use crate::noise::layers::{layers, published};
use crate::noise::octaves::{DIMINISH, LACUNARITY, OCTAVES, repeating};
use crate::noise::source::{FREQUENCY, KERNEL, PERIOD, PIVOT, SEED, TEXCOORD, position};
use crate::port;
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

/// max |CDF − Φ| of three octaves with the default ports.
const DEVIATION: f32 = 0.025;

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "multifractal2d",
    aliases: &[
        "multifractal",
        "musgrave multifractal",
        "basicmulti",
        "basic multi",
    ],
    category: Category::Noise,
    summary: "A product of octaves: rough where it is high, smooth where it is low.",
    doc: Doc {
        computes: "pivot + amplitude · Π_k (offset + diminishᵏ N_k/4), with N_k independent noises of \
            `noise2d` of variance 1 at lacunarityᵏ · frequency · texcoord, k from 0 up to `octaves`. \
            The last factor of a fractional count is 1 + share · (factor − 1).",
        statistics: "Mean pivot + amplitude · offsetⁿ, variance amplitude² (Π_k (offset² + diminish²ᵏ/16) − \
            offset²ⁿ) for n octaves; the range is amplitude · Π_k (offset ± 1.25 · diminishᵏ) in \
            practice. The spectrum is that of the octaves and of all their products, and the \
            dominant wavelength that of the first octave; with the \
            default ports max |CDF − Φ| is 0.025. The octaves are independent, and the product of \
            filtered ones is exact in mean, variance and covariance.",
        accuracy: "The mean and the variance of the product are exact for Gaussian octaves; the rest is \
            that of `noise2d`: the mean over a footprint is within 0.006 (RMS over footprints from \
            0.03 to 2 wavelengths). Held by `nodes/tests/fractal.rs`.",
        references: "Musgrave, in Ebert et al. 2003, *Texturing and Modeling*, ch. 14 and 16 \
            (multifractal); Isserlis 1918.",
    },
    inputs: &[
        TEXCOORD,
        FREQUENCY,
        port::number(
            "amplitude",
            1.0,
            "By what the product of the octaves is multiplied.",
        )
        .range(Range::soft(0.0, 4.0)),
        PIVOT,
        SEED,
        PERIOD,
        KERNEL,
        OCTAVES,
        LACUNARITY,
        DIMINISH,
        port::number(
            "offset",
            1.0,
            "What is added to each octave; the first has a standard deviation of 0.25.",
        )
        .range(Range::soft(0.0, 2.0)),
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::ANY,
    class: |inputs| repeating(inputs, DEVIATION),
    example: r#"{ "version": 1, "name": "hills",
        "nodes": { "multifractal2d": { "type": "multifractal2d", "inputs": { "frequency": 4, "octaves": 5, "amplitude": 0.5 } } },
        "outputs": { "out": { "node": "multifractal2d" } } }"#,
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let position = position(lower, node);
    let layers = layers(lower, node, position);
    let offset = lower.number(node, "offset");
    // Independent octaves share nothing that a product would have to know.
    let shares = std::mem::replace(&mut lower.algebra.shares, false);
    let mut product = Signal::constant(lower.b(), 1.0);
    for layer in &layers {
        // 1 + share · (offset − 1).
        let level = offset * layer.share + (1.0 - layer.share);
        let varied = &layer.noise * (0.25 * layer.amplitude * layer.share);
        product = lower.algebra.product(&product, &varied.offset(level));
    }
    lower.algebra.shares = shares;
    let product = published(lower, product);
    let [amplitude, pivot] = ["amplitude", "pivot"].map(|port| lower.signal(node, port));
    vec![lower.algebra.product(&product, &amplitude) + pivot]
}
