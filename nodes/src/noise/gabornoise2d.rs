//! `gabornoise2d`: sparse convolution with Gabor kernels.

use crate::coordinate::rotate2d::turn;
use crate::noise::gabor::{self, Gabor};
use crate::noise::source::{AMPLITUDE, PIVOT, SEED, TEXCOORD, practical, shaped};
use crate::port;
use mipless_codegen::ir::Vec2;
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, Range, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "gabornoise2d",
    aliases: &["gabor", "gabor noise", "gabor texture", "fbm_gabor"],
    category: Category::Noise,
    summary: "Noise of one frequency, with a bandwidth and a direction, filtered exactly.",
    doc: Doc {
        computes: "pivot + amplitude/4 · N(p), p = frequency · texcoord, where N sums Gabor kernels \
            e^{−d·d/2a²} cos(2π n·d + φ) over random places, one in every cell of a lattice, with \
            random phases φ and directions n within ±(1 − anisotropy) · 90° of `orientation`. \
            `impulses` kernels reach a point: the cells have that area of a disc of radius 3a. \
            a = √(2 ln 2)/2π · (2^b + 1)/(2^b − 1) wavelengths, b = bandwidth, so that the \
            amplitude is half of its peak b octaves apart.",
        statistics: "Gaussian with mean `pivot` and standard deviation amplitude/4. A Gabor kernel \
            convolved with a Gaussian is a Gabor kernel: over a footprint of covariance Σ the \
            envelope becomes T = a²I + Σ, the wave a²T⁻¹w, and the amplitude is \
            a²/√det T e^{−½wᵀCw} with C = a²ΣT⁻¹; mean, gradient and Hessian are exact for any Σ. \
            The remainder is the ensemble's: F(0) − F(Σ) less the part of the derivatives, with \
            F = E[e^{−wᵀCw}] a²/√det T; by `local`, the part of it that the value foretells of the \
            Hessian, ½‖E[ggᵀ]‖² M²/F², takes its local value. The spectrum is a ring (or a lobe) of Gaussian profile of \
            width 1/2πa around 1. max |CDF − Φ| is at most 0.155/impulses (the fourth cumulant of a Poisson process); the \
            range is ±5 standard deviations in practice. An orientation that \
            varies over the surface is taken as constant within the footprint.",
        accuracy: "Kernels end at 3a, where 1.1 % of the amplitude and e⁻⁹ of the energy are left, \
            and the noise fades out between 6 % and 3 % of its amplitude, what is dropped joining the \
            remainder: the filtered mean is within 0.005 standard deviations of the noise up to 0.35 \
            wavelengths and 0.03 beyond, rotated 8:1 footprints included. The local standard \
            deviation for all directions and one octave is within 0.02 and 0.06 (`local`), 0.001 and \
            0.013 (`quad`) of the true one, in the mean, at 0.05 and 0.1 wavelengths. Held by \
            `nodes/tests/sources.rs`; all sizes in `tests/benches/sources.rs`.",
        references: "Lagae, Lefebvre, Drettakis & Dutré 2009, *Procedural noise using sparse Gabor \
            convolution*, eq. 3–7; Lagae & Drettakis 2011, *Filtering solid Gabor noise*, eq. 10; \
            Galerne, Lagae, Lefebvre & Drettakis 2012, *Gabor noise by example*, for random phases; \
            Hermite–Parseval identity for the remainder.",
    },
    inputs: &[
        TEXCOORD,
        FREQUENCY,
        BANDWIDTH,
        ORIENTATION,
        ANISOTROPY,
        IMPULSES,
        AMPLITUDE,
        PIVOT,
        SEED,
        PERIOD,
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |inputs| practical(inputs, 1.0),
    class: |inputs| Behaviour::Gaussian {
        deviation: deviation(inputs),
    },
    example: r#"{ "version": 1, "name": "brushed",
        "nodes": { "gabornoise2d": { "type": "gabornoise2d", "inputs": { "frequency": 12, "orientation": 30, "anisotropy": 0.7, "pivot": 0.5 } } },
        "outputs": { "out": { "node": "gabornoise2d" } } }"#,
};

/// How fine.
pub(crate) const FREQUENCY: PortSpec = port::number(
    "frequency",
    1.0,
    "How many waves fit a unit of the texture space.",
)
.range(Range::soft(0.25, 64.0))
.unit("cycles per uv");

/// How regular.
pub(crate) const BANDWIDTH: PortSpec = port::number(
    "bandwidth",
    1.0,
    "How wide the band of frequencies is at half its amplitude.",
)
.uniform()
.range(Range::hard(0.1, 3.0).with_soft(0.25, 2.0))
.unit("octaves");

/// Which way the waves go.
pub(crate) const ORIENTATION: PortSpec = port::number(
    "orientation",
    0.0,
    "The direction across the waves, from the u axis counter-clockwise.",
)
.range(Range::soft(-180.0, 180.0))
.unit("degrees");

/// How much they agree.
pub(crate) const ANISOTROPY: PortSpec = port::number(
    "anisotropy",
    0.0,
    "1 for waves of one direction, 0 for all directions.",
)
.uniform()
.range(Range::hard(0.0, 1.0));

/// How many.
pub(crate) const IMPULSES: PortSpec = port::integer(
    "impulses",
    16,
    "How many kernels reach a point on average; the cost grows with it.",
)
.uniform()
.range(Range::hard(4.0, 64.0))
.unit("count");

/// Whether it tiles.
pub(crate) const PERIOD: PortSpec = port::integer(
    "period",
    0,
    "After how many wavelengths the noise repeats in both directions; 0 for never.",
)
.uniform()
.range(Range::hard(0.0, 65536.0).with_soft(0.0, 64.0))
.unit("wavelengths");

/// max |CDF − Φ| at a random place: a kernel's E[k⁴]/E[k²]² is 3/2 · 4.5/n with n impulses in a
/// disc of radius 3a, and the fourth cumulant κ of a sum moves the distribution by 0.55 κ/24.
pub(crate) fn deviation(inputs: &dyn InputView) -> f32 {
    0.55 / 24.0 * 6.75 / inputs.number("impulses")
}

/// The noise that the uniform ports describe.
pub(crate) fn described(lower: &Lower<'_, '_>, node: &Node) -> Gabor {
    Gabor {
        bandwidth: lower.float(node, "bandwidth"),
        anisotropy: lower.float(node, "anisotropy"),
        impulses: lower.float(node, "impulses"),
        period: lower.integer(node, "period"),
        seed: lower.integer(node, "seed"),
    }
}

/// texcoord · frequency in cells.
pub(crate) fn cells<'b>(lower: &mut Lower<'_, 'b>, node: &Node, gabor: Gabor) -> Vec<Signal<'b>> {
    let frequency = lower.signal(node, "frequency") * (1.0 / gabor.cell());
    (lower.bundle(node, "texcoord").iter())
        .map(|axis| lower.algebra.product(axis, &frequency))
        .collect()
}

/// The unit vector of the orientation.
pub(crate) fn orientation<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Vec2<'b> {
    let angle = Signal::certain(lower.number(node, "orientation"));
    Vec2(turn(lower, &angle).map(|part| part.mean))
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let gabor = described(lower, node);
    let position = cells(lower, node, gabor);
    let orientation = orientation(lower, node);
    let fields = gabor::filtered(lower, &position, gabor, orientation, false);
    shaped(lower, node, &fields[0], &position, |lower| {
        gabor::steepness(lower, &position, gabor, orientation)
    })
}
