//! What a filter removed from a noise, less what the mode carries of it.

use mipless_codegen::ir::{Builder, Value};
use mipless_codegen::moments::Mode;

/// Below this a difference of shares of a variance is rounding.
const ROUNDING: f32 = 4e-7;

/// The variance that the filter removed from a noise of variance 1 beyond what the mode carries,
/// plus what fading drops: `energy` is the energy F that the filter leaves, with V₁ = −∂_λ F(λΣ)
/// and V₂ = ½ ∂²_λ F(λΣ) at λ = 1, and `fade` the factor of the carried mean and derivatives.
pub(super) fn remainder(b: &mut Builder, mode: Mode, energy: [Value; 3], fade: Value) -> Value {
    let [f, v1, v2] = energy;
    let (one, zero) = (b.f32(1.0), b.f32(0.0));
    let lost = b.sub(one, f);
    let kept = b.sub(one, fade);
    let dropped = b.square(kept);
    let dropped = b.mul(dropped, f);
    let square = b.square(fade);
    let uncarried = b.sub(one, square);
    // V − V₁ is at least V₂, and nothing is negative.
    let (carried, least) = match mode {
        Mode::Point | Mode::Naive | Mode::Ensemble => (zero, zero),
        Mode::Local => (v1, v2),
        Mode::Quad => (b.add(v1, v2), zero),
    };
    let mut left = b.sub(lost, carried);
    if mode > Mode::Ensemble {
        left = b.offset(left, -ROUNDING);
        left = b.max(left, least);
    }
    let left = b.max(left, zero);
    let back = b.mul(uncarried, carried);
    let left = b.add(left, back);
    b.add(left, dropped)
}

/// `x` as a share of the way from `low` to `high`, within [0, 1].
pub(super) fn share(b: &mut Builder, x: Value, low: f32, high: f32) -> Value {
    let x = b.offset(x, -low);
    let x = b.scale(x, 1.0 / (high - low));
    b.clamp(x, 0.0, 1.0)
}
