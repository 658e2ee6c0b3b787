//! What the Porter–Duff operations share: premultiplied layers `fg` over `bg`, and the share `mix`
//! of the result.

use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Default, Node, PortSpec, PortType, Range, Type};

use crate::componentwise::{composed, exposed, mixed};

/// The two layers, and how much of the result is taken.
pub(crate) const IMAGES: &[PortSpec] = &[
    PortSpec::new(
        "fg",
        PortType::Exactly(Type::Color4),
        Default::Float(0.0),
        "The layer in front; premultiplied, but for `matte`.",
    ),
    PortSpec::new(
        "bg",
        PortType::Exactly(Type::Color4),
        Default::Float(0.0),
        "The layer behind, premultiplied.",
    ),
    PortSpec::new(
        "mix",
        PortType::Exactly(Type::Float),
        Default::Float(1.0),
        "How much of the result is taken; 0 leaves bg.",
    )
    .range(Range::soft(0.0, 1.0)),
];

/// bg + mix (result − bg) for each of four channels, alpha last; `operation` gives channel `k`.
pub(crate) fn composite(
    lower: &mut Lower<'_>,
    node: &Node,
    operation: impl Fn(&mut Lower<'_>, &[Signal], &[Signal], usize) -> Signal,
) -> Bundle {
    let (fg, bg) = (exposed(lower, node, "fg"), exposed(lower, node, "bg"));
    let share = lower.signal(node, "mix");
    composed(lower, |lower| {
        (0..4)
            .map(|k| {
                let result = operation(lower, &fg, &bg, k);
                mixed(lower, &bg[k], &result, &share)
            })
            .collect()
    })
}
