//! Sets as the bits of a number: what a fold takes one after the other.

use mipless_codegen::ir::{Builder, Value};

/// The set of the conditions that hold, at most 24, and how many they are.
pub(super) fn set(b: &mut Builder, conditions: &[Value]) -> [Value; 2] {
    assert!(
        conditions.len() <= 24,
        "an f32 holds every number of 24 bits"
    );
    let (none, one) = (b.u32(0), b.u32(1));
    let (mut bits, mut count) = (none, none);
    for (i, &condition) in conditions.iter().enumerate() {
        let bit = b.u32(1 << i);
        let bit = b.select(condition, bit, none);
        bits = b.or_u(bits, bit);
        let more = b.select(condition, one, none);
        count = b.add_u(count, more);
    }
    [bits, count]
}

/// The lowest member of a set that is not empty, and the others.
pub(super) fn lowest(b: &mut Builder, bits: Value) -> [Value; 2] {
    let zero = b.u32(0);
    let negative = b.sub_u(zero, bits);
    let bit = b.and_u(bits, negative);
    let others = b.xor_u(bits, bit);
    // Which one is the exponent of the bit as an f32.
    let number = b.float_u(bit);
    let word = b.bits(number);
    let (mantissa, bias) = (b.u32(23), b.u32(127));
    let exponent = b.shr_u(word, mantissa);
    [b.sub_u(exponent, bias), others]
}
