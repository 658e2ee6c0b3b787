//! What `separate2`, `separate3` and `separate4` share.

use mipless_codegen::moments::Signal;
use mipless_codegen::{Bundle, Lower};
use mipless_graph::Node;

/// The component of `in` that the last letter of `output` names: r, g, b, a or x, y, z, w. Beyond
/// the components of the input, a float is every one, and the alpha of a colour is 1.
pub(crate) fn component(lower: &mut Lower<'_>, node: &Node) -> Bundle {
    let bundle = lower.bundle(node, "in");
    let letter = lower.choice(node, "output").chars().last();
    let index = match letter {
        Some('r' | 'x') => 0,
        Some('g' | 'y') => 1,
        Some('b' | 'z') => 2,
        _ => 3,
    };
    let signal = match &bundle[..] {
        [float] => float.clone(),
        _ => match bundle.get(index) {
            Some(signal) => signal.clone(),
            None => Signal::constant(lower.b(), if index == 3 { 1.0 } else { 0.0 }),
        },
    };
    vec![signal]
}
