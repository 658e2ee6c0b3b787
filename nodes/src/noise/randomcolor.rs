//! `randomcolor`: a random colour for each number.

use crate::color::hsv::to_rgb;
use crate::noise::cell::line::{Line, ROUNDING, filtered};
use crate::noise::cell::{MOST, lattice_seed, number};
use crate::noise::components::{HASH, Hash};
use crate::noise::randomfloat::{IN, materialx, place};
use crate::noise::source::SEED;
use crate::noise::things::VARIANCE;
use mipless_codegen::ir::{Bool, Builder, Float, FunctionRef, Module, Operand, Scalars};
use mipless_codegen::{Bundle, Ensemble, Lower, pairs};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range,
    Reach, Type,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "randomcolor",
    aliases: &["random_color", "random_colour", "color_by_id"],
    category: Category::Noise,
    summary: "A random colour for each value of a number, within bounds of hue, saturation and brightness.",
    doc: Doc {
        computes: "out = the colour of the hue huelow + (huehigh − huelow) r₁ (in turns), the saturation \
            and the brightness likewise of r₂ and r₃ (see `hsvtorgb`), where the r are independent \
            random numbers of the cell ⌊4096 · in + ½⌋, uniform in [0, 1): values of `in` that lie in \
            different steps of 1/4096 have different colours. Integers are such values.",
        statistics: "Of an `in` that varies the colours are cells on a line, filtered as `randomfloat` is: \
            colours are averaged, not hues, with the covariance of the channels. Their \
            range is from 0 to the largest brightness; with all hues a channel is not Gaussian by 0.22 \
            (max |CDF − Φ|). The spectrum over `in` is that of a box, sinc². What fades has the \
            mean and the covariance of all colours, by 32 hues. Of varying bounds the means are used.",
        accuracy: "Where `in` is linear in the position the mean of a channel, and of the luminance, is within \
            0.005 standard deviations of the colours up to 2.5 cells, and the local standard deviation \
            within 0.005 (at 0.05 cells 0.04). The mean and the covariance of all colours are those of 5000 colours, as far as \
            these tell. Of an `in` that jumps between more than two values, the footprint at an edge \
            has the mean of all colours. Held by `nodes/tests/sources.rs` against dense sums.",
        references: "Smith 1978, *Color Gamut Transform Pairs* (the hexcone). MaterialX 1.39, node \
            `randomcolor` of its standard library, whose defaults these are.",
    },
    inputs: &[
        IN,
        bound("huelow", 0.0, "Where the hues begin.").unit("turns"),
        bound("huehigh", 1.0, "Where the hues end.").unit("turns"),
        bound("saturationlow", 0.825, "The least saturation."),
        bound("saturationhigh", 1.0, "The largest saturation."),
        bound("brightnesslow", 1.0, "The least brightness."),
        bound("brightnesshigh", 1.0, "The largest brightness."),
        SEED,
        HASH,
    ],
    output: OutputType::Exactly(Type::Color3),
    reach: |_| Reach::ANY,
    class: |_| Behaviour::Random { deviation: 0.22 },
    example: example! { "randomcolor", r#"
    "bricks": { "type": "brick", "inputs": { "output": "random", "columns": 5, "rows": 10 } },
    "randomcolor": { "type": "randomcolor", "inputs": {
        "in": { "node": "bricks" }, "huelow": 0, "huehigh": 0.12,
        "saturationlow": 0.4, "saturationhigh": 0.8, "brightnesslow": 0.3, "brightnesshigh": 0.9 } }
"# },
};

const fn bound(name: &'static str, default: f32, doc: &'static str) -> PortSpec {
    let ty = PortType::Exactly(Type::Float);
    PortSpec::new(name, ty, Default::Float(default), doc).range(Range::soft(0.0, 1.0))
}

/// The bounds, in the order of the parameters.
const BOUNDS: [&str; 6] = [
    "huelow",
    "huehigh",
    "saturationlow",
    "saturationhigh",
    "brightnesslow",
    "brightnesshigh",
];

/// What MaterialX adds to the seed for hue, saturation and brightness: 413.3, 1522.4 and 1813.8,
/// rounded up.
const SEEDS: [i32; 3] = [414, 1523, 1814];

/// How many hues stand for all.
const HUES: u32 = 32;

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let place = place(lower, node, false);
    let seed = lower.integer(node, "seed");
    let hash = Hash::of(lower, node);
    let bounds = BOUNDS.map(|port| lower.number(node, port));
    let line = Line {
        key: format!("randomcolor {seed} {hash:?}"),
        parameters: bounds.scalars(),
        numbers: &|cell, bounds| {
            let lattice = lattice_seed(cell.builder(), seed, 0x1f83_d9ab);
            let hsv = [0, 1, 2].map(|i| {
                let share = match hash {
                    Hash::Mipless => number([cell, cell.literal(i as i32)], lattice, 0),
                    Hash::Materialx => materialx(cell, seed.wrapping_add(SEEDS[i])),
                };
                between(share, [2 * i, 2 * i + 1].map(|k| bounds[k].float()))
            });
            to_rgb(hsv).to_vec()
        },
        ensemble: &|lower, wanted| ensemble(lower, &bounds, wanted),
        most: MOST,
        rounding: ROUNDING,
    };
    let colors = filtered(lower, &place, &line);
    let known = |bound: Float<'b>| {
        bound
            .as_constant()
            .is_some_and(|x| (0.0..=1.0).contains(&x))
    };
    if !bounds[2..].iter().all(|&bound| known(bound)) {
        return colors;
    }
    let limited = colors
        .into_iter()
        .map(|channel| channel.with_range([0.0, 1.0]));
    limited.collect()
}

/// low + (high − low) · share.
fn between<'b>(share: impl Operand<'b, f32>, [low, high]: [Float<'b>; 2]) -> Float<'b> {
    low + (high - low) * share
}

/// The channels over all cells.
fn ensemble<'b>(
    lower: &mut Lower<'_, 'b>,
    bounds: &[Float<'b>; 6],
    wanted: Bool<'b>,
) -> Ensemble<'b> {
    let b = lower.b();
    let hue = lower.function("hues of randomcolor", one_more_hue);
    let before = [b.float(0.0); SUMS.len()];
    let sums = b.fold(&hue, wanted.select(HUES, 0u32), before, &bounds[..2]);
    let averages = sums.map(|sum| sum * (1.0 / HUES as f32));
    let (full, products) = averages.split_at(3);
    // The mean and the mean square of a uniform number.
    let [[s1, s2], [v1, v2]] = [2, 4].map(|i| {
        let mean = between(0.5, [bounds[i], bounds[i + 1]]);
        let variance = (bounds[i + 1] - bounds[i]).square() * VARIANCE;
        [mean, mean.square() + variance]
    });
    // A channel is v (1 − s + s c), c being that of the full hue.
    let grey = 1.0 - s1;
    let means: Vec<Float<'b>> = full.iter().map(|&c| v1 * (grey + s1 * c)).collect();
    let mixed = s1 - s2;
    let greys = grey - mixed;
    let covariance = (pairs(3).zip(products))
        .map(|((i, k), &product)| {
            let colored = mixed * (full[i] + full[k]) + s2 * product;
            v2 * (greys + colored) - means[i] * means[k]
        })
        .collect();
    Ensemble { means, covariance }
}

/// Names of the sums over hues: the channels of full colours, and their products.
const SUMS: [&str; 9] = [
    "red",
    "green",
    "blue",
    "red_red",
    "green_red",
    "green_green",
    "blue_red",
    "blue_green",
    "blue_blue",
];

/// One more full hue, the body of a fold.
fn one_more_hue(module: &mut Module) -> FunctionRef {
    let b = &Builder::new("random_hue", "One more of the hues of random colours.");
    let index = b.uint_param("index");
    let sums = b.float_params(SUMS);
    let bounds = b.float_params(["hue_low", "hue_high"]);
    let hue = between((index.to_float() + 0.5) * (1.0 / HUES as f32), bounds);
    let color = to_rgb([hue, b.float(1.0), b.float(1.0)]);
    let products = pairs(3).map(|(i, k)| color[i] * color[k]);
    let parts = color.into_iter().chain(products);
    b.sums(SUMS, sums, parts);
    b.finish(module)
}
