//! `fractal3d`: a sum of octaves of lattice noise in space.

use crate::noise::components::{AMPLITUDES, FRACTAL, HASH, SIGNATURE};
use crate::noise::noise3d::{deviation, summed};
use crate::noise::octaves::{DIMINISH, LACUNARITY, OCTAVES, repeating, tiled_octaves};
use crate::noise::source::{
    FREQUENCY, KERNEL, PERIOD, PIVOT, POSITION, SEED, diminished, practical,
};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "fractal3d",
    aliases: &["fbm3d", "fractal noise 3d", "musgrave 3d", "solid fractal"],
    category: Category::Noise,
    summary: "A sum of octaves of lattice noise in space.",
    doc: Doc {
        computes: "pivot + amplitude/4 · Σ_k diminishᵏ N_k(lacunarityᵏ · frequency · position), with N_k \
            independent noises of `noise3d`, k from 0 up to `octaves`; the last one of a fractional \
            count has that share of its amplitude.",
        statistics: "Gaussian with mean `pivot` and variance (amplitude/4)² Σ_k diminish²ᵏ; the \
            range is ±5 standard deviations in practice. The spectrum is the sum of the octaves’, each \
            that of `noise3d`, finer by lacunarityᵏ. Each octave is \
            filtered as `noise3d` is; octaves are independent, so gradients and Hessians add and so \
            do the remainders.",
        accuracy: "As `noise3d`, octave by octave. Held by `nodes/tests/volume.rs`.",
        references: "Perlin 1985; Musgrave et al. 1989; MaterialX 1.39 specification, node `fractal3d`; \
            Bruneton & Neyret 2012 §2.2.",
    },
    inputs: &[
        POSITION, FREQUENCY, AMPLITUDES, PIVOT, SEED, PERIOD, KERNEL, OCTAVES, LACUNARITY,
        DIMINISH, HASH, SIGNATURE,
    ],
    output: OutputType::Named("signature"),
    reach: |inputs| practical(inputs, diminished(inputs)),
    class: |inputs| repeating(inputs, deviation(inputs)),
    example: r#"{ "version": 1, "name": "granite",
        "nodes": { "fractal3d": { "type": "fractal3d", "inputs": { "frequency": 4, "octaves": 4, "pivot": 0.5, "kernel": "quintic", "period": 4 } } },
        "outputs": { "out": { "node": "fractal3d" } } }"#,
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    summed(lower, node, tiled_octaves(lower, node), FRACTAL)
}
