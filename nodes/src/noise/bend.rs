//! What the value of a noise says of its second derivatives.
//!
//! Of a stationary noise E[M H] = −E[g gᵀ]: where the value is large the surface bends towards 0.
//! The regression of H on M is −E[g gᵀ] M/F with F = E[M²], so of the variance V₂ = ½E‖H‖² that a
//! footprint removes in the second order, κF with κ = ½‖E[g gᵀ]‖²/F² is locally κM². Without
//! Hessians that replaces as much of the remainder. For waves of one direction it is all of V₂.

use mipless_codegen::ir::{Float, Sym2, dot};

/// The remainder `rest` with the part κF at its local value: `outer` = E[g gᵀ] = E[JᵀWJ] given as W,
/// the covariance of the gradient by position, and the spread Σ of the position.
pub(crate) fn localized<'b>(
    rest: Float<'b>,
    mean: Float<'b>,
    energy: Float<'b>,
    w: Sym2<'b>,
    s: Sym2<'b>,
) -> Float<'b> {
    // ‖E[g gᵀ]‖² = tr (WΣ)².
    let ([w11, w12, w22], [s11, s12, s22]) = (w.0, s.0);
    let xx = dot([w11, w12], [s11, s12]);
    let xy = dot([w11, w12], [s12, s22]);
    let yx = dot([w12, w22], [s11, s12]);
    let yy = dot([w12, w22], [s12, s22]);
    let cross = xy * yx;
    let norm = xx * xx + yy * yy + (cross + cross);

    let energy = energy.max(1e-6);
    let expected = (norm * 0.5 / energy).min(rest);
    (rest - expected) + expected * (mean.square() / energy)
}
