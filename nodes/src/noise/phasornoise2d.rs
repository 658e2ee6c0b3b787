//! `phasornoise2d`: a profile of the phase of a complex Gabor field.

use crate::noise::gabor;
use crate::noise::gabornoise2d::{
    ANISOTROPY, BANDWIDTH, FREQUENCY, IMPULSES, ORIENTATION, PERIOD, cells, described, orientation,
};
use crate::noise::phasor::phase;
use crate::noise::source::{AMPLITUDE, PIVOT, SEED, TEXCOORD};
use crate::port;
use mipless_codegen::moments::{LinearWave, Sine, SquareWave};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, Reach, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "phasornoise2d",
    aliases: &["phasor", "phasor noise"],
    category: Category::Noise,
    summary: "Waves of one amplitude whose phase wanders: contrast never fades.",
    doc: Doc {
        computes: "pivot + amplitude/2 · T(φ), φ = arg Σ e^{−d·d/2a²} e^{i(2π n·d + φ_k)} over the \
            impulses of `gabornoise2d`, and T a wave between −1 and 1 by `profile`: the sine of φ, a \
            triangle with its corners where the sine has its extremes, a sawtooth rising from −1 at \
            φ = 0, or the sign of the sine.",
        statistics: "Over a footprint the phase is taken for Gaussian: of mean arg m with m the \
            filtered complex field, of gradient Im(∇m/m), and of a further variance −2 ln R(s), \
            R = √(πs)/2 e^{−s/2}(I₀ + I₁)(s/2), where s is the ratio of the power of the turning \
            mean to the variance around it: the first harmonic of a noncentral complex Gaussian. \
            The profile then is a transfer of the phase: sin, or the piecewise linear wave, with its \
            mean, slope and distortion. Mean `pivot` over the plane, and standard deviation \
            amplitude/2 times √½ (sine), 1/√3 (triangle, sawtooth) or 1 (square). It is not Gaussian: \
            max |CDF − Φ| is 0.098 (sine), 0.058 (triangle, sawtooth) or 0.342 (square). The range is pivot ± amplitude/2. The \
            spectrum has the band around `frequency`, and its harmonics by the profile.",
        accuracy: "The phase around a zero of the field is not Gaussian. For one octave and one \
            direction the filtered mean is within 0.08, 0.06, 0.11, 0.18 and 0.09 standard deviations \
            of the noise (root mean square) at footprints of 0.02, 0.05, 0.1, 0.2 and 0.5 wavelengths, \
            and the local standard deviation within 0.08, 0.09, 0.12, 0.09 and 0.04 of the true one in \
            the mean; at 8:1 of the same area the mean is within 0.19. Held by \
            `nodes/tests/sources.rs`; all sizes in `tests/benches/sources.rs`.",
        references: "Tricard, Efremov, Zanni, Neyret, Martínez & Lefebvre 2019, *Procedural phasor \
            noise*, eq. 3–6; Abramowitz & Stegun 11.4.28 (the phase of a noncentral Gaussian); \
            Bruneton & Neyret 2012 §2.2; Bussgang 1952 for the profile.",
    },
    inputs: &[
        TEXCOORD,
        FREQUENCY,
        BANDWIDTH,
        ORIENTATION,
        PortSpec {
            default: Default::Float(1.0),
            ..ANISOTROPY
        },
        IMPULSES,
        port::choice(
            "profile",
            &["sine", "triangle", "sawtooth", "square"],
            "sine",
            "The wave.",
        ),
        AMPLITUDE_OF_WAVE,
        PIVOT,
        SEED,
        PERIOD,
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |inputs| inputs.reach("pivot") + inputs.reach("amplitude") * Reach::of(-0.5, 0.5),
    class,
    example: r#"{ "version": 1, "name": "ridges",
        "nodes": { "phasornoise2d": { "type": "phasornoise2d", "inputs": { "frequency": 10, "orientation": 25, "profile": "triangle", "pivot": 0.5 } } },
        "outputs": { "out": { "node": "phasornoise2d" } } }"#,
};

/// How strong.
const AMPLITUDE_OF_WAVE: PortSpec = PortSpec {
    doc: "The distance between the least and the largest value.",
    ..AMPLITUDE
};

/// max |CDF − Φ| of an arcsine, a uniform and a two-valued distribution.
fn class(inputs: &dyn InputView) -> Behaviour {
    let deviation = match inputs.choice("profile") {
        "square" => 0.342,
        "triangle" | "sawtooth" => 0.058,
        _ => 0.098,
    };
    Behaviour::Random { deviation }
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let gabor = described(lower, node);
    let position = cells(lower, node, gabor);
    let orientation = orientation(lower, node);
    let fields = gabor::filtered(lower, &position, gabor, orientation, true);
    let phase = phase(lower, &fields[0], &fields[1], &position);
    let profile = lower.choice(node, "profile");
    let algebra = &mut lower.algebra;
    let wave = match profile {
        "square" => {
            let width = algebra.b.float(0.5);
            (algebra.transfer(&phase, &SquareWave { width }) * 2.0).offset(-1.0)
        }
        "triangle" => {
            let corners = [(0.25, 1.0), (0.75, -1.0)];
            algebra.transfer(&phase, &LinearWave::through(&corners))
        }
        "sawtooth" => (algebra.transfer(&phase, &LinearWave::sawtooth()) * 2.0).offset(-1.0),
        _ => algebra.transfer(&(phase * std::f32::consts::TAU), &Sine { phase: 0.0 }),
    };
    let [amplitude, pivot] = ["amplitude", "pivot"].map(|port| lower.signal(node, port));
    vec![lower.algebra.product(&wave, &(amplitude * 0.5)) + pivot]
}
