//! What the blend modes share: layers `fg` over `bg`, and the share `mix` of the result.

use mipless_codegen::moments::{Piecewise, Signal};
use mipless_codegen::{Bundle, Lower};
use mipless_graph::{Default, Node, PortSpec, PortType, Range, Type};

use crate::componentwise::{composed, exposed, mixed, product, transfer};

/// What is blended, over what, and how much of the result is taken.
pub(crate) const LAYERS: &[PortSpec] = &[
    PortSpec::new(
        "fg",
        PortType::Any,
        Default::Float(0.0),
        "The signal that is blended in.",
    ),
    PortSpec::new(
        "bg",
        PortType::Any,
        Default::Float(0.0),
        "The signal that is blended over.",
    ),
    PortSpec::new(
        "mix",
        PortType::Exactly(Type::Float),
        Default::Float(1.0),
        "How much of the result is taken; 0 leaves bg.",
    )
    .range(Range::soft(0.0, 1.0)),
];

/// bg + mix (mode(fg, bg) − bg), for each component.
pub(crate) fn blend(
    lower: &mut Lower<'_>,
    node: &Node,
    mode: impl Fn(&mut Lower<'_>, &Signal, &Signal) -> Signal,
) -> Bundle {
    let (fg, bg) = (exposed(lower, node, "fg"), exposed(lower, node, "bg"));
    let share = lower.signal(node, "mix");
    composed(lower, |lower| {
        (fg.iter().zip(&bg))
            .map(|(fg, bg)| {
                let result = mode(lower, fg, bg);
                mixed(lower, bg, &result, &share)
            })
            .collect()
    })
}

/// 2xy where y < ½, else 1 − 2(1 − x)(1 − y): with h = max(2y − 1, 0) it is h + x(2y − 2h).
pub(crate) fn overlaid(lower: &mut Lower<'_>, x: &Signal, y: &Signal) -> Signal {
    let b = lower.b();
    let two = b.f32(2.0);
    let minus = b.f32(-1.0);
    let twice = y.scale(b, two);
    let shifted = twice.offset(b, minus);
    let hinge = Piecewise::hinge(b);
    let hinge = transfer(lower, &shifted, &hinge);
    let b = lower.b();
    let drop = hinge.scale(b, two);
    let tent = twice.sub(b, &drop);
    let part = product(lower, x, &tent);
    part.add(lower.b(), &hinge)
}
