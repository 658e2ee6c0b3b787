//! What the value of a noise says of its second derivatives.
//!
//! Of a stationary noise E[M H] = −E[g gᵀ]: where the value is large the surface bends towards 0.
//! The regression of H on M is −E[g gᵀ] M/F with F = E[M²], so of the variance V₂ = ½E‖H‖² that a
//! footprint removes in the second order, κF with κ = ½‖E[g gᵀ]‖²/F² is locally κM². Without
//! Hessians that replaces as much of the remainder. For waves of one direction it is all of V₂.

use mipless_codegen::ir::{Builder, Value};

/// The remainder `rest` with the part κF at its local value: `outer` = E[g gᵀ] = E[JᵀWJ] given as W,
/// the covariance of the gradient by position, and the spread Σ of the position.
pub(crate) fn localized(
    b: &mut Builder,
    rest: Value,
    mean: Value,
    energy: Value,
    w: [Value; 3],
    s: [Value; 3],
) -> Value {
    // ‖E[g gᵀ]‖² = tr (WΣ)².
    let xx = b.dot(&[w[0], w[1]], &[s[0], s[1]]);
    let xy = b.dot(&[w[0], w[1]], &[s[1], s[2]]);
    let yx = b.dot(&[w[1], w[2]], &[s[0], s[1]]);
    let yy = b.dot(&[w[1], w[2]], &[s[1], s[2]]);
    let squares = b.dot(&[xx, yy], &[xx, yy]);
    let cross = b.mul(xy, yx);
    let cross = b.add(cross, cross);
    let norm = b.add(squares, cross);
    let tiny = b.f32(1e-6);
    let energy = b.max(energy, tiny);
    let half = b.scale(norm, 0.5);
    let expected = b.div(half, energy);
    let expected = b.min(expected, rest);
    let kept = b.sub(rest, expected);
    let square = b.square(mean);
    let share = b.div(square, energy);
    let local = b.mul(expected, share);
    b.add(kept, local)
}
