//! The ports that pictures share, and where they say that the picture is read.

use std::sync::Arc;

use super::planes::Planes;
use super::pyramid::Address;
use mipless_codegen::ir::{Float, Int};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
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
    lower: &Lower<'_, '_>,
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
pub(crate) fn position<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let [tiling, offset, texcoord] =
        ["uvtiling", "uvoffset", "texcoord"].map(|port| lower.bundle(node, port));
    (texcoord.iter().zip(tiling.iter().zip(&offset)))
        .map(|(axis, (tiling, offset))| lower.algebra.product(axis, tiling) - offset)
        .collect()
}

/// The whole part of a coordinate and the rest, from 0 to 1.
pub(crate) fn split<'b>(axis: &Signal<'b>) -> (Int<'b>, Float<'b>) {
    let (cell, mean) = axis.place();
    let floor = mean.floor();
    (cell + floor.to_int(), mean - floor)
}

impl Address {
    /// A coordinate, near enough to 0 to keep its detail, that reads the same texel.
    pub(crate) fn reduced<'b>(self, axis: &Signal<'b>) -> Float<'b> {
        let (cell, rest) = split(axis);
        match self {
            Self::Periodic => rest,
            Self::Mirror => rest + (cell & 1).to_float(),
            // Beyond this many pictures all is the edge's.
            Self::Clamp => rest + cell.max(-64).min(64).to_float(),
        }
    }

    /// The place in the picture that a reduced coordinate with an offset reads, and the sign of its
    /// change.
    pub(crate) fn place(self, x: Float<'_>) -> (Float<'_>, Float<'_>) {
        match self {
            Self::Periodic => (x - x.floor(), x.literal(1.0)),
            Self::Clamp => (x, x.literal(1.0)),
            Self::Mirror => {
                let half = x * 0.5;
                let there = (half - half.floor()) * 2.0;
                let back = 2.0 - there;
                (there.min(back), there.gt(1.0).select(-1.0, 1.0))
            }
        }
    }
}
