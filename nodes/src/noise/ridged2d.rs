//! `ridged2d`: Musgrave's ridged multifractal.

use crate::noise::layers::{layers, published};
use crate::noise::octaves::{DIMINISH, LACUNARITY, OCTAVES, repeating};
use crate::noise::ridge::{Ridge, couple, settle};
use crate::noise::source::{FREQUENCY, KERNEL, PERIOD, PIVOT, SEED, TEXCOORD, position};
use crate::port;
use mipless_codegen::moments::{Piecewise, Signal};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

/// max |CDF − Φ| of three octaves with the default ports.
const DEVIATION: f32 = 0.07;

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "ridged2d",
    aliases: &[
        "ridged",
        "ridgedmulti",
        "ridged multi",
        "ridged multifractal",
    ],
    category: Category::Noise,
    summary: "Octaves with sharp ridges, each shown where the one before is high.",
    doc: Doc {
        computes: "pivot + amplitude · Σ_k diminishᵏ s_k, with s_0 = r_0, s_k = r_k · clamp(gain · \
            s_{k−1}, 0, 1) and the ridges r_k = (offset − |N_k|/4)² of independent noises of \
            `noise2d` of variance 1 at lacunarityᵏ · frequency · texcoord; the last one of a \
            fractional count has that share of its amplitude.",
        statistics: "The first octave has mean (offset − 0.1995)² + 0.0227; with the default ports all \
            three have mean 1.12 and standard deviation 0.31, max |CDF − Φ| is 0.07. The range is \
            from `pivot` to pivot + amplitude · offset² Σ_k diminishᵏ while |N_k| stays below \
            8 · offset. The spectrum of an octave lies around frequency 0 and around twice that of \
            the noise: the dominant wavelength is half of the noise’s. Each octave is a filtered noise put through the \
            ridge, (offset − |x|/4)², in closed form; its weight is the clamp of the one before, \
            with the covariance between them, and products are Isserlis’s.",
        accuracy: "After a smooth step or a step, the mean is within 0.043 and 0.071 (RMS over \
            footprints from 0.03 to 2 wavelengths, 3 octaves), before them within 0.043. The mean of \
            a large footprint is within 0.009, its standard deviation within 0.015: the weights \
            are not Gaussian. Held by `nodes/tests/fractal.rs`.",
        references: "Musgrave, in Ebert et al. 2003, *Texturing and Modeling*, ch. 16 \
            (RidgedMultifractal); Leone, Nelson & Nottingham 1961, *The Folded Normal \
            Distribution*; Isserlis 1918.",
    },
    inputs: &[
        TEXCOORD,
        FREQUENCY,
        port::number(
            "amplitude",
            1.0,
            "By what the sum of the octaves is multiplied.",
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
            "The height of a ridge before it is squared; the noise under it has a standard \
             deviation of 0.25.",
        )
        .range(Range::soft(0.0, 2.0)),
        port::number(
            "gain",
            2.0,
            "How much of an octave is shown where the one before is high.",
        )
        .range(Range::soft(0.0, 8.0)),
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::ANY,
    class: |inputs| repeating(inputs, DEVIATION),
    example: r#"{ "version": 1, "name": "ridges",
        "nodes": { "ridged2d": { "type": "ridged2d", "inputs": { "frequency": 4, "octaves": 4, "amplitude": 0.7 } } },
        "outputs": { "out": { "node": "ridged2d" } } }"#,
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let position = position(lower, node);
    let layers = layers(lower, node, position);
    let [offset, gain] = ["offset", "gain"].map(|port| lower.number(node, port));
    let b = lower.b();
    let ridge = Ridge { offset };
    let weight = Piecewise::clamp(b.float(0.0), b.float(1.0));
    // What an octave shares with the one before is carried by symbols, whoever reads the node.
    let shares = std::mem::replace(&mut lower.algebra.shares, true);
    let first = lower.algebra.next_symbol();
    let mut sum = Signal::constant(b, 0.0);
    let mut before: Option<Signal<'_>> = None;
    for layer in &layers {
        let mut octave = lower.algebra.transfer(&layer.noise, &ridge);
        if let Some(before) = before {
            let weight = lower.algebra.transfer(&(before * gain), &weight);
            octave = lower.algebra.product(&octave, &weight);
        }
        octave = published(lower, octave);
        sum = sum + &octave * (layer.amplitude * layer.share);
        if lower.mode().spreads() {
            couple(lower, first, &mut sum, &mut octave);
        }
        before = Some(octave);
    }
    lower.algebra.shares = shares;
    settle(first, &mut sum);
    let sum = published(lower, sum);
    let [amplitude, pivot] = ["amplitude", "pivot"].map(|port| lower.signal(node, port));
    vec![lower.algebra.product(&sum, &amplitude) + pivot]
}
