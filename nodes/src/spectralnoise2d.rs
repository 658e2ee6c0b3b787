//! `spectralnoise2d`: a sum of cosines with random phases.

use crate::noise::source::{AMPLITUDE, PIVOT, SEED, TEXCOORD, position, shaped};
use crate::noise::spectral::{self, Spectrum};
use mipless_codegen::NodeDef;
use mipless_graph::{
    Behaviour, Category, Default, Doc, NodeSpec, OutputType, PortSpec, PortType, Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "spectralnoise2d",
    aliases: &["spectral noise", "random phase noise", "cosines"],
    category: Category::Noise,
    summary: "A band of cosines with random phases: every moment is exact.",
    doc: Doc {
        computes: "pivot + amplitude/4 · √(2/waves) Σ cos(2π f_i · p + φ_i), p = frequency · \
            texcoord, with directions spread evenly and |f_i| within 2^(±bandwidth/2) of 1.",
        statistics: "Mean `pivot`, standard deviation amplitude/4; by the central limit theorem \
            max |CDF − Φ| is about 1/(11 · waves): 0.0029 at 32. With w = 2πf and q = wᵀΣw each wave \
            is damped by e^{−q/2}; gradient and Hessian are its derivatives, and the remainder is \
            Σ a²/2 (1 − e^{−q} Σ_k qᵏ/k!). No three waves nearly close a triangle, which would lock \
            their phases.",
        accuracy: "Exact for every moment of the footprint, to f32 rounding.",
        references: "Bruneton & Neyret 2012 §2.2; Hermite–Parseval identity.",
    },
    inputs: &[
        TEXCOORD,
        PortSpec::new(
            "frequency",
            PortType::Exactly(Type::Float),
            Default::Float(1.0),
            "The centre of the band.",
        )
        .range(Range::soft(0.25, 64.0))
        .unit("cycles per uv"),
        PortSpec::new(
            "bandwidth",
            PortType::Exactly(Type::Float),
            Default::Float(1.0),
            "How wide the band is.",
        )
        .uniform()
        .range(Range::hard(0.0, 8.0).with_soft(0.0, 4.0))
        .unit("octaves"),
        PortSpec::new(
            "waves",
            PortType::Exactly(Type::Integer),
            Default::Integer(32),
            "How many cosines are summed; the cost grows with it.",
        )
        .uniform()
        .range(Range::hard(4.0, 256.0).with_soft(8.0, 64.0))
        .unit("count"),
        AMPLITUDE,
        PIVOT,
        SEED,
    ],
    output: OutputType::Exactly(Type::Float),
    class: |_| Behaviour::Gaussian { deviation: 0.0029 },
    example: r#"{ "version": 1, "name": "ripples",
        "nodes": { "spectralnoise2d": { "type": "spectralnoise2d", "inputs": { "frequency": 8, "bandwidth": 0.5, "pivot": 0.5 } } },
        "outputs": { "out": { "node": "spectralnoise2d" } } }"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef {
    spec: &SPEC,
    lower: |lower, node| {
        let spectrum = Spectrum {
            waves: lower.integer(node, "waves") as u32,
            bandwidth: lower.float(node, "bandwidth"),
            seed: lower.integer(node, "seed"),
        };
        let position = position(lower, node);
        let field = spectral::filtered(lower, &position, spectrum);
        shaped(lower, node, &field, 1.0, &position)
    },
};
