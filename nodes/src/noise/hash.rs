//! What a hash of a lattice point decides, identical on every back end.

use mipless_codegen::ir::{Builder, Value};

/// What a step along x and y adds to the key of a lattice point. The keys of two points are equal
/// only if they lie 63,000 cells apart, the most that 32 bits allow.
const FACTORS: [u32; 2] = [0x9e37_79b1, 0x27d4_eb2f];

/// What the next octave adds to the keys.
pub(crate) const NEXT_OCTAVE: u32 = 0x85eb_ca6b;

/// What one step along x and along y adds to a key.
pub(crate) fn steps(b: &mut Builder) -> [Value; 2] {
    FACTORS.map(|factor| b.u32(factor))
}

/// `key` after `cells` (an i32) steps, each of which adds `step`.
pub(crate) fn walked(b: &mut Builder, key: Value, cells: Value, step: Value) -> Value {
    let cells = b.cast_u(cells);
    let walked = b.mul_u(cells, step);
    b.add_u(key, walked)
}

/// The key of a lattice point: what is scrambled to its random number.
pub(crate) fn key(b: &mut Builder, cells: [Value; 2], seed: Value) -> Value {
    let [x, y] = steps(b);
    let key = walked(b, seed, cells[0], x);
    walked(b, key, cells[1], y)
}

/// (cos θ, sin θ) of a uniform angle, from the bits of a hash: a parabola refined once, within
/// 1.1e-3 of the circle. It defines the noise; nothing else depends on it.
pub(crate) fn direction(b: &mut Builder, hash: Value) -> [Value; 2] {
    let quarter = b.u32(0x4000_0000);
    let turned = b.add_u(hash, quarter);
    [turned, hash].map(|h| {
        // t in [−1, 1) half turns; sin πt ≈ y (0.775 + 0.225 |y|), y = 4t (1 − |t|).
        const HALF_TURN: f32 = (1u32 << 31) as f32;
        let signed = b.cast_i(h);
        let signed = b.float_i(signed);
        let magnitude = b.abs(signed);
        let slope = b.scale(magnitude, -4.0 / HALF_TURN / HALF_TURN);
        let slope = b.offset(slope, 4.0 / HALF_TURN);
        let y = b.mul(signed, slope);
        let bend = b.abs(y);
        let bend = b.scale(bend, 0.225);
        let bend = b.offset(bend, 0.775);
        b.mul(y, bend)
    })
}
