//! The window of lattice points along a line that a footprint needs.

use mipless_codegen::ir::{Builder, Value};

/// ⌈needed⌉ between the least and the most, as a real and as a u32.
pub(super) fn count(b: &mut Builder, needed: Value, [least, most]: [f32; 2]) -> [Value; 2] {
    let minus = b.neg(needed);
    let floor = b.floor(minus);
    let up = b.neg(floor);
    let count = b.clamp(up, least, most);
    let turns = b.trunc_i(count);
    [count, b.cast_u(turns)]
}

/// The lattice coordinate that a window of `count` (a real) points around `x` starts at.
pub(super) fn start(b: &mut Builder, x: Value, count: Value) -> Value {
    let half = b.scale(count, -0.5);
    let start = b.add(x, half);
    let start = b.floor(start);
    b.offset(start, 1.0)
}
