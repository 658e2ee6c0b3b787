//! `unifiednoise3d`: one node for the noises in space that are used most.

use crate::componentwise::{product, sum};
use crate::coordinate::rotate3d::turned;
use crate::noise::cell::{Lattice, space};
use crate::noise::components::{HASH, Hash};
use crate::noise::noise2d::one_octave;
use crate::noise::noise3d::MATERIALX;
use crate::noise::octaves::{DIMINISH, LACUNARITY, OCTAVES, octaves};
use crate::noise::source::{EXTENT, POSITION, SEED};
use crate::noise::sum::Octaves;
use crate::noise::unifiednoise2d::{
    CLAMPOUTPUT, JITTER, OUTMAX, OUTMIN, STYLE, TURN, TYPE, class, reach, remapped,
};
use crate::noise::volume::{self, Kind};
use crate::noise::worley::{self, Output, Worley};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "unifiednoise3d",
    aliases: &["noise_texture_3d", "unifiednoise_3d"],
    category: Category::Noise,
    summary: "Perlin, cell, Worley or fractal noise in space, remapped to a range.",
    doc: Doc {
        computes: "As `unifiednoise2d` with p = position · freq + offset and the nodes `noise3d`, \
            `cellnoise3d`, `worleynoise3d` and `fractal3d`. With the hash `materialx` p is first turned, \
            but for `worley`, by (jitter − 1) · 90000 degrees around (0.1, 1, 0), as MaterialX does.",
        statistics: "Those of the noise that is chosen, in space, with its spectrum. Before outmin and \
            outmax mean and variance are those that `unifiednoise2d` states for its kinds. The range is \
            outmin to outmax, a clamp in closed form, or that of the noise where clampoutput is off.",
        accuracy: "That of `noise3d`, `cellnoise3d`, `worleynoise3d` and `fractal3d`, whose code it \
            shares. At a point held by `tests/tests/parity.rs`.",
        references: "MaterialX 1.39 specification, node `unifiednoise3d`. Perlin 2002, *Improving \
            Noise*; Worley 1996, *A cellular texture basis function*.",
    },
    inputs: &[
        POSITION,
        TYPE,
        triple(
            "freq",
            1.0,
            "How many cells fit a unit of space, along each axis.",
        )
        .range(Range::soft(0.25, 64.0))
        .unit("cells per unit of space"),
        triple("offset", 0.0, "The shift, which is added.")
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
    example: r#"{ "version": 1, "name": "pumice",
        "nodes": { "unifiednoise3d": { "type": "unifiednoise3d", "inputs": { "type": "worley", "freq": 6, "outmin": 1, "outmax": 0 } } },
        "outputs": { "out": { "node": "unifiednoise3d" } } }"#,
};

const fn triple(name: &'static str, default: f32, doc: &'static str) -> PortSpec {
    let ty = PortType::Exactly(Type::Vector3);
    PortSpec::new(name, ty, Default::Float(default), doc)
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let [position, freq, offset] =
        ["position", "freq", "offset"].map(|port| lower.bundle(node, port));
    let position: Vec<Signal<'b>> = (0..3)
        .map(|i| sum(&product(lower, &position[i], &freq[i]), &offset[i]))
        .collect();
    let raw = raw(lower, node, position);
    remapped(lower, node, &raw)
}

/// The noise that is chosen, before it is remapped.
fn raw<'b>(lower: &mut Lower<'_, 'b>, node: &Node, mut position: Vec<Signal<'b>>) -> Signal<'b> {
    let (seed, hash) = (lower.integer(node, "seed"), Hash::of(lower, node));
    let kind = lower.choice(node, "type").to_owned();
    let jitter = lower.float(node, "jitter");
    if hash == Hash::Materialx && jitter != 1.0 && kind != "worley" {
        let axis = [0.1, 1.0, 0.0].map(|x| lower.b().float(x));
        let angle = Signal::constant(lower.b(), (jitter - 1.0) * TURN);
        position = turned(lower, &position, &angle, &axis);
    }
    match &kind[..] {
        "cell" => {
            let lattice = Lattice {
                seed,
                period: 0,
                hash,
            };
            space::filtered(lower, &position, lattice).swap_remove(0)
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
                space: true,
            };
            let farthest = if worley.solid { 1.0 } else { 3.6 };
            worley::space::filtered(lower, &position, worley).with_range([0.0, farthest])
        }
        kind => {
            let (octaves, half) = match kind {
                "fractal" => (octaves(lower, node), false),
                _ => (one_octave(seed, 0), true),
            };
            let octaves = Octaves { hash, ..octaves };
            let (kernel, factor) = match hash {
                Hash::Mipless => (Kind::Quadrupole, 0.25),
                Hash::Materialx => {
                    let kind = Kind::Materialx(0);
                    (kind, MATERIALX / kind.unit())
                }
            };
            let unit = volume::filtered(lower, &position, kernel, octaves);
            let extent = EXTENT * octaves.sd();
            let unit = unit.with_range([-extent, extent]);
            if half {
                (unit * (0.5 * factor)).offset(0.5)
            } else {
                unit * factor
            }
        }
    }
}
