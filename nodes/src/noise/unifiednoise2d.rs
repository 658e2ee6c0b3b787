//! `unifiednoise2d`: one node for the noises that are used most.

use crate::componentwise::{product, sum};
use crate::coordinate::rotate2d::rotated;
use crate::noise::affine::Affine;
use crate::noise::cell::{self, Content, Lattice};
use crate::noise::components::{HASH, Hash};
use crate::noise::kernel::Kernel;
use crate::noise::noise2d::{MATERIALX, one_octave};
use crate::noise::noise3d;
use crate::noise::octaves::{DIMINISH, LACUNARITY, OCTAVES, octaves};
use crate::noise::perlin::Kind;
use crate::noise::source::{EXTENT, SEED, TEXCOORD};
use crate::noise::sum::Octaves;
use crate::noise::volume;
use crate::noise::worley::{self, Output, Worley};
use crate::port;
use mipless_codegen::moments::{Piecewise, Signal};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, Range, Reach, Type,
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
            outmax] where clampoutput. With the hash `materialx` p is turned, but for \
            `worley`, by (jitter − 1) · 90000 degrees, and `fractal` is the slice of `fractal3d` at \
            that height, as in MaterialX; else `jitter` moves Worley's points alone.",
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
        TYPE,
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
        JITTER,
        STYLE,
        OUTMIN,
        OUTMAX,
        CLAMPOUTPUT,
        OCTAVES,
        LACUNARITY,
        DIMINISH,
        SEED,
        HASH,
    ],
    output: OutputType::Exactly(Type::Float),
    reach,
    class,
    example: r#"{ "version": 1, "name": "leather",
        "nodes": { "unifiednoise2d": { "type": "unifiednoise2d", "inputs": { "type": "worley", "freq": [8, 6], "outmin": 1, "outmax": 0 } } },
        "outputs": { "out": { "node": "unifiednoise2d" } } }"#,
};

/// Which noise, counted as MaterialX does.
pub(crate) const TYPE: PortSpec = port::choice(
    "type",
    &["perlin", "cell", "worley", "fractal"],
    "perlin",
    "Which noise.",
);

/// How irregular.
pub(crate) const JITTER: PortSpec = port::number(
    "jitter",
    1.0,
    "How far Worley's points leave the centres of their cells.",
)
.uniform()
.range(Range::hard(0.0, 1.0));

/// What Worley's noise is.
pub(crate) const STYLE: PortSpec = port::choice(
    "style",
    &["distance", "solid"],
    "distance",
    "Worley's distances, or a random number for each region.",
);

/// Where the range begins.
pub(crate) const OUTMIN: PortSpec = port::number("outmin", 0.0, "What 0 becomes.");

/// Where it ends.
pub(crate) const OUTMAX: PortSpec = port::number("outmax", 1.0, "What 1 becomes.");

/// Whether it ends there.
pub(crate) const CLAMPOUTPUT: PortSpec = port::flag(
    "clampoutput",
    true,
    "Whether the result is limited to [outmin, outmax].",
)
.uniform();

/// By how many degrees MaterialX turns all but Worley's noise, times what jitter lacks of 1.
pub(crate) const TURN: f32 = 90_000.0;

/// What the result lies between.
pub(crate) fn reach(inputs: &dyn InputView) -> Reach {
    if inputs.flag("clampoutput") {
        inputs.reach("outmin").hull(inputs.reach("outmax"))
    } else {
        Reach::ANY
    }
}

/// The class of the noise that is chosen.
pub(crate) fn class(inputs: &dyn InputView) -> Behaviour {
    match (inputs.choice("type"), inputs.flag("clampoutput")) {
        ("cell", _) => Behaviour::Random { deviation: 0.058 },
        ("worley", _) if inputs.choice("style") == "solid" => {
            Behaviour::Random { deviation: 0.058 }
        }
        ("worley", _) => Behaviour::Random { deviation: 0.04 },
        // Half of it is the number at the limit.
        ("fractal", true) => Behaviour::Random { deviation: 0.5 },
        // MaterialX's limits are three standard deviations away, the others four.
        _ => Behaviour::Gaussian {
            deviation: match inputs.choice("hash") {
                "materialx" => 0.016,
                _ => DEVIATION,
            },
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
    remapped(lower, node, &raw)
}

/// The noise in the range that is asked for.
pub(crate) fn remapped<'b>(lower: &mut Lower<'_, 'b>, node: &Node, raw: &Signal<'b>) -> Bundle<'b> {
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
    let (seed, hash) = (lower.integer(node, "seed"), Hash::of(lower, node));
    let jitter = lower.float(node, "jitter");
    // MaterialX turns, or lifts, what has no jitter of its own.
    let lacking = match hash {
        Hash::Mipless => 0.0,
        Hash::Materialx => (jitter - 1.0) * TURN,
    };
    let turned = |lower: &mut Lower<'_, 'b>| {
        let angle = Signal::constant(lower.b(), -lacking);
        rotated(lower, [&position[0], &position[1]], &angle)
    };
    match lower.choice(node, "type") {
        "cell" => {
            let lattice = Lattice {
                seed,
                period: 0,
                hash,
            };
            let position = &turned(lower);
            cell::filtered(lower, position, Content::InPlane(lattice)).swap_remove(0)
        }
        "worley" => {
            let worley = Worley {
                jitter,
                solid: lower.choice(node, "style") == "solid",
                output: Output::First,
                period: 0,
                seed,
                hash,
                channel: None,
                space: false,
            };
            let farthest = if worley.solid { 1.0 } else { 3.6 };
            worley::filtered(lower, position, worley, [0.0, farthest]).swap_remove(0)
        }
        // MaterialX's fractal noise is a slice of the one in space.
        "fractal" if hash == Hash::Materialx => {
            let octaves = Octaves {
                hash,
                ..octaves(lower, node)
            };
            let height = Signal::constant(lower.b(), lacking);
            let position = [position[0].clone(), position[1].clone(), height];
            let kind = volume::Kind::Materialx(0);
            let unit = volume::filtered(lower, &position, kind, octaves);
            let extent = EXTENT * octaves.sd();
            unit.with_range([-extent, extent]) * (noise3d::MATERIALX / kind.unit())
        }
        kind => {
            let (octaves, factor, pivot) = match kind {
                "fractal" => (octaves(lower, node), 0.25, 0.0),
                _ => (one_octave(seed, 0), 0.125, 0.5),
            };
            let octaves = Octaves { hash, ..octaves };
            let (kernel, factor) = match hash {
                Hash::Mipless => (Kernel::Gaussian, factor),
                Hash::Materialx => {
                    let kind = Kind::Materialx(0);
                    (Kernel::Quintic(kind), 0.5 * MATERIALX * kind.deviation())
                }
            };
            let position = &turned(lower);
            kernel.report(lower, position, octaves);
            let extent = factor * EXTENT * octaves.sd();
            let shape = Affine {
                amplitude: lower.b().float(factor),
                pivot: lower.b().float(pivot),
            };
            let signal = kernel.signal(lower, position, octaves, shape);
            signal.with_range([pivot - extent, pivot + extent])
        }
    }
}
