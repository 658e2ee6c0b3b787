//! Parallel waves.

use crate::componentwise::{product, sum, transfer};
use crate::noise::field::Spread;
use crate::pattern::grid::TEXCOORD;
use crate::pattern::stripes::along;
use crate::pattern::unless::pattern_unless;
use crate::port;
use mipless_codegen::moments::{LinearWave, Signal, Sine, SquareWave};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Category, Doc, Node, NodeSpec, OutputType, Range, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
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
        port::choice(
            "shape",
            &["sine", "triangle", "saw", "square"],
            "sine",
            "The form of the wave.",
        ),
        port::number("frequency", 8.0, "How many waves.")
            .range(Range::soft(1.0, 64.0))
            .unit("cycles per uv"),
        port::number(
            "rotate",
            0.0,
            "The angle from the u axis to the direction across the waves, counter-clockwise.",
        )
        .range(Range::soft(-180.0, 180.0))
        .unit("degrees"),
        port::number(
            "phase",
            0.0,
            "What is added to the phase; a noise makes the waves wind.",
        )
        .range(Range::soft(-1.0, 1.0))
        .unit("cycles"),
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::of(0.0, 1.0),
    class: |inputs| pattern_unless(inputs, &["frequency", "rotate", "phase"]),
    example: example! { "wave", r#"
    "wind": { "type": "noise2d", "inputs": { "frequency": 4 } },
    "wave": { "type": "wave", "inputs": { "shape": "triangle", "frequency": 10, "rotate": 60, "phase": { "node": "wind" } } }
"# },
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let texcoord = lower.bundle(node, "texcoord");
    let [frequency, rotate, phase] =
        ["frequency", "rotate", "phase"].map(|port| lower.signal(node, port));
    let distance = along(lower, &texcoord, &rotate);
    let place = sum(&product(lower, &distance, &frequency), &phase);
    let shape = lower.choice(node, "shape");
    // A sine has one wavelength; of a triangle √(E|∇|²/Var) is 2√12/2π times as much.
    let finer = match shape {
        "triangle" => 1.102_66,
        _ => 1.0,
    };
    let size = Spread::of(&texcoord).eigenvalues[0].sqrt();
    lower.pattern_detail(size * frequency.flat_mean().abs() * finer);
    let wave = match shape {
        "triangle" => transfer(lower, &place, &LinearWave::triangle()),
        "saw" => transfer(lower, &place, &LinearWave::sawtooth()),
        "square" => {
            let width = lower.b().float(0.5);
            transfer(lower, &place, &SquareWave { width })
        }
        _ => sine_of(lower, &place),
    };
    vec![wave]
}

/// ½ − ½ cos 2πp; whole turns are left out before they lose the fraction's digits.
fn sine_of<'b>(lower: &mut Lower<'_, 'b>, place: &Signal<'b>) -> Signal<'b> {
    let fraction = Signal {
        cell: None,
        ..place.clone()
    };
    let sine = Sine {
        phase: -std::f32::consts::FRAC_PI_2,
    };
    let wave = transfer(lower, &(fraction * std::f32::consts::TAU), &sine);
    (wave * 0.5).offset(0.5).with_range([0.0, 1.0])
}
