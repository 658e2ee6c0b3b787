//! What a filter removed from a noise, less what the mode carries of it.

use mipless_codegen::ir::Float;
use mipless_codegen::moments::Mode;

/// Below this a difference of shares of a variance is rounding.
const ROUNDING: f32 = 4e-7;

/// The variance that the filter removed from a noise of variance 1 beyond what the mode carries,
/// plus what fading drops: `energy` is the energy F that the filter leaves, with V₁ = −∂_λ F(λΣ)
/// and V₂ = ½ ∂²_λ F(λΣ) at λ = 1, and `fade` the factor of the carried mean and derivatives.
pub(super) fn remainder<'b>(mode: Mode, [f, v1, v2]: [Float<'b>; 3], fade: Float<'b>) -> Float<'b> {
    let zero = f.literal(0.0);
    // V − V₁ is at least V₂, and nothing is negative.
    let (carried, least) = match mode {
        Mode::Point | Mode::Naive | Mode::Ensemble => (zero, zero),
        Mode::Local => (v1, v2),
        Mode::Quad => (v1 + v2, zero),
    };
    let mut left = (1.0 - f) - carried;
    if mode > Mode::Ensemble {
        left = (left + -ROUNDING).max(least);
    }
    let uncarried = 1.0 - fade.square();
    let dropped = (1.0 - fade).square() * f;
    left.max(0.0) + uncarried * carried + dropped
}

/// `x` as a share of the way from `low` to `high`, within [0, 1].
pub(super) fn share(x: Float<'_>, low: f32, high: f32) -> Float<'_> {
    ((x + -low) * (1.0 / (high - low))).clamp(0.0, 1.0)
}
