//! The hash of MaterialX's lattices: the final mix of Jenkins 2006 (lookup3), of up to three integers.

use mipless_codegen::ir::{Float, Uint};

/// What the words start from, for so many integers.
const fn start(integers: u32) -> u32 {
    0xdead_beef_u32.wrapping_add(integers << 2).wrapping_add(13)
}

/// By how many bits the words turn, step by step.
const TURNS: [u32; 7] = [14, 11, 25, 16, 4, 14, 24];

fn turned(word: Uint<'_>, bits: u32) -> Uint<'_> {
    (word << bits) | (word >> (32 - bits))
}

/// Each step mixes the word before into one of the three, beginning with the last.
fn mixed(mut words: [Uint<'_>; 3]) -> Uint<'_> {
    for (step, bits) in TURNS.into_iter().enumerate() {
        let (into, from) = ((step + 2) % 3, (step + 1) % 3);
        words[into] = (words[into] ^ words[from]) - turned(words[from], bits);
    }
    words[2]
}

/// The hash of two integers; a `seed` of 0 gives MaterialX's.
pub(crate) fn plane<'b>([x, y]: [Uint<'b>; 2], seed: Uint<'b>) -> Uint<'b> {
    let from = seed + start(2);
    mixed([from + x, from + y, from])
}

/// The hash of three integers; a `seed` of 0 gives MaterialX's.
pub(crate) fn space<'b>([x, y, z]: [Uint<'b>; 3], seed: Uint<'b>) -> Uint<'b> {
    let from = seed + start(3);
    mixed([from + x, from + y, from + z])
}

/// By how many bits the words turn where a fourth integer is still to come.
const EARLIER: [u32; 6] = [4, 6, 8, 16, 19, 4];

/// Three hashes of three integers, as of a fourth that counts from 0; a `seed` of 0 gives MaterialX's.
pub(crate) fn three<'b>(place: [Uint<'b>; 3], seed: Uint<'b>) -> [Uint<'b>; 3] {
    let from = seed + start(4);
    let mut words = place.map(|integer| from + integer);
    for (step, bits) in EARLIER.into_iter().enumerate() {
        let [into, from, next] = [step, step + 2, step + 1].map(|word| word % 3);
        words[into] = (words[into] - words[from]) ^ turned(words[from], bits);
        words[from] += words[next];
    }
    let [a, b, c] = words;
    [0, 1, 2].map(|fourth| mixed([a + fourth, b, c]))
}

/// A node's seed as what the words start from beyond MaterialX's; 0 of 0.
pub(crate) fn seed(seed: i32) -> u32 {
    (seed as u32).wrapping_mul(0x9e37_79b1)
}

/// The number of [0, 1] of a hash.
pub(crate) fn unit(hash: Uint<'_>) -> Float<'_> {
    hash.to_float() * (1.0 / (1u64 << 32) as f32)
}

/// The gradient of a lattice point in the plane: (±1, ±2) or (±2, ±1).
pub(crate) fn gradient(hash: Uint<'_>) -> [Float<'_>; 2] {
    let [first, second] = signs(hash);
    let upright = (hash & 7).lt(4u32);
    [
        upright.select(first, 2.0 * second),
        upright.select(2.0 * second, first),
    ]
}

/// That of a lattice point in space, of squared length 2: two of its axes, one of twelve
/// directions, four of which come twice.
pub(crate) fn direction(hash: Uint<'_>) -> [Float<'_>; 3] {
    let [first, second] = signs(hash);
    let h = hash & 15;
    // Which axes the two numbers lie along.
    let first_x = h.lt(8u32);
    let second_y = h.lt(4u32);
    let second_x = h.equals(12u32) | h.equals(14u32);
    let second_z = !(second_y | second_x);
    [
        first_x.select(first, second_x.select(second, 0.0)),
        first_x.select(second_y.select(second, 0.0), first),
        second_z.select(second, 0.0),
    ]
}

/// ±1 by each of the last two bits of a hash.
fn signs(hash: Uint<'_>) -> [Float<'_>; 2] {
    [hash & 1, (hash >> 1) & 1].map(|bit| bit.to_float() * -2.0 + 1.0)
}
