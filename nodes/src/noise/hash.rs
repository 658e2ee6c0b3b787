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

/// The words of a lattice column and of a lattice row, for [`corner`]: linear in the coordinate, so
/// that neighbours differ by the factor.
pub(crate) const COLUMN_FACTOR: u32 = 0x85eb_ca77;
pub(crate) const ROW_FACTOR: u32 = 0x9e37_79b1;

/// The hash of a lattice point from the words of its column and its row, in half the steps of
/// [`Builder::scramble`]: only its leading bits are good, and they are what [`compass`] and
/// [`signed`] read. Over 10⁶ points no correlation at any offset stands out.
pub(crate) fn corner(b: &mut Builder, column: Value, row: Value) -> Value {
    let word = b.xor_u(column, row);
    let by = b.u32(15);
    let shifted = b.shr_u(word, by);
    let word = b.xor_u(word, shifted);
    let factor = b.u32(0x846c_a68b);
    b.mul_u(word, factor)
}

/// A number uniform in ±2³¹ from the leading bits of a hash.
pub(crate) fn signed(b: &mut Builder, hash: Value) -> Value {
    let signed = b.cast_i(hash);
    b.float_i(signed)
}

/// The length of [`compass`], to within 6 %.
pub(crate) const COMPASS_LENGTH: f32 = (1u64 << 60) as f32;

/// E[gₓ²] = E[g_y²] of [`compass`] in squared lengths; its components are uncorrelated.
pub(crate) const COMPASS_ENERGY: f32 = 8.0 / 15.0;

/// A random direction from the leading bits of a hash: sine and cosine as parabolas of a half turn
/// of 2³¹. It is not scaled, which would cost two operations a lattice point.
pub(crate) fn compass(b: &mut Builder, hash: Value) -> [Value; 2] {
    const HALF_TURN: f32 = (1u32 << 31) as f32;
    let angle = signed(b, hash);
    let magnitude = b.abs(angle);
    let (quarter, half) = (b.f32(0.5 * HALF_TURN), b.f32(HALF_TURN));
    let turned = b.sub(quarter, magnitude);
    let turned_magnitude = b.abs(turned);
    [(turned, turned_magnitude), (angle, magnitude)].map(|(t, magnitude)| {
        let rest = b.sub(half, magnitude);
        b.mul(t, rest)
    })
}
