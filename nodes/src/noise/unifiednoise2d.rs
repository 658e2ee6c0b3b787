//! `unifiednoise2d`: one node for the noises that are used most.

use crate::componentwise::{product, sum};
use crate::noise::affine::Affine;
use crate::noise::cell;
use crate::noise::kernel::Kernel;
use crate::noise::noise2d::one_octave;
use crate::noise::octaves::{DIMINISH, LACUNARITY, OCTAVES, octaves};
use crate::noise::source::{EXTENT, SEED, TEXCOORD};
use crate::noise::worley::{self, Output, Worley};
use crate::port;
use mipless_codegen::moments::{Piecewise, Signal};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType, Range, Reach, Type,
};

/// max |CDF − Φ| of the quadrupole lattice noise, and of octaves of it.
const DEVIATION: f32 = 0.0046;

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "unifiednoise2d",
    aliases: &["noise_texture", "unifiednoise"],
    category: Category::Noise,
    summary: "Perlin, cell, Worley or fractal noise, remapped to a range.",
    doc: Doc {
        computes: "With p = texcoord · freq + offset: raw = ½ + ½ `noise2d`(p) (`perlin`), \
            `cellnoise2d`(p) (`cell`), `worleynoise2d`(p) (`worley`) or `fractal2d`(p) (`fractal`, around \
            0), each as its own page says; out = outmin + raw · (outmax − outmin), limited to [outmin, \
            outmax] where clampoutput. MaterialX numbers the types from 0 to 3; here they have \
            names, `jitter` moves Worley's points alone, and `seed` selects the noise.",
        statistics: "Those of the noise that is chosen, with its spectrum. Before outmin and outmax: mean ½ \
            and standard deviation 1/8 (`perlin`), mean 0 and standard deviation ¼ √Σ diminish²ᵏ \
            (`fractal`), mean ½ and variance 1/12 (`cell`), those of `worleynoise2d` (`worley`). The \
            range is outmin to outmax: a clamp in closed form, which takes half of a fractal noise away; \
            it is that of the noise where clampoutput is off.",
        accuracy: "That of `noise2d`, `cellnoise2d`, `worleynoise2d` and `fractal2d`, whose code it shares. \
            Held by `nodes/src/tests/channel.rs`.",
        references: "MaterialX 1.39 specification, node `unifiednoise2d`. Perlin 2002, *Improving Noise*; \
            Worley 1996, *A cellular texture basis function*.",
    },
    inputs: &[
        TEXCOORD,
        port::choice(
            "type",
            &["perlin", "cell", "worley", "fractal"],
            "perlin",
            "Which noise.",
        ),
        port::pair(
            "freq",
            [1.0, 1.0],
            "How many cells fit a unit of the texture space, along u and along v.",
        )
        .range(Range::soft(0.25, 64.0))
        .unit("cells per uv"),
        port::pair("offset", [0.0, 0.0], "The shift, which is added.")
            .range(Range::soft(-1.0, 1.0))
            .unit("cells"),
        port::number(
            "jitter",
            1.0,
            "How far Worley's points leave the centres of their cells.",
        )
        .uniform()
        .range(Range::hard(0.0, 1.0)),
        port::choice(
            "style",
            &["distance", "solid"],
            "distance",
            "Worley's distances, or a random number for each region.",
        ),
        port::number("outmin", 0.0, "What 0 becomes."),
        port::number("outmax", 1.0, "What 1 becomes."),
        port::flag(
            "clampoutput",
            true,
            "Whether the result is limited to [outmin, outmax].",
        )
        .uniform(),
        OCTAVES,
        LACUNARITY,
        DIMINISH,
        SEED,
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |inputs| {
        if inputs.flag("clampoutput") {
            inputs.reach("outmin").hull(inputs.reach("outmax"))
        } else {
            Reach::ANY
        }
    },
    class,
    example: r#"{ "version": 1, "name": "leather",
        "nodes": { "unifiednoise2d": { "type": "unifiednoise2d", "inputs": { "type": "worley", "freq": [8, 6], "outmin": 1, "outmax": 0 } } },
        "outputs": { "out": { "node": "unifiednoise2d" } } }"#,
};

fn class(inputs: &dyn InputView) -> Behaviour {
    match (inputs.choice("type"), inputs.flag("clampoutput")) {
        ("cell", _) => Behaviour::Random { deviation: 0.058 },
        ("worley", _) if inputs.choice("style") == "solid" => {
            Behaviour::Random { deviation: 0.058 }
        }
        ("worley", _) => Behaviour::Random { deviation: 0.04 },
        // Half of it is the number at the limit.
        ("fractal", true) => Behaviour::Random { deviation: 0.5 },
        // The limits are four standard deviations away.
        _ => Behaviour::Gaussian {
            deviation: DEVIATION,
        },
    }
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let [texcoord, freq, offset] =
        ["texcoord", "freq", "offset"].map(|port| lower.bundle(node, port));
    let position: Vec<Signal<'b>> = (0..2)
        .map(|i| sum(&product(lower, &texcoord[i], &freq[i]), &offset[i]))
        .collect();
    let raw = raw(lower, node, &position);
    let [low, high] = ["outmin", "outmax"].map(|port| lower.number(node, port));
    let out = (raw * (high - low)).offset(low);
    if !lower.flag(node, "clampoutput") {
        return vec![out];
    }
    let clamp = Piecewise::clamp(low.min(high), low.max(high));
    vec![lower.algebra.transfer(&out, &clamp)]
}

/// The noise that is chosen, before it is remapped.
fn raw<'b>(lower: &mut Lower<'_, 'b>, node: &Node, position: &[Signal<'b>]) -> Signal<'b> {
    let seed = lower.integer(node, "seed");
    match lower.choice(node, "type") {
        "cell" => cell::filtered(lower, position, seed, 0).swap_remove(0),
        "worley" => {
            let worley = Worley {
                jitter: lower.float(node, "jitter"),
                solid: lower.choice(node, "style") == "solid",
                output: Output::First,
                period: 0,
                seed,
            };
            worley::filtered(lower, position, worley).swap_remove(0)
        }
        kind => {
            let (octaves, factor, pivot) = match kind {
                "fractal" => (octaves(lower, node), 0.25, 0.0),
                _ => (one_octave(seed, 0), 0.125, 0.5),
            };
            Kernel::Gaussian.report(lower, position, octaves);
            let extent = factor * EXTENT * octaves.sd();
            let shape = Affine {
                amplitude: lower.b().float(factor),
                pivot: lower.b().float(pivot),
            };
            let signal = Kernel::Gaussian.signal(lower, position, octaves, shape);
            signal.with_range([pivot - extent, pivot + extent])
        }
    }
}
