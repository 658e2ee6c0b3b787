//! The window of lattice points along a line that a footprint needs.

use mipless_codegen::ir::{Float, Uint};

/// ⌈needed⌉ between the least and the most, as a real and as an integer.
pub(super) fn count<'b>(needed: Float<'b>, [least, most]: [f32; 2]) -> (Float<'b>, Uint<'b>) {
    let count = needed.ceil().clamp(least, most);
    (count, count.to_int().to_uint())
}

/// The lattice coordinate that a window of `count` points around `x` starts at.
pub(super) fn start<'b>(x: Float<'b>, count: Float<'b>) -> Float<'b> {
    (x + count * -0.5).floor() + 1.0
}
