//! `noise2d`: lattice noise, filtered exactly for any footprint.

use crate::noise::lattice::{self, Octaves};
use crate::noise::source::{AMPLITUDE, FREQUENCY, KERNEL, PIVOT, SEED, TEXCOORD, position, shaped};
use mipless_codegen::NodeDef;
use mipless_graph::{Behaviour, Category, Doc, NodeSpec, OutputType, Type};

/// max |CDF − Φ| of the quadrupole kernel (RULES, far field).
pub(crate) const DEVIATION: f32 = 0.0046;

static SPEC: NodeSpec = NodeSpec {
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
            E = exp(−d·d/2a²) and k = dᵀB(θ)d/a⁴ with B a reflection of a random angle θ. The \
            dominant wavelength is 1.53 cells.",
        statistics: "Gaussian with mean `pivot` and standard deviation amplitude/4; max |CDF − Φ| is \
            0.0046. Over a footprint of covariance Σ (in cells), the mean, gradient and Hessian are \
            those of the field filtered by Σ, in closed form with T = a²I + Σ in place of a²I; the \
            remainder is the ensemble variance F(0) − F(Σ) less the part of the derivatives.",
        accuracy: "Filtered mean within 0.03 standard deviations of the noise; kernels beyond the \
            window are dropped, and octaves fade out between 6 % and 3 % of their amplitude, what \
            is dropped joining the remainder.",
        references: "Perlin 1985 (lattice noise); Bruneton & Neyret 2012 §2.2; Hermite–Parseval \
            identity for the remainder.",
    },
    inputs: &[TEXCOORD, FREQUENCY, AMPLITUDE, PIVOT, SEED, KERNEL],
    output: OutputType::Exactly(Type::Float),
    class: |_| Behaviour::Gaussian {
        deviation: DEVIATION,
    },
    example: r#"{ "version": 1, "name": "clouds",
        "nodes": { "noise2d": { "type": "noise2d", "inputs": { "frequency": 8, "pivot": 0.5 } } },
        "outputs": { "out": { "node": "noise2d" } } }"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef {
    spec: &SPEC,
    lower: |lower, node| {
        let octaves = Octaves {
            count: 1,
            lacunarity: 2.0,
            diminish: 1.0,
            seed: lower.integer(node, "seed"),
            period: 0,
        };
        let position = position(lower, node);
        let field = lattice::filtered(lower, &position, octaves);
        shaped(lower, node, &field, 1.0, &position)
    },
};
