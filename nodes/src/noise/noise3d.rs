//! `noise3d`: lattice noise in space, filtered exactly for any footprint.

use crate::noise::components::{AMPLITUDES, Apart, Component, HASH, Hash, NOISE, SIGNATURE};
use crate::noise::noise2d::tiled_octave;
use crate::noise::source::{
    EXTENT, FREQUENCY, KERNEL, PERIOD, PIVOT, POSITION, SEED, place, practical, scaled, tiling,
};
use crate::noise::sum::Octaves;
use crate::noise::volume::{self, Kind};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, InputView, Node, NodeSpec, OutputType};

/// max |CDF − Φ| of the quadrupole kernel and of Perlin's, over 4·10⁶ independent points.
const DEVIATIONS: [f32; 2] = [0.002, 0.016];

/// The deviation from a Gaussian of the noises in space.
pub(crate) fn deviation(inputs: &dyn InputView) -> f32 {
    DEVIATIONS
        [usize::from(inputs.choice("kernel") == "quintic" || inputs.choice("hash") == "materialx")]
}

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "noise3d",
    aliases: &["perlin3d", "perlin noise 3d", "noise 3d", "solid noise"],
    category: Category::Noise,
    summary: "Band-limited lattice noise in space, filtered exactly for any footprint.",
    doc: Doc {
        computes: "pivot + amplitude/4 · N(frequency · position), where N sums a kernel κ E k over the \
            lattice points of space: with d the offset to a point and a = 0.3854 cells, \
            E = exp(−d·d/2a²) and k = ±((n·d)² − d·d/3)/a² with n a random direction. The dominant \
            wavelength on a plane is 1.72 cells. With `quintic`, Perlin’s gradient noise: \
            Σ w(d_x) w(d_y) w(d_z) g·d over the eight corners of a cell, w(t) = 1 − 10|t|³ + 15t⁴ \
            − 6|t|⁵ and g a random direction; the dominant wavelength is 1.93 cells. With the hash \
            `materialx`, pivot + amplitude · 0.982 Σ w(d_x) w(d_y) w(d_z) g·d with g the middle of an \
            edge of a cube by Jenkins’s hash, which is MaterialX’s `noise3d` to rounding at a seed of \
            0; its standard deviation is 0.265 amplitude.",
        statistics: "Gaussian with mean `pivot` and standard deviation amplitude/4; max |CDF − Φ| is \
            0.002 (`quintic`: 0.016). The range is ±5 standard deviations in practice (`quintic`: \
            ±4.54 at most). The spectrum is one \
            band: 0 at frequency 0 with a fourth power (`quintic`: a square). \
            A footprint is a Gaussian on the surface, in space one of covariance Σ of rank 2: mean, \
            gradient and Hessian are those of the field filtered by Σ, in closed form with \
            P = (I + Σ/a²)⁻¹; the remainder is the ensemble variance F(0) − F(Σ), \
            F = (3 (tr P)² − 4 (3 + tr Σ/a²) det P) √(det P)/15, less the part of the derivatives. \
            `quintic` is filtered by the polynomials of w up to a standard deviation of 0.16 cells \
            and from 0.1 cells on by Q(d) e^{−d·d/2b²} in place of the product of the w, with \
            b = 0.365, Q = 0.951 + Σ_i P(d_i), P(t) = 3.217t² − 8.307t⁴ + 3.731t⁶, which any Σ \
            filters in closed form.",
        accuracy: "Filtered mean within 0.018 standard deviations of the noise for round footprints on \
            a plane at any angle (`quintic`: 0.02), 0.02 at 8:1 (0.025), from 0.02 to 2 cells. \
            Kernels beyond the window are dropped, and octaves fade out between 6 % and 3 % of \
            their amplitude, what is dropped joining the remainder. Local standard deviations at \
            0.02 and 0.1 cells within 0.01 and 0.1 of the true ones by `local`, 0.005 and 0.02 by \
            `quad`. With `quintic` the fit is 0.028 standard deviations from the noise, and the \
            remainder is that of random lattices to 7 %, while the noise is 0 at every lattice \
            point. Held by `nodes/tests/volume.rs`. The lattice repeats 2³² cells further along an \
            axis, and first 918 cells away, at (394, 721, −409).",
        references: "Perlin 1985 (lattice noise); Perlin 2002, *Improving Noise* (the quintic fade); \
            MaterialX 1.39 specification, node `noise3d`; Bruneton & Neyret 2012 §2.2; \
            Hermite–Parseval identity for the remainder; Stein 1981 for the window.",
    },
    inputs: &[
        POSITION, FREQUENCY, AMPLITUDES, PIVOT, SEED, PERIOD, KERNEL, HASH, SIGNATURE,
    ],
    output: OutputType::Named("signature"),
    reach: |inputs| practical(inputs, 1.0),
    class: |inputs| tiling(inputs, 1.0, 1.0, deviation(inputs)),
    example: r#"{ "version": 1, "name": "stone",
        "nodes": { "noise3d": { "type": "noise3d", "inputs": { "frequency": 6, "pivot": 0.5 } } },
        "outputs": { "out": { "node": "noise3d" } } }"#,
};

/// Sums of octaves in space with the node's hash and kernel, one for each component.
pub(crate) fn summed<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    octaves: Octaves,
    apart: Apart,
) -> Bundle<'b> {
    let hash = Hash::of(lower, node);
    let position = place(lower, node);
    let extent = EXTENT * octaves.sd();
    (Component::all(hash, node.ty.components(), apart).into_iter())
        .map(|component| {
            let octaves = Octaves {
                seed: component.seed(octaves.seed),
                hash,
                ..octaves
            };
            let (kind, factor) = match hash {
                Hash::Mipless => (Kind::of(lower, node), 0.25),
                Hash::Materialx => {
                    let kind = Kind::Materialx(component.byte);
                    (kind, MATERIALX / kind.unit())
                }
            };
            let unit = volume::filtered(lower, &component.place(&position), kind, octaves);
            scaled(lower, node, unit, (factor, extent), component.index)
        })
        .collect()
}

/// What MaterialX multiplies the sum of its kernels by.
pub(crate) const MATERIALX: f32 = 0.982;

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    summed(lower, node, tiled_octave(lower, node), NOISE)
}
