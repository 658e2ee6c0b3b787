//! `turbulence2d`: a sum of magnitudes of octaves.

use crate::noise::layers::{layers, published};
use crate::noise::octaves::{DIMINISH, LACUNARITY, OCTAVES, repeating};
use crate::noise::source::{
    AMPLITUDE, EXTENT, FREQUENCY, KERNEL, PERIOD, PIVOT, SEED, TEXCOORD, diminished, position,
};
use mipless_codegen::moments::{Piecewise, Signal};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, Reach, Type};

/// max |CDF − Φ| of three octaves.
const DEVIATION: f32 = 0.06;

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "turbulence2d",
    aliases: &["turbulence", "billow", "billowed", "billow noise"],
    category: Category::Noise,
    summary: "A sum of magnitudes of octaves of lattice noise: billows with sharp creases.",
    doc: Doc {
        computes: "pivot + amplitude/4 · Σ_k diminishᵏ |N_k(lacunarityᵏ · frequency · texcoord)|, with \
            N_k independent noises of `noise2d` of variance 1, k from 0 up to `octaves`; the last one \
            of a fractional count has that share of its amplitude. At least `pivot`.",
        statistics: "Mean pivot + amplitude/4 · √(2/π) Σ_k diminishᵏ, variance (amplitude/4)² (1 − 2/π) \
            Σ_k diminish²ᵏ; the range begins at `pivot`; max |CDF − Φ| is 0.06. The spectrum of an \
            octave lies around frequency 0 and around twice that of the noise: the dominant \
            wavelength is half of the noise’s. \
            Each octave is a filtered noise put through |x| (a folded normal); of an octave that \
            the footprint has removed its mean and its variance are left.",
        accuracy: "After a smooth step or a step, the mean is within 0.047 and 0.077 (RMS over \
            footprints from 0.03 to 2 wavelengths, 4 octaves), before them within 0.023; held by `nodes/tests/fractal.rs`.",
        references: "Perlin 1985, *An Image Synthesizer* (turbulence); Leone, Nelson & Nottingham \
            1961, *The Folded Normal Distribution*. libnoise and noise-rs `Billow` with another \
            scale: 2|n| − 1.",
    },
    inputs: &[
        TEXCOORD, FREQUENCY, AMPLITUDE, PIVOT, SEED, PERIOD, KERNEL, OCTAVES, LACUNARITY, DIMINISH,
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |inputs| {
        let layers = Reach::of(0.0, 0.25 * EXTENT * diminished(inputs));
        inputs.reach("pivot") + inputs.reach("amplitude") * layers
    },
    class: |inputs| repeating(inputs, DEVIATION),
    example: r#"{ "version": 1, "name": "billows",
        "nodes": { "turbulence2d": { "type": "turbulence2d", "inputs": { "frequency": 4, "octaves": 4.5 } } },
        "outputs": { "out": { "node": "turbulence2d" } } }"#,
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let position = position(lower, node);
    let layers = layers(lower, node, position);
    let shares = std::mem::replace(&mut lower.algebra.shares, false);
    let absolute = Piecewise::absolute(lower.b());
    let mut sum = Signal::constant(lower.b(), 0.0);
    for layer in &layers {
        let magnitude = lower.algebra.transfer(&layer.noise, &absolute);
        sum = sum + magnitude * (layer.amplitude * layer.share);
    }
    lower.algebra.shares = shares;
    let sum = published(lower, sum);
    let [amplitude, pivot] = ["amplitude", "pivot"].map(|port| lower.signal(node, port));
    vec![lower.algebra.product(&sum, &(amplitude * 0.25)) + pivot]
}
