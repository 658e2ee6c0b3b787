//! Sets as the bits of a number: what a fold takes one after the other.

use mipless_codegen::ir::{Bool, Builder, Uint};

/// The set of the conditions that hold, at most 24, and how many they are.
pub(super) fn set<'b>(b: &'b Builder, conditions: &[Bool<'b>]) -> [Uint<'b>; 2] {
    assert!(
        conditions.len() <= 24,
        "an f32 holds every number of 24 bits"
    );
    let (mut bits, mut count) = (b.uint(0), b.uint(0));
    for (i, condition) in conditions.iter().enumerate() {
        bits = bits | condition.select(1u32 << i, 0u32);
        count += condition.select(1u32, 0u32);
    }
    [bits, count]
}

/// The lowest member of a set that is not empty, and the others.
pub(super) fn lowest(bits: Uint<'_>) -> [Uint<'_>; 2] {
    let bit = bits & (0 - bits);
    // Which one is the exponent of the bit as an f32.
    let exponent = bit.to_float().bits() >> 23;
    [exponent - 127, bits ^ bit]
}
