//! `fractal2d`: a sum of octaves of lattice noise.

use crate::noise::components::{AMPLITUDES, FRACTAL, HASH, SIGNATURE};
use crate::noise::noise2d::{deviation, summed};
use crate::noise::octaves::{DIMINISH, LACUNARITY, OCTAVES, repeating, tiled_octaves};
use crate::noise::source::{
    FREQUENCY, KERNEL, PERIOD, PIVOT, SEED, TEXCOORD, diminished, practical,
};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "fractal2d",
    aliases: &["fbm", "fractal", "fractal noise", "musgrave", "clouds"],
    category: Category::Noise,
    summary: "A sum of octaves of lattice noise; octaves that the footprint removes cost nearly nothing.",
    doc: Doc {
        computes: "pivot + amplitude/4 · Σ_k diminishᵏ N_k(lacunarityᵏ · frequency · texcoord), \
            with N_k independent noises of `noise2d`, k from 0 up to `octaves`. Of 3.25 octaves the \
            fourth has a quarter of its amplitude. With the hash `materialx`, the sum of MaterialX’s \
            `noise2d` at p lacunarityᵏ, which is its `fractal2d`; its octaves share one lattice, so \
            that they are not independent around the origin.",
        statistics: "Gaussian with mean `pivot` and variance (amplitude/4)² Σ_k diminish²ᵏ; the \
            range is ±5 standard deviations in practice. The spectrum is the sum of the octaves’, each \
            that of `noise2d`, finer by lacunarityᵏ. Each \
            octave is filtered as `noise2d` is; octaves are independent, so gradients and Hessians \
            add and so do the remainders.",
        accuracy: "As `noise2d`, octave by octave; held by `nodes/tests/noise.rs`, `nodes/tests/perlin.rs` \
            and, for mean and variance, `tests/tests/statistics.rs`.",
        references: "Perlin 1985; Musgrave et al. 1989; Bruneton & Neyret 2012 §2.2.",
    },
    inputs: &[
        TEXCOORD, FREQUENCY, AMPLITUDES, PIVOT, SEED, PERIOD, KERNEL, OCTAVES, LACUNARITY,
        DIMINISH, HASH, SIGNATURE,
    ],
    output: OutputType::Named("signature"),
    reach: |inputs| practical(inputs, diminished(inputs)),
    class: |inputs| repeating(inputs, deviation(inputs)),
    example: r#"{ "version": 1, "name": "smoke",
        "nodes": { "fractal2d": { "type": "fractal2d", "inputs": { "frequency": 4, "octaves": 5, "pivot": 0.5 } } },
        "outputs": { "out": { "node": "fractal2d" } } }"#,
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    summed(lower, node, tiled_octaves(lower, node), FRACTAL)
}
