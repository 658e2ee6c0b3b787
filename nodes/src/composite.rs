//! What the Porter–Duff operations share: premultiplied layers `fg` over `bg`, and the share `mix`
//! of the result.

use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::Node;

use crate::componentwise::{composed, exposed, mixed};

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
