//! `byexample`: an endless texture from a small one, by tiling and blending.

use std::sync::{Arc, LazyLock};

use crate::noise::source::SEED;
use crate::picture::example::{Example, Gaussianised, deviation};
use crate::picture::footprint::{Footprint, Part, Parts};
use crate::picture::gather::{Place, gather};
use crate::picture::port::{
    COLORSPACE, FILE, UVOFFSET, UVTILING, linearises, planes, position, split,
};
use crate::picture::pyramid::{Address, Layout, bake};
use crate::picture::read::{Pyramid, Tap};
use crate::picture::tiling::{Tile, Tiling};
use mipless_codegen::ir::{Builder, FunctionRef, Numbers};
use mipless_codegen::moments::{Mode, Signal};
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, InputView, Node, NodeSpec, OutputType, PortSpec, PortType,
    Range, Type, linear_from_srgb,
};

static SPEC: NodeSpec = NodeSpec {
    name: "byexample",
    aliases: &[
        "tiling and blending",
        "histogram preserving blending",
        "stochastic texture",
        "hextile",
        "hextiledimage",
        "texture synthesis",
    ],
    category: Category::Noise,
    summary: "An endless texture that looks like a small example, without repetition.",
    doc: Doc {
        computes: "A triangle lattice of 16 points an example lies over texcoord · uvtiling − uvoffset. At \
            each point the example is shifted at random; N = Σ wᵢ Eᵢ blends the three tiles of a \
            triangle with w = b/|b|, b the barycentric coordinates, so that the variance is kept \
            (Σ wᵢ² = 1). The example's colours are taken along their principal axes and made Gaussian by \
            ranks before they are blended; out = mean + Σⱼ aⱼ Tⱼ(Nⱼ) with Tⱼ the inverse of the ranks \
            along the axis aⱼ. The example must tile, and be a texture without large structures. \
            Without a file, 0 everywhere.",
        statistics: "Each Nⱼ is Gaussian with mean 0 and variance 1. The footprint is taken apart: 3 × 3 parts of \
            the pixel for a box filter, 2 × 2 for a Gaussian of less than a texel or as large as the \
            tiles, and probes along the longer axis. In a part of \
            variance v a tile has the mean, gradient and covariance of a pyramid of the Gaussian \
            example; the part has mean Σ wᵢmᵢ + v ∇wᵢ·∇mᵢ, gradient Σ wᵢ∇mᵢ + mᵢ∇wᵢ (whose \
            products are the covariance between the tiles), and Σ wᵢ² Rᵢ beyond the gradient. Parts \
            add up by their means and covariances, those between channels included. The inverses \
            Tⱼ are filtered by tables; they give the output the example’s mean, variance and \
            histogram, so it is not Gaussian, and the check states the largest max |CDF − Φ| of \
            the example’s channels (of at most 65,536 texels). The range is the example’s along \
            each axis, the spectrum the example’s, blurred by the width of a tile. `ensemble` takes the covariance that the filter removes on average \
            over the example.",
        accuracy: "Against dense truth, box footprints of 2² to 128² texels of a 512² example: the \
            local standard deviation is off by at most 0.03 of itself on average where waves are 100 \
            texels long, and by 0.07 where they are 20; the mean to 32² by at most 0.06 of the error of the \
            nearest mip. Gaussian footprints, round or 8:1: the deviation by at most 0.12 of itself, the \
            mean by 0.1 of the deviation (1 to 6 texels; 0.05 elsewhere). Held by `cargo bench -p mipless-tests --bench \
            byexample` and `nodes/tests/picture.rs`. Footprints more than 6 times as long as wide \
            are taken for wider.",
        references: "Heitz & Neyret 2018, *High-Performance By-Example Noise using a Histogram-Preserving \
            Blending Operator*; Deliot & Heitz 2019, *Procedural Stochastic Textures by Tiling and \
            Blending*; Grenier, Sauvage, Dischler & Thery 2022, eq. 7–19.",
    },
    inputs: &[
        FILE,
        crate::picture::port::TEXCOORD,
        UVTILING,
        UVOFFSET,
        PortSpec::new(
            "period",
            PortType::Exactly(Type::Vector2),
            Default::Vector2([0.0, 0.0]),
            "After how many examples along u and v the texture repeats, rounded; never where it is 0.",
        )
        .uniform()
        .range(Range::hard(0.0, 4096.0).with_soft(0.0, 16.0))
        .unit("pictures"),
        SEED,
        PortSpec::new(
            "signature",
            PortType::Choice(&["color3", "color4", "float"]),
            Default::Choice("color3"),
            "The type of the result.",
        ),
        COLORSPACE,
    ],
    output: OutputType::Named("signature"),
    class,
    example: r#"{ "version": 1, "name": "granite_floor",
        "nodes": { "byexample": { "type": "byexample", "inputs": { "file": "images/granite.png", "uvtiling": [2, 2], "seed": 3 } } },
        "outputs": { "out": { "node": "byexample" } } }"#,
};

/// How many texels of a channel the check looks at, at most.
const LOOKED_AT: usize = 1 << 16;

/// What is blended is Gaussian, but the inverse ranks give it the histograms of the example: the
/// largest deviation of its channels.
fn class(inputs: &dyn InputView) -> Behaviour {
    let Some(picture) = inputs.picture("file") else {
        return Behaviour::Random { deviation: 0.0 };
    };
    let color = inputs.choice("signature") != "float";
    let linearise = linearises(inputs.choice("colorspace"), picture, color);
    let channels = picture.channels() as usize;
    let read = match (color, channels) {
        (true, 3..) => 3,
        _ => 1,
    };
    let texels = picture.numbers().len() / channels;
    let step = texels.div_ceil(LOOKED_AT);
    let of = |channel: usize| {
        let numbers = picture.numbers().chunks_exact(channels).step_by(step);
        let numbers = numbers.map(|texel| f64::from(texel[channel]));
        if linearise {
            deviation(numbers.map(linear_from_srgb).collect())
        } else {
            deviation(numbers.collect())
        }
    };
    Behaviour::Random {
        deviation: (0..read).map(of).fold(0.0, f64::max) as f32,
    }
}

/// The definition.
pub(crate) const DEF: NodeDef = NodeDef { spec: &SPEC, lower };

/// The longest footprint that is not widened.
const PARTS: Parts = Parts {
    longest: 6.0,
    nodes: true,
};

/// Where the Gaussian channels are tabulated, in standard deviations: an example of 2²² texels has
/// none beyond 5.1, and tiles at their weights' largest sum are rarer still.
const DOMAIN: [f32; 2] = [-5.0, 5.0];

fn lower(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let channels = node.ty.components();
    let Some(picture) = lower.picture(node, "file") else {
        let b = lower.b();
        return (0..channels).map(|_| Signal::constant(b, 0.0)).collect();
    };
    let (colors, key) = planes(lower, node, &picture, node.ty);
    let example = lower.once(&format!("example {key}"), || Example::new(&colors));
    let of_example = Arc::clone(&example);
    let gaussian = Arc::new(LazyLock::new(move || of_example.gaussian()));
    let fields = blended(lower, node, &example, &gaussian, &key);
    // Back to the coordinates along each axis, then to colours.
    let along: Vec<Signal> = (fields.iter().enumerate())
        .map(|(axis, field)| {
            let ranks = Arc::clone(&gaussian);
            let range = example.range(axis).map(|x| x as f32);
            let inverse = lower.tabulate(
                &format!("byexample {key} {axis}"),
                &format!("{}_{axis}", node.name),
                (DOMAIN, range),
                move |score| ranks.coordinate(axis, score),
            );
            lower.algebra.transfer(field, &inverse)
        })
        .collect();
    let b = lower.b();
    (0..channels)
        .map(|channel| {
            let mut color = Signal::constant(b, example.mean[channel] as f32);
            for (axis, signal) in example.axes.iter().zip(&along) {
                let factor = b.f32(axis[channel] as f32);
                let part = signal.scale(b, factor);
                color = color.add(b, &part);
            }
            color
        })
        .collect()
}

/// The blended Gaussian channels.
fn blended(
    lower: &mut Lower<'_>,
    node: &Node,
    example: &Example,
    gaussian: &Arc<LazyLock<Gaussianised, impl FnOnce() -> Gaussianised + Send + Sync + 'static>>,
    key: &str,
) -> Vec<Signal> {
    let channels = node.ty.components();
    let mode = lower.mode();
    let size = example.size();
    let texels = size.map(|n| n as f32);
    let layout = Layout::new(size, channels, [Address::Periodic; 2], mode.filters());
    let (table, ranks) = (layout.clone(), Arc::clone(gaussian));
    let baked = Arc::new(LazyLock::new(move || bake(&table, &ranks.planes)));
    let (length, numbers) = (layout.len(), Arc::clone(&baked));
    let key = format!("byexample {key} {}", mode.filters());
    let name = format!("{}_pyramid", node.name);
    let pyramid = Pyramid::new(lower, &key, &name, layout, || {
        Numbers::lazy(length, move || numbers.0.clone())
    });
    let period = node.literal("period").numbers();
    let tiling = Tiling {
        period: [period[0].round(), period[1].round()],
        seed: lower.integer(node, "seed"),
    };
    let key = format!("{key} {tiling:?}");

    let position = position(lower, node);
    let b = lower.b();
    let starts = [0, 1].map(|axis| split(b, &position[axis]));
    let place = vec![starts[0].0, starts[0].1, starts[1].0, starts[1].1];
    if !mode.filters() {
        let point = pyramid.point(lower);
        let b = lower.b();
        let zero = b.f32(0.0);
        let tiles = tiling.tiles(b, &place, [zero; 2]);
        let mut means = vec![zero; channels];
        for tile in &tiles {
            let values = b.call(&point, &tile.place);
            for (mean, value) in means.iter_mut().zip(values) {
                let part = b.mul(tile.weight, value);
                *mean = b.add(*mean, part);
            }
        }
        return means.iter().map(|&mean| Signal::certain(b, mean)).collect();
    }
    let filter = lower.filter();
    let (footprint, pixel) = Footprint::of(lower.b(), &position, texels, filter, PARTS);
    let carries = matches!(mode, Mode::Local | Mode::Quad);
    let filtered = pyramid.filtered(lower, carries);
    let place = Place {
        footprint: &footprint,
        pixel: Some(pixel),
        more: place,
    };
    let gathered = gather(
        lower,
        &key,
        (channels, carries),
        &place,
        |b, part, place| {
            let tiles = tiling.tiles(b, place, part.offset);
            blend(b, &tiles, part, &filtered, (channels, texels, carries))
        },
    );
    let [xx, xy, yy] = footprint.covariance;
    let b = lower.b();
    let sum = b.add(xx, yy);
    let variance = b.scale(sum, 0.5);
    // The longest side of the footprint, in wavelengths.
    let (tilt, zero) = (b.sub(xx, yy), b.f32(0.0));
    let tilt = b.scale(tilt, 0.5);
    let root = b.dot(&[tilt, xy], &[tilt, xy]);
    let root = b.sqrt(root);
    let most = b.add(variance, root);
    let most = b.max(most, zero);
    let size = b.sqrt(most);
    let wavelength = example.wavelength().min(1e6) as f32;
    let size = b.scale(size, 1.0 / wavelength);
    lower.source_footprint(size);
    if carries {
        return gathered.signals(lower, &position, texels, &footprint);
    }
    let b = lower.b();
    let mut signals: Vec<Signal> = (gathered.mean.iter())
        .map(|&mean| Signal::certain(b, mean))
        .collect();
    if mode == Mode::Ensemble {
        let removed = pyramid.removed(lower, variance, move |length| {
            let rows = move || baked.1.iter().flatten().map(|&x| x as f32).collect();
            Numbers::lazy(length, rows)
        });
        lower.algebra.attach_joint(&mut signals, &removed);
    }
    signals
}

/// The blend of the tiles over a part of the footprint.
fn blend(
    b: &mut Builder,
    tiles: &[Tile; 3],
    part: &Part,
    filtered: &FunctionRef,
    (channels, texels, carries): (usize, [f32; 2], bool),
) -> Tap {
    let zero = b.f32(0.0);
    let v = part.variance;
    let mut out = Tap {
        mean: vec![zero; channels],
        gradient: vec![[zero; 2]; if carries { channels } else { 0 }],
        rest: Vec::new(),
    };
    for tile in tiles {
        let [x, y] = tile.place;
        let numbers = b.call(filtered, &[x, y, v]);
        let tap = Tap::of(&numbers, channels);
        let slope = [0, 1].map(|axis| b.scale(tile.slope[axis], 1.0 / texels[axis]));
        for (channel, &mean) in tap.mean.iter().enumerate() {
            let own = b.mul(tile.weight, mean);
            out.mean[channel] = b.add(out.mean[channel], own);
            let Some(gradient) = tap.gradient.get(channel) else {
                continue;
            };
            // The weight and the tile vary together.
            let joint = b.dot(&slope, gradient);
            let joint = b.mul(joint, v);
            out.mean[channel] = b.add(out.mean[channel], joint);
            for axis in [0, 1] {
                let of_tile = b.mul(tile.weight, gradient[axis]);
                let of_weight = b.mul(slope[axis], mean);
                let sum = b.add(of_tile, of_weight);
                out.gradient[channel][axis] = b.add(out.gradient[channel][axis], sum);
            }
        }
        let square = b.square(tile.weight);
        for (entry, &rest) in tap.rest.iter().enumerate() {
            let own = b.mul(square, rest);
            match out.rest.get_mut(entry) {
                Some(sum) => *sum = b.add(*sum, own),
                None => out.rest.push(own),
            }
        }
    }
    out
}
