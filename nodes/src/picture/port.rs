//! The ports that pictures share, and where they say that the picture is read.

use std::sync::Arc;

use super::planes::Planes;
use super::pyramid::Address;
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Value};
use mipless_codegen::moments::Signal;
use mipless_graph::{Default, Node, Picture, PortSpec, PortType, Range, Type};

/// Which picture.
pub(crate) const FILE: PortSpec = PortSpec::new(
    "file",
    PortType::Exactly(Type::Filename),
    Default::Text(""),
    "A PNG, JPEG or OpenEXR picture of 8, 16 or 32 bits, relative to the file of the graph: at most \
     16384 texels a side, 2²² in all, and 256 MiB.",
);

/// Where.
pub(crate) const TEXCOORD: PortSpec = PortSpec::new(
    "texcoord",
    PortType::Exactly(Type::Vector2),
    Default::Surface,
    "Where the picture is read: the unit square holds it once, its first row at v = 0.",
)
.unit("uv");

/// How often.
pub(crate) const UVTILING: PortSpec = PortSpec::new(
    "uvtiling",
    PortType::Exactly(Type::Vector2),
    Default::Vector2([1.0, 1.0]),
    "How many pictures fit a unit of the texture space, along u and v.",
)
.range(Range::soft(0.25, 16.0))
.unit("pictures per uv");

/// From where.
pub(crate) const UVOFFSET: PortSpec = PortSpec::new(
    "uvoffset",
    PortType::Exactly(Type::Vector2),
    Default::Vector2([0.0, 0.0]),
    "What is subtracted from the tiled coordinates.",
)
.range(Range::soft(-1.0, 1.0))
.unit("pictures");

/// What the numbers mean.
pub(crate) const COLORSPACE: PortSpec = PortSpec::new(
    "colorspace",
    PortType::Choice(&["auto", "srgb_texture", "lin_rec709"]),
    Default::Choice("auto"),
    "`lin_rec709` takes the numbers as they are, `srgb_texture` makes colours linear; `auto` is \
     `srgb_texture` for colours of 8 and 16 bits.",
);

/// Whether the colours of a picture become linear, by the port `colorspace`.
pub(crate) fn linearises(colorspace: &str, picture: &Picture, color: bool) -> bool {
    match colorspace {
        "srgb_texture" => true,
        "lin_rec709" => false,
        _ => picture.encoded() && color,
    }
}

/// The planes of a picture as a node of this type sees them, and a key that tells them apart.
pub(crate) fn planes(
    lower: &Lower<'_>,
    node: &Node,
    picture: &Picture,
    ty: Type,
) -> (Arc<Planes>, String) {
    let color = matches!(ty, Type::Color3 | Type::Color4);
    let linearise = linearises(lower.choice(node, "colorspace"), picture, color);
    let file = lower.choice(node, "file");
    let key = format!("{file:?} {ty} {linearise}");
    let make = || Planes::of(picture, ty, linearise);
    (lower.once(&format!("planes {key}"), make), key)
}

/// texcoord · uvtiling − uvoffset, in pictures.
pub(crate) fn position(lower: &mut Lower<'_>, node: &Node) -> Vec<Signal> {
    let tiling = lower.bundle(node, "uvtiling");
    let offset = lower.bundle(node, "uvoffset");
    let texcoord = lower.bundle(node, "texcoord");
    (texcoord.iter().zip(tiling.iter().zip(&offset)))
        .map(|(axis, (tiling, offset))| {
            let tiled = lower.algebra.product(axis, tiling);
            tiled.sub(lower.b(), offset)
        })
        .collect()
}

/// The whole part of a coordinate and the rest, from 0 to 1.
pub(crate) fn split(b: &mut Builder, axis: &Signal) -> (Value, Value) {
    let whole = b.floor(axis.mean);
    let rest = b.sub(axis.mean, whole);
    let whole = b.trunc_i(whole);
    match axis.cell {
        None => (whole, rest),
        Some(cell) => (b.add_i(cell, whole), rest),
    }
}

impl Address {
    /// A coordinate, near enough to 0 to keep its detail, that reads the same texel.
    pub(crate) fn reduced(self, b: &mut Builder, axis: &Signal) -> Value {
        let (cell, rest) = split(b, axis);
        match self {
            Self::Periodic => rest,
            Self::Mirror => {
                let one = b.i32(1);
                let odd = b.and_i(cell, one);
                let odd = b.float_i(odd);
                b.add(rest, odd)
            }
            Self::Clamp => {
                // Beyond this many pictures all is the edge's.
                let (least, most) = (b.i32(-64), b.i32(64));
                let cell = b.max_i(cell, least);
                let cell = b.min_i(cell, most);
                let cell = b.float_i(cell);
                b.add(rest, cell)
            }
        }
    }

    /// The place in the picture that a reduced coordinate with an offset reads, and the sign of its
    /// change.
    pub(crate) fn place(self, b: &mut Builder, x: Value) -> (Value, Value) {
        let one = b.f32(1.0);
        match self {
            Self::Periodic => {
                let whole = b.floor(x);
                (b.sub(x, whole), one)
            }
            Self::Clamp => (x, one),
            Self::Mirror => {
                let half = b.scale(x, 0.5);
                let whole = b.floor(half);
                let rest = b.sub(half, whole);
                let twice = b.scale(rest, 2.0);
                let two = b.f32(2.0);
                let back = b.sub(two, twice);
                let turned = b.lt(one, twice);
                let minus = b.f32(-1.0);
                let sign = b.select(turned, minus, one);
                (b.min(twice, back), sign)
            }
        }
    }
}
