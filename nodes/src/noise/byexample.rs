//! `byexample`: an endless texture from a small one, by tiling and blending.

use crate::port;
use std::sync::{Arc, LazyLock};

use crate::noise::source::SEED;
use crate::picture::example::{Example, Gaussianised, deviation};
use crate::picture::footprint::Parts;
use crate::picture::gather::Reading;
use crate::picture::port::{
    COLORSPACE, FILE, TEXCOORD, UVOFFSET, UVTILING, linearises, planes, position, split,
};
use crate::picture::pyramid::{Address, Layout, bake};
use crate::picture::read::{Pyramid, Tap};
use crate::picture::tiling::{Tile, Tiling};
use mipless_codegen::ir::{Float, Vec2};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{
    Behaviour, Category, Doc, InputView, Node, NodeSpec, OutputType, Range, Reach, linear_from_srgb,
};

pub(super) static SPEC: NodeSpec = NodeSpec {
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
        TEXCOORD,
        UVTILING,
        UVOFFSET,
        port::pair("period", [0.0, 0.0], "After how many examples along u and v the texture repeats, rounded; never where it is 0.")
        .uniform()
        .range(Range::hard(0.0, 4096.0).with_soft(0.0, 16.0))
        .unit("pictures"),
        SEED,
        port::choice("signature", &["color3", "color4", "float"], "color3", "The type of the result."),
        COLORSPACE,
    ],
    output: OutputType::Named("signature"),
    reach: |_| Reach::ANY,
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

/// The longest footprint that is not widened.
const PARTS: Parts = Parts {
    longest: 6.0,
    nodes: true,
};

/// Where the Gaussian channels are tabulated, in standard deviations: an example of 2²² texels has
/// none beyond 5.1, and tiles at their weights' largest sum are rarer still.
const DOMAIN: [f32; 2] = [-5.0, 5.0];

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let (b, channels) = (lower.b(), node.ty.components());
    let Some(picture) = lower.picture(node, "file") else {
        return vec![Signal::constant(b, 0.0); channels];
    };
    let (colors, key) = planes(lower, node, &picture, node.ty);
    let example = lower.once(&format!("example {key}"), || Example::new(&colors));
    let of_example = Arc::clone(&example);
    let gaussian = Arc::new(LazyLock::new(move || of_example.gaussian()));
    let fields = blended(lower, node, &example, &gaussian, &key);
    // Back to the coordinates along each axis, then to colours.
    let along: Vec<Signal<'b>> = (fields.iter().enumerate())
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
    (0..channels)
        .map(|channel| {
            let mean = Signal::constant(b, example.mean[channel] as f32);
            let axes = example.axes.iter().zip(&along);
            axes.fold(mean, |color, (axis, signal)| {
                color + signal * axis[channel] as f32
            })
        })
        .collect()
}

/// The blended Gaussian channels.
fn blended<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    example: &Example,
    gaussian: &Arc<LazyLock<Gaussianised, impl FnOnce() -> Gaussianised + Send + Sync + 'static>>,
    key: &str,
) -> Bundle<'b> {
    let filters = lower.mode().filters();
    let channels = node.ty.components();
    let layout = Layout::new(example.size(), channels, [Address::Periodic; 2], filters);
    let key = format!("byexample {key} {filters}");
    let name = format!("{}_pyramid", node.name);
    let ranks = Arc::clone(gaussian);
    let bake = move |layout: &Layout| bake(layout, &ranks.planes);
    let pyramid = Pyramid::new(lower, &key, &name, layout, bake);
    let period = node.literal("period").numbers();
    let tiling = Tiling {
        period: [period[0].round(), period[1].round()],
        seed: lower.integer(node, "seed"),
    };

    let position = position(lower, node);
    let place = [0, 1].map(|axis| split(&position[axis]));
    let reading = Reading::new(lower, &pyramid, &position, PARTS, place);
    if let Some(longest) = reading.longest() {
        let wavelength = example.wavelength().min(1e6) as f32;
        lower.source_footprint(longest * (1.0 / wavelength));
    }
    let texels = pyramid.texels();
    reading.signals(lower, &format!("{key} {tiling:?}"), |part, place, read| {
        let place = [0, 2].map(|i| (place[i].int(), place[i + 1].float()));
        let tiles = tiling.tiles(place, part.offset);
        blend(
            tiles.map(|tile| (tile, read(tile.place))),
            part.variance,
            texels,
        )
    })
}

/// The blend of three tiles and what they read, over a part of the footprint of this variance.
fn blend<'b>(tiles: [(Tile<'b>, Tap<'b>); 3], variance: Float<'b>, texels: [f32; 2]) -> Tap<'b> {
    let slopes = tiles
        .each_ref()
        .map(|(tile, _)| Vec2([0, 1].map(|axis| tile.slope[axis] * (1.0 / texels[axis]))));
    let (zero, of) = (variance.literal(0.0), &tiles[0].1);
    let tiles = || tiles.iter().zip(slopes);
    let mean = (0..of.mean.len()).map(|i| {
        tiles().fold(zero, |sum, ((tile, tap), slope)| {
            let sum = sum + tile.weight * tap.mean[i];
            // The weight and the tile vary together.
            let joint = |&gradient: &Vec2<'b>| slope.dot(gradient) * variance;
            tap.gradient
                .get(i)
                .map(joint)
                .map_or(sum, |joint| sum + joint)
        })
    });
    let gradient = (0..of.gradient.len()).map(|i| {
        tiles().fold(Vec2::splat(zero), |sum, ((tile, tap), slope)| {
            sum + (tap.gradient[i] * tile.weight + slope * tap.mean[i])
        })
    });
    let rest = (0..of.rest.len()).map(|entry| {
        let parts = tiles().map(|((tile, tap), _)| tile.weight.square() * tap.rest[entry]);
        zero.builder().sum(parts)
    });
    Tap {
        mean: mean.collect(),
        gradient: gradient.collect(),
        rest: rest.collect(),
    }
}
