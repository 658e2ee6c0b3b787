//! Parallel stripes.

use mipless_codegen::moments::SquareWave;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Range, Type,
};

use crate::componentwise::{product, sum, transfer};
use crate::coordinate::rotate2d::turn;

static SPEC: NodeSpec = NodeSpec {
    name: "stripes",
    aliases: &["bands", "lines"],
    category: Category::Pattern,
    summary: "Parallel stripes of 0 and 1.",
    doc: Doc {
        computes: "out = 1 where the fraction of (u cos r + v sin r) · frequency is below width, else \
            0, with r = rotate. With a rotation of 0 the stripes run along v.",
        statistics: "A square wave of a Gaussian phase in closed form: Φ at the nearest two edges up to a \
            standard deviation of 0.11 periods, six damped Fourier harmonics beyond; variance \
            P(1 − P). Exact for a position. Over a large footprint the mean is width. Of a \
            varying width the mean is used.",
        accuracy: "For a Gaussian phase the mean is within 5e-6. Held by `codegen/src/moments/tests.rs` \
            against dense numerical integration in f64.",
        references: "Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8. Bussgang \
            1952, *Crosscorrelation functions of amplitude-distorted Gaussian signals*; Stein \
            1981, *Estimation of the mean of a multivariate normal distribution*, lemma 1.",
    },
    inputs: &[
        PortSpec::new(
            "texcoord",
            PortType::Exactly(Type::Vector2),
            Default::Surface,
            "The coordinates.",
        )
        .unit("uv"),
        PortSpec::new(
            "frequency",
            PortType::Exactly(Type::Float),
            Default::Float(8.0),
            "How many stripes.",
        )
        .range(Range::soft(1.0, 64.0))
        .unit("cycles per uv"),
        PortSpec::new(
            "rotate",
            PortType::Exactly(Type::Float),
            Default::Float(0.0),
            "The angle from the u axis to the direction across the stripes, counter-clockwise.",
        )
        .range(Range::soft(-180.0, 180.0))
        .unit("degrees"),
        PortSpec::new(
            "width",
            PortType::Exactly(Type::Float),
            Default::Float(0.5),
            "The share of the period that is 1.",
        )
        .range(Range::hard(0.0, 1.0)),
    ],
    output: OutputType::Exactly(Type::Float),
    class,
    example: r#"{
  "version": 1,
  "name": "stripes_example",
  "nodes": {
    "stripes": { "type": "stripes", "inputs": { "frequency": 12, "rotate": 30, "width": 0.35 } }
  },
  "outputs": { "out": { "node": "stripes" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// A function of position alone, unless a parameter varies.
fn class(inputs: &dyn InputView) -> Behaviour {
    let other = ["frequency", "rotate", "width"]
        .into_iter()
        .any(|port| inputs.varies(port));
    if other {
        Behaviour::Function
    } else {
        Behaviour::Pattern
    }
}

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let texcoord = lower.bundle(node, "texcoord");
    let [frequency, rotate] = ["frequency", "rotate"].map(|port| lower.signal(node, port));
    let width = lower.number(node, "width");
    let [cosine, sine] = turn(lower, &rotate);
    let (along, across) = (
        product(lower, &texcoord[0], &cosine),
        product(lower, &texcoord[1], &sine),
    );
    let distance = sum(lower, &along, &across);
    let phase = product(lower, &distance, &frequency);
    let b = lower.b();
    let width = b.clamp(width, 0.0, 1.0);
    vec![transfer(lower, &phase, &SquareWave { width })]
}
