//! The hash of Material Maker's lattices, in real numbers: of a point x of the plane
//! fract(43758.5 cos(x·(13.9898, 8.141) mod 3.14)), which is what its shaders compute
//! (`common.shader`, Material Maker 1.0). A cosine that is off by its last bit moves the number by 0.003,
//! and a product that is not rounded before it is added to gives another number: devices that contract
//! the two have other blobs, there and here.

use mipless_codegen::ir::{Int, Uint, dot};

/// What a point is multiplied by for the first and the second of its numbers.
const DIRECTIONS: [[f32; 2]; 2] = [[13.9898, 8.141], [3.4562, 17.398]];

/// What phases are taken modulo: not π.
#[expect(clippy::approx_constant, reason = "it is Material Maker's number")]
const TURN: f32 = 3.14;

/// What cosines are multiplied by.
const FACTOR: f32 = 43_758.5;

/// Where the lattice of a seed begins: two numbers of (seed, 1 − seed), which are hashed again, so that
/// no device may compute them.
fn start(seed: i32) -> [f32; 2] {
    let seed = seed as f32;
    DIRECTIONS.map(|[x, y]| {
        let phase = seed * x + (1.0 - seed) * y;
        let phase = phase - (phase / TURN).floor() * TURN;
        // The cosine to the last bit, whichever library there is.
        let product = f64::from(phase).cos() as f32 * FACTOR;
        product - product.floor()
    })
}

/// The hash of a lattice point for a seed, a whole number: its number less ½, times 2³².
pub(crate) fn plane<'b>(place: [Int<'b>; 2], seed: i32) -> Uint<'b> {
    let start = start(seed);
    let point = [0, 1].map(|axis| place[axis].to_float() + start[axis]);
    let [x, y] = DIRECTIONS[0].map(|factor| point[0].literal(factor));
    let phase = dot(point, [x, y]);
    let phase = phase - (phase / TURN).floor() * TURN;
    let product = phase.cos() * FACTOR;
    let value = product - product.floor();
    ((value - 0.5) * (1u64 << 32) as f32).to_int().to_uint()
}
