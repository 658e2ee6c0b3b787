//! `noise2d`: lattice noise, filtered exactly for any footprint.

use crate::noise::components::{AMPLITUDES, Apart, Component, HASH, Hash, NOISE, SIGNATURE};
use crate::noise::kernel::Kernel;
use crate::noise::perlin::Kind;
use crate::noise::source::{
    EXTENT, FREQUENCY, KERNEL, PERIOD, PIVOT, SEED, TEXCOORD, octaves_of, position, practical,
    tiling,
};
use crate::noise::sum::Octaves;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, InputView, Node, NodeSpec, OutputType};

/// max |CDF − Φ| of the quadrupole kernel and of Perlin's, over 4·10⁶ independent points.
const DEVIATIONS: [f32; 2] = [0.0046, 0.0127];

/// The deviation from a Gaussian of the noises with a `kernel`.
pub(crate) fn deviation(inputs: &dyn InputView) -> f32 {
    DEVIATIONS
        [usize::from(inputs.choice("kernel") == "quintic" || inputs.choice("hash") == "materialx")]
}

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "noise2d",
    aliases: &[
        "perlin",
        "perlin noise",
        "gradientnoise",
        "gradient noise",
        "noise",
    ],
    category: Category::Noise,
    summary: "Band-limited lattice noise, filtered exactly for any footprint.",
    doc: Doc {
        computes: "pivot + amplitude/4 · N(frequency · texcoord), where N sums a kernel κ E k over \
            the lattice points: with d the offset to a point and a = 0.3854 cells, \
            E = exp(−d·d/2a²) and k = dᵀB(θ)d/a⁴ with B a reflection of a random angle θ; the \
            dominant wavelength is 1.53 cells. With `quintic`, Perlin’s gradient noise: \
            Σ w(d_x) w(d_y) g·d over the four corners of a cell, w(t) = 1 − 10|t|³ + 15t⁴ − 6|t|⁵ \
            and g a random direction; the dominant wavelength is 1.70 cells. With the hash `materialx`, \
            pivot + amplitude · 0.6616 Σ w(d_x) w(d_y) g·d with g one of (±1, ±2) and (±2, ±1) by \
            Jenkins’s hash of the lattice point, which is MaterialX’s `noise2d` to rounding at a seed \
            of 0; its standard deviation is 0.319 amplitude.",
        statistics: "Gaussian with mean `pivot` and standard deviation amplitude/4; max |CDF − Φ| is \
            0.0046 (`quintic`: 0.0127). The range is ±5 standard deviations in practice (`quintic`: \
            ±3.4 at most). Over a footprint of covariance Σ (in cells), the mean, gradient and Hessian are \
            those of the field filtered by Σ, in closed form with T = a²I + Σ in place of a²I; the \
            remainder is the ensemble variance F(0) − F(Σ) less the part of the derivatives. \
            `quintic` is filtered by the polynomials of w up to a standard deviation of 0.16 cells \
            and from 0.1 cells on by (0.971 + P(d_x) + P(d_y)) e^{−d·d/2b²}, b = 0.3625, \
            P(t) = 3.067t² − 7.744t⁴ + 3.449t⁶, in place of w(d_x) w(d_y), which any Σ filters in \
            closed form. The spectrum is one band around the dominant wavelength, falling to 0 \
            at frequency 0 with its fourth power (`quintic`: its square).",
        accuracy: "Filtered mean, RMS over positions, in standard deviations of the noise: within 0.007 \
            up to footprints of half a cell, 0.024 beyond, and 0.016 for footprints of 8:1 at any \
            angle, held by `nodes/tests/noise.rs` against dense integration. At most 0.02 is \
            dropped beyond the window; an octave that keeps less than 0.08 % of the whole noise's variance \
            fades out, gone at 0.04 %, what fades joining the remainder. The remainder is an average over \
            positions: the variance of the unfiltered noise over all lattices is 0.24 of its mean at \
            a lattice point and 1.67 at the most; of the noise filtered by 0.2 cells 0.49 to 1.67, by \
            a third of a cell 0.83 to 1.36, by half a cell 0.96 to 1.09. Cost, in kernels: 3×3 \
            unfiltered; filtered, four columns across the footprint's longer side by three rows up \
            to 0.12 cells, four up to 0.78, then 4.6 √(0.149 + σ²) up to 32, none once it has \
            faded (1.37 cells, if round). `quintic`: the fit is 0.023 standard deviations from \
            the noise; filtered mean within 0.035 at any round footprint and within 0.025 at 8:1, \
            at any angle (`nodes/tests/perlin.rs`); its remainder is that of random lattices, while the \
            noise is 0 at every lattice point; 2×2 kernels up to 0.1 cells, then from 3×3 on, each \
            about twice as dear. The lattice repeats 2³² cells further along an axis, and first 63,217 \
            cells away, 51,009 against x and 37,343 along y. No reflection, transposition or shift by \
            a power of two along an axis is correlated with it, for any seed (`nodes/tests/symmetry.rs`).",
        references: "Perlin 1985 (lattice noise); Perlin 2002, *Improving Noise* (the quintic \
            fade); MaterialX 1.39 specification, node `noise2d`; Bruneton & Neyret 2012 §2.2; Hermite–Parseval \
            identity for the remainder.",
    },
    inputs: &[
        TEXCOORD, FREQUENCY, AMPLITUDES, PIVOT, SEED, PERIOD, KERNEL, HASH, SIGNATURE,
    ],
    output: OutputType::Named("signature"),
    reach: |inputs| practical(inputs, 1.0),
    class: |inputs| tiling(inputs, 1.0, 1.0, deviation(inputs)),
    example: r#"{ "version": 1, "name": "clouds",
        "nodes": { "noise2d": { "type": "noise2d", "inputs": { "frequency": 8, "pivot": 0.5 } } },
        "outputs": { "out": { "node": "noise2d" } } }"#,
};

/// A sum of one octave.
pub(crate) fn one_octave(seed: i32, period: i32) -> Octaves {
    Octaves {
        count: 1,
        part: 0.0,
        lacunarity: 2.0,
        diminish: 1.0,
        seed,
        period: period.max(0) as u32,
        ratio: 1.0,
        hash: Hash::Mipless,
    }
}

/// The one octave that a node's `seed` and `period` ask for.
pub(crate) fn tiled_octave(lower: &Lower<'_, '_>, node: &Node) -> Octaves {
    one_octave(lower.integer(node, "seed"), lower.integer(node, "period"))
}

/// Sums of octaves with the node's hash and kernel, one for each component.
pub(crate) fn summed<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    octaves: Octaves,
    apart: Apart,
) -> Bundle<'b> {
    let hash = Hash::of(lower, node);
    let position = position(lower, node);
    let extent = EXTENT * octaves.sd();
    (Component::all(hash, node.ty.components(), apart).into_iter())
        .map(|component| {
            let octaves = Octaves {
                seed: component.seed(octaves.seed),
                hash,
                ..octaves
            };
            let (kernel, factor) = match hash {
                Hash::Mipless => (Kernel::of(lower, node), 0.25),
                Hash::Materialx => {
                    let kind = Kind::Materialx(component.byte);
                    (Kernel::Quintic(kind), MATERIALX * kind.deviation())
                }
            };
            let place = component.place(&position);
            octaves_of(
                lower,
                node,
                (kernel, octaves),
                (factor, extent),
                (&place, component.index),
            )
        })
        .collect()
}

/// What MaterialX multiplies the sum of its kernels by.
pub(crate) const MATERIALX: f32 = 0.6616;

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    summed(lower, node, tiled_octave(lower, node), NOISE)
}
