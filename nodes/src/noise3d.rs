//! `noise3d`: lattice noise in space, filtered exactly for any footprint.

use crate::noise::lattice::Octaves;
use crate::noise::source::{AMPLITUDE, EXTENT, FREQUENCY, PIVOT, POSITION, SEED, place, scaled};
use crate::noise::volume;
use mipless_codegen::NodeDef;
use mipless_graph::{Behaviour, Category, Doc, NodeSpec, OutputType, Type};

/// max |CDF − Φ|, measured over 10⁵ independent points.
pub(crate) const DEVIATION: f32 = 0.004;

static SPEC: NodeSpec = NodeSpec {
    name: "noise3d",
    aliases: &["perlin3d", "perlin noise 3d", "noise 3d", "solid noise"],
    category: Category::Noise,
    summary: "Band-limited lattice noise in space, filtered exactly for any footprint.",
    doc: Doc {
        computes: "pivot + amplitude/4 · N(frequency · position), where N sums a kernel κ E k over the \
            lattice points of space: with d the offset to a point and a = 0.3854 cells, \
            E = exp(−d·d/2a²) and k = ±((n·d)² − d·d/3)/a² with n a random direction. The dominant \
            wavelength on a plane is 1.72 cells.",
        statistics: "Gaussian with mean `pivot` and standard deviation amplitude/4; max |CDF − Φ| is 0.004. \
            A footprint is a Gaussian on the surface, in space one of covariance Σ of rank 2: mean, \
            gradient and Hessian are those of the field filtered by Σ, in closed form with \
            P = (I + Σ/a²)⁻¹; the remainder is the ensemble variance F(0) − F(Σ), \
            F = (3 (tr P)² − 4 (3 + tr Σ/a²) det P) √(det P)/15, less the part of the derivatives.",
        accuracy: "Filtered mean within 0.03 standard deviations of the noise for round footprints on a \
            plane at any angle, 0.05 at 8:1; held by `nodes/tests/volume.rs`. Kernels beyond the \
            window are dropped, and octaves fade out between 6 % and 3 % of their amplitude, what is \
            dropped joining the remainder.",
        references: "Perlin 1985 (lattice noise); MaterialX 1.39 specification, node `noise3d`; Bruneton \
            & Neyret 2012 §2.2; Hermite–Parseval identity for the remainder.",
    },
    inputs: &[POSITION, FREQUENCY, AMPLITUDE, PIVOT, SEED],
    output: OutputType::Exactly(Type::Float),
    class: |_| Behaviour::Gaussian {
        deviation: DEVIATION,
    },
    example: r#"{ "version": 1, "name": "stone",
        "nodes": { "noise3d": { "type": "noise3d", "inputs": { "frequency": 6, "pivot": 0.5 } } },
        "outputs": { "out": { "node": "noise3d" } } }"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef {
    spec: &SPEC,
    lower: |lower, node| {
        let octaves = Octaves {
            count: 1,
            part: 0.0,
            lacunarity: 2.0,
            diminish: 1.0,
            seed: lower.integer(node, "seed"),
            period: 0,
        };
        let position = place(lower, node);
        let unit = volume::filtered(lower, &position, octaves);
        scaled(lower, node, unit, (0.25, EXTENT))
    },
};
