//! `randomcolor`: a random colour for each number.

use crate::color::hsv::to_rgb;
use crate::noise::cell::line::{Ensemble, Line, filtered};
use crate::noise::cell::{VARIANCE, lattice_seed, number};
use crate::noise::randomfloat::{IN, place};
use crate::noise::source::SEED;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type as Scalar, Value};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Range, Type,
};

static SPEC: NodeSpec = NodeSpec {
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
    ],
    output: OutputType::Exactly(Type::Color3),
    class: |_| Behaviour::Random { deviation: 0.22 },
    example: r#"{
  "version": 1,
  "name": "randomcolor_example",
  "nodes": {
    "bricks": { "type": "brick", "inputs": { "output": "random", "columns": 5, "rows": 10 } },
    "randomcolor": { "type": "randomcolor", "inputs": {
        "in": { "node": "bricks" }, "huelow": 0, "huehigh": 0.12,
        "saturationlow": 0.4, "saturationhigh": 0.8, "brightnesslow": 0.3, "brightnesshigh": 0.9 } }
  },
  "outputs": { "out": { "node": "randomcolor" } }
}"#,
};

const fn bound(name: &'static str, default: f32, doc: &'static str) -> PortSpec {
    let ty = PortType::Exactly(Type::Float);
    PortSpec::new(name, ty, Default::Float(default), doc).range(Range::soft(0.0, 1.0))
}

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// The bounds, in the order of the parameters.
const BOUNDS: [&str; 6] = [
    "huelow",
    "huehigh",
    "saturationlow",
    "saturationhigh",
    "brightnesslow",
    "brightnesshigh",
];

/// How many hues stand for all.
const HUES: u32 = 32;

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let place = place(lower, node);
    let seed = lower.integer(node, "seed");
    let bounds = BOUNDS.map(|port| lower.number(node, port));
    let line = Line {
        key: format!("randomcolor {seed}"),
        parameters: bounds.to_vec(),
        numbers: &|b, cell, bounds| {
            let seed = lattice_seed(b, seed, 0x1f83_d9ab);
            let hsv = [0, 1, 2].map(|i| {
                let row = b.i32(i as i32);
                let (share, _) = number(b, cell, row, seed, 0);
                between(b, share, [bounds[2 * i], bounds[2 * i + 1]])
            });
            to_rgb(b, hsv).to_vec()
        },
        ensemble: &|lower, wanted| ensemble(lower, &bounds, wanted),
    };
    let colors = filtered(lower, &place, &line);
    let b = lower.b();
    let within = bounds[2..]
        .iter()
        .all(|&v| b.as_constant(v).is_some_and(|x| (0.0..=1.0).contains(&x)));
    (colors.into_iter())
        .map(|channel| {
            if within {
                channel.with_range([0.0, 1.0])
            } else {
                channel
            }
        })
        .collect()
}

/// low + (high − low) · share.
fn between(b: &mut Builder, share: Value, [low, high]: [Value; 2]) -> Value {
    let span = b.sub(high, low);
    let part = b.mul(span, share);
    b.add(low, part)
}

/// The channels over all cells.
fn ensemble(lower: &mut Lower<'_>, bounds: &[Value; 6], wanted: Value) -> Ensemble {
    let hue = lower.function("hues of randomcolor", one_more_hue);
    let b = lower.b();
    let (zero, none, all) = (b.f32(0.0), b.u32(0), b.u32(HUES));
    let count = b.select(wanted, all, none);
    let sums = b.fold(&hue, count, &[zero; SUMS.len()], &bounds[..2]);
    let moments: Vec<Value> = (sums.into_iter())
        .map(|sum| b.scale(sum, 1.0 / HUES as f32))
        .collect();
    let (full, products) = moments.split_at(3);
    // The mean and the mean square of a uniform number.
    let [[s1, s2], [v1, v2]] = [2, 4].map(|i| {
        let half = b.f32(0.5);
        let mean = between(b, half, [bounds[i], bounds[i + 1]]);
        let span = b.sub(bounds[i + 1], bounds[i]);
        let variance = b.square(span);
        let variance = b.scale(variance, VARIANCE);
        let square = b.square(mean);
        [mean, b.add(square, variance)]
    });
    // A channel is v (1 − s + s c), c being that of the full hue.
    let grey = b.neg(s1);
    let grey = b.offset(grey, 1.0);
    let means: Vec<Value> = (full.iter())
        .map(|&c| {
            let part = b.mul(s1, c);
            let sum = b.add(grey, part);
            b.mul(v1, sum)
        })
        .collect();
    let mixed = b.sub(s1, s2);
    let greys = b.sub(grey, mixed);
    let pairs = [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2)];
    let covariance = (pairs.into_iter().zip(products))
        .map(|((i, k), &product)| {
            let both = b.add(full[i], full[k]);
            let part = b.dot(&[mixed, s2], &[both, product]);
            let second = b.add(greys, part);
            let second = b.mul(v2, second);
            let square = b.mul(means[i], means[k]);
            b.sub(second, square)
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
    let mut b = Builder::new("random_hue", "One more of the hues of random colours.");
    let index = b.param("index", Scalar::U32);
    let state = SUMS.map(|name| b.param_f32(name));
    let bounds = ["hue_low", "hue_high"].map(|name| b.param_f32(name));
    let number = b.float_u(index);
    let number = b.offset(number, 0.5);
    let share = b.scale(number, 1.0 / HUES as f32);
    let hue = between(&mut b, share, bounds);
    let one = b.f32(1.0);
    let [red, green, blue] = to_rgb(&mut b, [hue, one, one]);
    let pairs = [
        (red, red),
        (green, red),
        (green, green),
        (blue, red),
        (blue, green),
        (blue, blue),
    ];
    let products = pairs.map(|(p, q)| b.mul(p, q));
    let parts = [red, green, blue].into_iter().chain(products);
    for ((name, sum), part) in SUMS.into_iter().zip(state).zip(parts) {
        let sum = b.add(sum, part);
        b.result(name, sum);
    }
    b.finish(module)
}
