//! What a hash of a lattice point decides, identical on every back end.

use mipless_codegen::ir::{Builder, Value};

/// (cos θ, sin θ) of a uniform angle, from the bits of a hash: a parabola refined once, within
/// 1.1e-3 of the circle. It defines the noise; nothing else depends on it.
pub(crate) fn direction(b: &mut Builder, hash: Value) -> [Value; 2] {
    let quarter = b.u32(0x4000_0000);
    let turned = b.add_u(hash, quarter);
    [turned, hash].map(|h| {
        // t in [−1, 1) half turns; sin πt ≈ y (0.775 + 0.225 |y|), y = 4t (1 − |t|).
        let signed = b.cast_i(h);
        let t = b.float_i(signed);
        let t = b.scale(t, 1.0 / (1u32 << 31) as f32);
        let magnitude = b.abs(t);
        let one = b.f32(1.0);
        let rest = b.sub(one, magnitude);
        let y = b.mul(t, rest);
        let y = b.scale(y, 4.0);
        let bend = b.abs(y);
        let bend = b.scale(bend, 0.225);
        let bend = b.offset(bend, 0.775);
        b.mul(y, bend)
    })
}
