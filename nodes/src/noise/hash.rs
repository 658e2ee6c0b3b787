//! What a hash of a lattice point decides, identical on every back end.

use mipless_codegen::ir::{Builder, Float, Int, Uint};

/// What a step along x and y adds to the key of a lattice point. The keys of two points are equal
/// only if they lie 63,000 cells apart, the most that 32 bits allow.
const FACTORS: [u32; 2] = [0x9e37_79b1, 0x27d4_eb2f];

/// What the next octave adds to the keys.
pub(crate) const NEXT_OCTAVE: u32 = 0x85eb_ca6b;

/// What one step along x and along y adds to a key.
pub(crate) fn steps(b: &Builder) -> [Uint<'_>; 2] {
    FACTORS.map(|factor| b.uint(factor))
}

/// `key` after so many steps, each of which adds `step`.
pub(crate) fn walked<'b>(key: Uint<'b>, cells: Int<'b>, step: Uint<'b>) -> Uint<'b> {
    key + cells.to_uint() * step
}

/// The key of a lattice point: what is scrambled to its random number.
pub(crate) fn key<'b>([x, y]: [Int<'b>; 2], seed: Uint<'b>) -> Uint<'b> {
    let [step_x, step_y] = steps(seed.builder());
    walked(walked(seed, x, step_x), y, step_y)
}

/// (cos θ, sin θ) of a uniform angle, from the bits of a hash: a parabola refined once, within
/// 1.1e-3 of the circle. It defines the noise; nothing else depends on it.
pub(crate) fn direction(hash: Uint<'_>) -> [Float<'_>; 2] {
    const HALF_TURN: f32 = (1u32 << 31) as f32;
    [hash + 0x4000_0000, hash].map(|hash| {
        // t in [−1, 1) half turns; sin πt ≈ y (0.775 + 0.225 |y|), y = 4t (1 − |t|).
        let t = signed(hash);
        let y = t * (t.abs() * (-4.0 / HALF_TURN / HALF_TURN) + 4.0 / HALF_TURN);
        y * (y.abs() * 0.225 + 0.775)
    })
}

/// What a step along x and along y adds to what [`word`] mixes.
pub(crate) const AXES: [u32; 2] = [0x85eb_ca77, 0x9e37_79b1];

/// The word of a lattice column or row, for [`corner`], from its number times the factor of its axis
/// (and, along one axis, the seed). Without this step a corner would be even: −a xor −b is a xor b
/// but for trailing bits, so that a lattice would be its own point reflection.
pub(crate) fn word(line: Uint<'_>) -> Uint<'_> {
    (line ^ (line >> 15)) * 0x2c1b_3c6d
}

/// The hash of a lattice point from the words of its column and its row: only its leading bits are
/// good, and they are what [`compass`] and [`signed`] read. Words are made once a line, and are half
/// of the steps of [`Uint::scramble`]; corners are the other half. Over 1.6 · 10⁵ points no
/// correlation with a reflection, a mirror image, a transposition or a shift by 2ᵏ cells along an
/// axis or a diagonal, k up to 31, stands out.
pub(crate) fn corner<'b>(column: Uint<'b>, row: Uint<'b>) -> Uint<'b> {
    let word = column ^ row;
    (word ^ (word >> 15)) * 0x846c_a68b
}

/// A number uniform in ±2³¹ from the leading bits of a hash.
pub(crate) fn signed(hash: Uint<'_>) -> Float<'_> {
    hash.to_int().to_float()
}

/// The length of [`compass`], to within 6 %.
pub(crate) const COMPASS_LENGTH: f32 = (1u64 << 60) as f32;

/// E[gₓ²] = E[g_y²] of [`compass`] in squared lengths; its components are uncorrelated.
pub(crate) const COMPASS_ENERGY: f32 = 8.0 / 15.0;

/// A random direction from the leading bits of a hash: sine and cosine as parabolas of a half turn
/// of 2³¹. It is not scaled, which would cost two operations a lattice point.
pub(crate) fn compass(hash: Uint<'_>) -> [Float<'_>; 2] {
    const HALF_TURN: f32 = (1u32 << 31) as f32;
    let angle = signed(hash);
    [0.5 * HALF_TURN - angle.abs(), angle].map(|t| t * (HALF_TURN - t.abs()))
}
