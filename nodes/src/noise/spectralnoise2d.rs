//! `spectralnoise2d`: a sum of cosines with random phases.

use crate::noise::source::{AMPLITUDE, PIVOT, SEED, TEXCOORD, position, practical, shaped};
use crate::noise::spectral::{self, Density, FARTHEST, Spectrum};
use crate::port;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Range, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "spectralnoise2d",
    aliases: &["spectral noise", "random phase noise", "cosines"],
    category: Category::Noise,
    summary: "Cosines with random phases, of any spectrum: every moment is exact.",
    doc: Doc {
        computes: "pivot + amplitude/4 · Σ a_i cos(2π f_i · p + φ_i), p = frequency · texcoord, \
            Σ a_i²/2 = 1, with directions spread evenly. By `spectrum`: `band`: |f_i| within \
            2^(±bandwidth/2) of 1, equal in every octave, a_i equal; `power`: the same frequencies \
            with a_i ∝ |f_i|^−falloff, a power spectral density of |f|^(−2 falloff − 2); `list`: the \
            frequencies and amplitudes of `lines`, each line of as many waves as its share of the \
            variance, at least one.",
        statistics: "Mean `pivot`, standard deviation amplitude/4; the noise repeats after 1024 periods of \
            `frequency`. With n = (Σ a²)²/Σ a⁴, the number \
            of equal waves with the same fourth cumulant, max |CDF − Φ| is 0.044/n: 0.0014 for a \
            band of 32 waves. The range is amplitude/4 · √(2n) at most for equal waves. The spectrum is a line at the frequency of each wave. With \
            w = 2πf and q = wᵀΣw each wave is damped by e^{−q/2}; gradient and Hessian are its \
            derivatives, and the remainder is Σ a²/2 (1 − e^{−q} Σ_k qᵏ/k!); by `local`, the part of it that the value foretells of \
            the Hessian, ½‖E[ggᵀ]‖² M²/F² with F = E[M²], takes its local value. No three waves nearly \
            close a triangle, which would lock their phases.",
        accuracy: "Mean, gradient, Hessian and ensemble variance are exact, to f32 rounding. The local \
            standard deviation of one octave is within 0.005, 0.02 and 0.06 (`local`), 0.001, 0.003 \
            and 0.02 (`quad`) of the true one, in the mean, at footprints of 0.02, 0.05 and 0.1 \
            wavelengths. Held by `nodes/tests/noise.rs`; all sizes in `tests/benches/sources.rs`.",
        references: "Bruneton & Neyret 2012 §2.2; Hermite–Parseval identity.",
    },
    inputs: &[
        TEXCOORD,
        port::number("frequency", 1.0, "The centre of the band.")
            .range(Range::soft(0.25, 64.0))
            .unit("cycles per uv"),
        port::number(
            "bandwidth",
            1.0,
            "How wide the band is, for `band` and `power`.",
        )
        .uniform()
        .range(Range::hard(0.0, 8.0).with_soft(0.0, 4.0))
        .unit("octaves"),
        port::integer(
            "waves",
            32,
            "How many cosines are summed; the cost grows with it.",
        )
        .uniform()
        .range(Range::hard(4.0, 256.0).with_soft(8.0, 64.0))
        .unit("count"),
        AMPLITUDE,
        PIVOT,
        SEED,
        port::choice(
            "spectrum",
            &["band", "power", "list"],
            "band",
            "Which frequencies there are.",
        ),
        port::number(
            "falloff",
            1.0,
            "For `power`: amplitudes fall as the frequency to minus this.",
        )
        .uniform()
        .range(Range::hard(-4.0, 4.0).with_soft(0.0, 2.0)),
        PortSpec::new(
            "lines",
            PortType::Stops,
            Default::Stops(&[(1.0, 1.0)]),
            "For `list`: amplitudes at multiples of `frequency` from 1/16 to 16, relative to one \
                another; of a colour, the mean.",
        )
        .range(Range::hard(1.0 / FARTHEST, FARTHEST)),
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |inputs| practical(inputs, 1.0),
    class,
    example: r#"{ "version": 1, "name": "ripples",
        "nodes": { "spectralnoise2d": { "type": "spectralnoise2d", "inputs": { "frequency": 8, "bandwidth": 0.5, "pivot": 0.5 } } },
        "outputs": { "out": { "node": "spectralnoise2d" } } }"#,
};

/// The spectrum that the uniform ports describe.
fn spectrum(choice: &str, number: &dyn Fn(&str) -> f32, lines: Vec<[f32; 2]>) -> Spectrum {
    let octaves = number("bandwidth");
    let density = match choice {
        "list" => Density::Lines(lines),
        "power" => Density::Power {
            octaves,
            falloff: number("falloff"),
        },
        _ => Density::Power {
            octaves,
            falloff: 0.0,
        },
    };
    Spectrum {
        count: number("waves") as u32,
        density,
        seed: 0,
    }
}

fn class(inputs: &dyn InputView) -> Behaviour {
    let choice = inputs.choice("spectrum");
    let spectrum = spectrum(choice, &|port| inputs.number(port), inputs.stops("lines"));
    Behaviour::Gaussian {
        deviation: spectrum.deviation(),
    }
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let choice = lower.choice(node, "spectrum");
    let lines = lower.stops(node, "lines").means();
    let spectrum = Spectrum {
        seed: lower.integer(node, "seed"),
        ..spectrum(choice, &|port| lower.float(node, port), lines)
    };
    let position = position(lower, node);
    let field = spectral::filtered(lower, &position, &spectrum);
    shaped(lower, node, &field, &position, |lower| {
        spectral::steepness(lower, &position, &spectrum)
    })
}
