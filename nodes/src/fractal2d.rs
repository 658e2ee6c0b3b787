//! `fractal2d`: a sum of octaves of lattice noise.

use crate::noise::lattice::{self, Octaves};
use crate::noise::source::{AMPLITUDE, FREQUENCY, KERNEL, PIVOT, SEED, TEXCOORD, position, shaped};
use crate::noise2d::DEVIATION;
use mipless_codegen::NodeDef;
use mipless_graph::{
    Behaviour, Category, Default, Doc, NodeSpec, OutputType, PortSpec, PortType, Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "fractal2d",
    aliases: &["fbm", "fractal", "fractal noise", "musgrave", "clouds"],
    category: Category::Noise,
    summary: "A sum of octaves of lattice noise; octaves that the footprint removes cost nearly nothing.",
    doc: Doc {
        computes: "pivot + amplitude/4 · Σ_k diminishᵏ N_k(lacunarityᵏ · frequency · texcoord), \
            with N_k independent noises of `noise2d`.",
        statistics: "Gaussian with mean `pivot` and variance (amplitude/4)² Σ_k diminish²ᵏ. Each \
            octave is filtered as `noise2d` is; octaves are independent, so gradients and Hessians \
            add and so do the remainders.",
        accuracy: "As `noise2d`, octave by octave.",
        references: "Perlin 1985; Musgrave et al. 1989; Bruneton & Neyret 2012 §2.2.",
    },
    inputs: &[
        TEXCOORD,
        FREQUENCY,
        AMPLITUDE,
        PIVOT,
        SEED,
        KERNEL,
        PortSpec::new(
            "octaves",
            PortType::Exactly(Type::Integer),
            Default::Integer(3),
            "How many noises are summed.",
        )
        .uniform()
        .range(Range::hard(1.0, 16.0).with_soft(1.0, 8.0))
        .unit("count"),
        PortSpec::new(
            "lacunarity",
            PortType::Exactly(Type::Float),
            Default::Float(2.0),
            "The ratio of the frequencies of neighbouring octaves.",
        )
        .uniform()
        .range(Range::hard(1.0, 8.0).with_soft(1.5, 3.0)),
        PortSpec::new(
            "diminish",
            PortType::Exactly(Type::Float),
            Default::Float(0.5),
            "The ratio of the amplitudes of neighbouring octaves.",
        )
        .uniform()
        .range(Range::hard(0.0, 2.0).with_soft(0.0, 1.0)),
    ],
    output: OutputType::Exactly(Type::Float),
    class: |_| Behaviour::Gaussian {
        deviation: DEVIATION,
    },
    example: r#"{ "version": 1, "name": "smoke",
        "nodes": { "fractal2d": { "type": "fractal2d", "inputs": { "frequency": 4, "octaves": 5, "pivot": 0.5 } } },
        "outputs": { "out": { "node": "fractal2d" } } }"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef {
    spec: &SPEC,
    lower: |lower, node| {
        let octaves = Octaves {
            count: lower.integer(node, "octaves") as u32,
            lacunarity: lower.float(node, "lacunarity"),
            diminish: lower.float(node, "diminish"),
            seed: lower.integer(node, "seed"),
            period: 0,
        };
        let position = position(lower, node);
        let field = lattice::filtered(lower, &position, octaves);
        shaped(lower, node, &field, octaves.sd(), &position)
    },
};
