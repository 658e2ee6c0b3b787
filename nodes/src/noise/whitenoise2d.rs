//! `whitenoise2d`: a random number at every point.

use crate::noise::cell::{deviation, inside, lattice_seed, number};
use crate::noise::cellnoise2d::PERIOD;
use crate::noise::field::{Field, Spread};
use crate::noise::source::{FREQUENCY, SEED, TEXCOORD, position};
use crate::noise::things::VARIANCE;
use mipless_codegen::ir::{Sym2, Vec2};
use mipless_codegen::moments::Normal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, Range, Reach, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "whitenoise2d",
    aliases: &["white noise", "noise_white", "whitenoise", "static"],
    category: Category::Noise,
    summary: "A random number of [0, 1) at every point, down to a grain.",
    doc: Doc {
        computes: "out = the random number of the grain ⌊frequency · texcoord⌋, uniform in [0, 1) and \
            independent of the other grains'.",
        statistics: "Uniform: mean ½, variance 1/12, range [0, 1); not Gaussian (max |CDF − Φ| is \
            0.058). The spectrum is flat up to `frequency`. Over a footprint that holds the share K of \
            the point's own grain the mean is ½ + K(x − ½), and the variance is K(1 − K)(x − ½)² + \
            (1 − K)/12, all of it remainder: the other grains count with their ensemble. That a pixel \
            of many grains averages them is not in the mean.",
        accuracy: "A footprint of 0 gives the grain; from half a grain on the mean is ½ and the variance \
            1/12 less what the average over the footprint keeps, 1/(48πσ²) at σ grains. Held by \
            `nodes/tests/sources.rs`.",
        references: "Heckbert 1989, *Fundamentals of Texture Mapping and Image Warping*, §3.5.8 \
            (Gaussian footprints). For grains that are seen use `cellnoise2d`.",
    },
    inputs: &[
        TEXCOORD,
        PortSpec {
            default: Default::Float(1024.0),
            doc: "How many grains fit a unit of the texture space.",
            range: Range::soft(16.0, 65536.0),
            unit: "grains per uv",
            ..FREQUENCY
        },
        SEED,
        PortSpec {
            doc: "After how many grains the noise repeats in both directions; 0 for never.",
            unit: "grains",
            ..PERIOD
        },
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::of(0.0, 1.0),
    class: |_| Behaviour::Random { deviation: 0.058 },
    example: r#"{ "version": 1, "name": "grain",
        "nodes": { "whitenoise2d": { "type": "whitenoise2d", "inputs": { "frequency": 300 } } },
        "outputs": { "out": { "node": "whitenoise2d" } } }"#,
};

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let position = position(lower, node);
    let (seed, period) = (lower.integer(node, "seed"), lower.integer(node, "period"));
    let spread = Spread::of(&position);
    lower.source_footprint(spread.eigenvalues[0].sqrt());
    let b = lower.b();
    let seed = lattice_seed(b, seed, 0x3c6e_f372);
    let [(column, x), (row, y)] = [0, 1].map(|axis| position[axis].place());
    let value = number([column, row], seed, period);
    let zero = b.float(0.0);
    let mut field = Field {
        mean: value,
        gradient: Vec2::splat(zero),
        hessian: Sym2::splat(zero),
        rest: zero,
    };
    if lower.mode().filters() {
        // The share of the footprint that lies in the grain.
        let [s_xx, _, s_yy] = *spread.covariance;
        let [along_x, along_y] = [(x, s_xx), (y, s_yy)].map(|(fraction, variance)| {
            let [_, inverse] = deviation(variance);
            let fraction = inside(fraction, variance);
            let below = |edge| Normal::at(edge, inverse).below;
            below(1.0 - fraction) - below(-fraction)
        });
        let share = (along_x * along_y).clamp(0.0, 1.0);
        let off = value + -0.5;
        field.mean = share * off + 0.5;
        if lower.mode().spreads() {
            field.rest = (off.square() * share + VARIANCE) * (1.0 - share);
        }
    }
    vec![field.at(lower, &position).with_range([0.0, 1.0])]
}
