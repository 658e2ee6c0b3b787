//! `image`: a picture, tiled or clamped, that knows its moments.

use crate::picture::footprint::Parts;
use crate::picture::gather::Reading;
use crate::picture::port::{COLORSPACE, FILE, TEXCOORD, UVOFFSET, UVTILING, planes, position};
use crate::picture::pyramid::{Address, Layout, bake};
use crate::picture::read::Pyramid;
use crate::port;
use mipless_codegen::ir::Vec2;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Behaviour, Category, Doc, Node, NodeSpec, OutputType, Reach, Type};

pub(super) static SPEC: NodeSpec = NodeSpec {
    name: "image",
    aliases: &[
        "tiledimage",
        "texture",
        "bitmap",
        "image texture",
        "texture2d",
        "picture",
    ],
    category: Category::Pattern,
    summary: "A picture, tiled or clamped, with its moments over any footprint.",
    doc: Doc {
        computes: "The picture at texcoord · uvtiling − uvoffset by bilinear interpolation of its \
            texels, the first row at v = 0; what lies beyond its edges is the picture again \
            (`periodic`), its last texel (`clamp`), or the picture reversed (`mirror`). Grey spreads \
            to colours, alpha is 1 where there is none, `float` is the first channel. Without a \
            file, `default` everywhere.",
        statistics: "Mean, variance, range and spectrum are the picture’s, the spectrum with the \
            sinc⁴ of the interpolation. A pyramid holds the mean and the covariance of the channels under Gaussians of \
            σ = 1, 1.4, 2, 2.8, … texels; level 0 is the interpolated picture itself. An elongated \
            footprint is gathered from up to 25 probes along its longer axis with weights (1 − \
            k²/ρ²)², up to 10 times as long as wide; beyond that the shorter axis is taken for \
            longer. Out come the filtered mean, its gradient, and the covariance that the filter \
            removed beyond the gradient, which the channels share by a triangular factor. \
            `ensemble` takes the covariance that the filter removes on average over the picture. A \
            picture is no Gaussian: what follows it is closed by its moments.",
        accuracy: "Against dense sums over footprints of σ = 0.2 to 20 texels of a picture whose finest wave is \
            9 texels long: the mean is off by 0.013 of the picture's standard deviation on average, \
            and by 0.045 over footprints 8 times as long as wide; local standard deviations by 7 % \
            below a texel, 1 % above. The point value at a footprint of 0 is exact. Held by \
            `nodes/tests/picture.rs`.",
        references: "Williams 1983, *Pyramidal Parametrics*; Grenier, Sauvage, Dischler & Thery 2022, \
            eq. 10 and 14–19 (pyramids of variances and their sums over a footprint); MaterialX 1.39, \
            nodes `image` and `tiledimage`.",
    },
    inputs: &[
        FILE,
        port::exactly(
            Type::Color4,
            "default",
            0.0,
            "What there is without a file.",
        )
        .uniform(),
        TEXCOORD,
        UVTILING,
        UVOFFSET,
        port::choice(
            "uaddressmode",
            &["periodic", "clamp", "mirror"],
            "periodic",
            "What lies left and right of the picture.",
        ),
        port::choice(
            "vaddressmode",
            &["periodic", "clamp", "mirror"],
            "periodic",
            "What lies above and below the picture.",
        ),
        port::choice(
            "signature",
            &["color3", "color4", "float", "vector2", "vector3", "vector4"],
            "color3",
            "The type of the result.",
        ),
        COLORSPACE,
    ],
    output: OutputType::Named("signature"),
    reach: |_| Reach::ANY,
    class: |_| Behaviour::Pattern,
    example: r#"{ "version": 1, "name": "wall",
        "nodes": { "image": { "type": "image", "inputs": { "file": "images/granite.png", "uvtiling": [2, 2] } } },
        "outputs": { "out": { "node": "image" } } }"#,
};

/// The longest footprint that is not widened.
const PARTS: Parts = Parts {
    longest: 10.0,
    nodes: false,
};

fn address(lower: &Lower<'_, '_>, node: &Node, port: &str) -> Address {
    match lower.choice(node, port) {
        "clamp" => Address::Clamp,
        "mirror" => Address::Mirror,
        _ => Address::Periodic,
    }
}

pub(super) fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let channels = node.ty.components();
    let Some(picture) = lower.picture(node, "file") else {
        let mut bundle = lower.bundle(node, "default");
        bundle.truncate(channels);
        return bundle;
    };
    let (planes, key) = planes(lower, node, &picture, node.ty);
    let ranges = planes.ranges();
    let address = ["uaddressmode", "vaddressmode"].map(|port| address(lower, node, port));
    let filters = lower.mode().filters();
    let key = format!("image {key} {address:?} {filters}");
    let layout = Layout::new(planes.size, channels, address, filters);
    let name = format!("{}_pyramid", node.name);
    let pyramid = Pyramid::new(lower, &key, &name, layout, move |layout| {
        bake(layout, &planes)
    });

    let position = position(lower, node);
    let start = [0, 1].map(|axis| address[axis].reduced(&position[axis]));
    let reading = Reading::new(lower, &pyramid, &position, PARTS, start);
    let signals = reading.signals(lower, &key, |part, start, read| {
        let [(x, across), (y, down)] =
            [0, 1].map(|axis| address[axis].place(start[axis].float() + part.offset[axis]));
        let mut tap = read([x, y]);
        for Vec2([dx, dy]) in &mut tap.gradient {
            (*dx, *dy) = (*dx * across, *dy * down);
        }
        tap
    });
    (signals.into_iter().zip(ranges))
        .map(|(signal, range)| signal.with_range(range))
        .collect()
}
