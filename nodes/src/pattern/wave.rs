//! Parallel waves.

use crate::componentwise::{product, sum, transfer};
use crate::coordinate::rotate2d::turn;
use crate::noise::field::Spread;
use crate::pattern::grid::TEXCOORD;
use mipless_codegen::moments::{LinearWave, Signal, Sine, SquareWave};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
    name: "wave",
    aliases: &["wave_texture", "pattern", "x_wave", "y_wave", "waveform"],
    category: Category::Pattern,
    summary: "Parallel waves between 0 and 1: sine, triangle, saw or square.",
    doc: Doc {
        computes: "With the phase p = (u cos r + v sin r) · frequency + phase, r = rotate: out = ½ − ½ cos \
            2πp (`sine`), 1 − |2 fract p − 1| (`triangle`), fract p (`saw`) or 1 where fract p < ½ and 0 \
            elsewhere (`square`). With a rotation of 0 the crests run along v. Material Maker's \
            *pattern* is the product, sum, maximum or minimum of two.",
        statistics: "Waves of a Gaussian phase in closed form: a damped cosine; pieces that are straight, one \
            by one up to a standard deviation of 0.2 periods and as three damped harmonics beyond. Exact \
            for a position; over a large footprint the mean is ½.",
        accuracy: "For a Gaussian phase the mean is within 5e-6. Held by `codegen/src/moments/tests.rs` \
            and `nodes/src/pattern/tests.rs` against dense sums.",
        references: "Abramowitz & Stegun 1964, 26.2. Heckbert 1989, *Fundamentals of Texture Mapping and \
            Image Warping*, §3.5.8. Bussgang 1952, *Crosscorrelation functions of amplitude-distorted \
            Gaussian signals*.",
    },
    inputs: &[
        TEXCOORD,
        PortSpec::new(
            "shape",
            PortType::Choice(&["sine", "triangle", "saw", "square"]),
            Default::Choice("sine"),
            "The form of the wave.",
        ),
        PortSpec::new(
            "frequency",
            PortType::Exactly(Type::Float),
            Default::Float(8.0),
            "How many waves.",
        )
        .range(Range::soft(1.0, 64.0))
        .unit("cycles per uv"),
        PortSpec::new(
            "rotate",
            PortType::Exactly(Type::Float),
            Default::Float(0.0),
            "The angle from the u axis to the direction across the waves, counter-clockwise.",
        )
        .range(Range::soft(-180.0, 180.0))
        .unit("degrees"),
        PortSpec::new(
            "phase",
            PortType::Exactly(Type::Float),
            Default::Float(0.0),
            "What is added to the phase; a noise makes the waves wind.",
        )
        .range(Range::soft(-1.0, 1.0))
        .unit("cycles"),
    ],
    output: OutputType::Exactly(Type::Float),
    class,
    example: r#"{
  "version": 1,
  "name": "wave_example",
  "nodes": {
    "wind": { "type": "noise2d", "inputs": { "frequency": 4 } },
    "wave": { "type": "wave", "inputs": { "shape": "triangle", "frequency": 10, "rotate": 60, "phase": { "node": "wind" } } }
  },
  "outputs": { "out": { "node": "wave" } }
}"#,
};

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// A function of position alone, unless a parameter varies.
fn class(inputs: &dyn InputView) -> Behaviour {
    if ["frequency", "rotate", "phase"]
        .into_iter()
        .any(|port| inputs.varies(port))
    {
        Behaviour::Function
    } else {
        Behaviour::Pattern
    }
}

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let texcoord = lower.bundle(node, "texcoord");
    let [frequency, rotate, phase] =
        ["frequency", "rotate", "phase"].map(|port| lower.signal(node, port));
    let [cosine, sine] = turn(lower, &rotate);
    let (along, across) = (
        product(lower, &texcoord[0], &cosine),
        product(lower, &texcoord[1], &sine),
    );
    let distance = sum(lower, &along, &across);
    let place = product(lower, &distance, &frequency);
    let place = sum(lower, &place, &phase);
    // A sine has one wavelength; of a triangle √(E|∇|²/Var) is 2√12/2π times as much.
    let finer = match lower.choice(node, "shape") {
        "triangle" => 1.102_66,
        _ => 1.0,
    };
    let b = lower.b();
    let spread = Spread::of(b, &texcoord);
    let size = b.sqrt(spread.eigenvalues[0]);
    let waves = frequency.flat_mean(b);
    let waves = b.abs(waves);
    let detail = b.mul(size, waves);
    let detail = b.scale(detail, finer);
    lower.pattern_detail(detail);
    let wave = match lower.choice(node, "shape") {
        "triangle" => transfer(lower, &place, &LinearWave::triangle()),
        "saw" => transfer(lower, &place, &LinearWave::sawtooth()),
        "square" => {
            let width = lower.b().f32(0.5);
            transfer(lower, &place, &SquareWave { width })
        }
        _ => sine_of(lower, &place),
    };
    vec![wave]
}

/// ½ − ½ cos 2πp; whole turns are left out before they lose the fraction's digits.
fn sine_of(lower: &mut Lower<'_>, place: &Signal) -> Signal {
    let b = lower.b();
    let fraction = Signal {
        cell: None,
        ..place.clone()
    };
    let turn = b.f32(std::f32::consts::TAU);
    let angle = fraction.scale(b, turn);
    let wave = transfer(
        lower,
        &angle,
        &Sine {
            phase: -std::f32::consts::FRAC_PI_2,
        },
    );
    let b = lower.b();
    let half = b.f32(0.5);
    wave.scale(b, half).offset(b, half).with_range([0.0, 1.0])
}
