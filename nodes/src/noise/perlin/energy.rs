//! The energy that a filter leaves of a noise with the quintic window.

use super::Kind;
use mipless_codegen::ir::{Float, Sym2};

/// The spectrum of w, |ŵ(k)|², is e^{−Ak²} (A is this) to within 2.3 % of the energy that any Gaussian filter
/// leaves or removes.
pub(in crate::noise) const WINDOW_WIDTH: f32 = 0.135_6;

/// That of the cubic window, to within 2.4 %.
const CUBIC_WIDTH: f32 = 0.152_2;

/// That of t w is k² e^{−Bk²} (B is this), to within 6.6 %.
pub(in crate::noise) const PRODUCT_WIDTH: f32 = 0.107_2;

/// The footprint in squared cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Footprint<'b> {
    /// Σ.
    pub(super) covariance: Sym2<'b>,
    /// det Σ.
    pub(super) determinant: Float<'b>,
}

/// F(Σ)/F(0), and V₁ = −∂_λ F(λΣ), V₂ = ½ ∂²_λ F(λΣ) at λ = 1 as shares of F(0). The spectra are
/// positive, so all three and 1 − F − V₁ − V₂ are.
pub(super) fn energies<'b>(kind: Kind, footprint: &Footprint<'b>) -> [Float<'b>; 3] {
    let [xx, _, yy] = *footprint.covariance;
    match kind {
        Kind::Value => term(footprint, [WINDOW_WIDTH, WINDOW_WIDTH], None),
        Kind::Materialmaker { .. } => term(footprint, [CUBIC_WIDTH, CUBIC_WIDTH], None),
        Kind::Gradient | Kind::Materialx(_) => {
            let along = term(footprint, [PRODUCT_WIDTH, WINDOW_WIDTH], Some(yy));
            let across = term(footprint, [WINDOW_WIDTH, PRODUCT_WIDTH], Some(xx));
            std::array::from_fn(|i| (along[i] + across[i]) * 0.5)
        }
    }
}

/// One separable part of the spectrum: with D the diagonal of `widths`, e(λ) = det(D + λΣ)/det D
/// and n(λ) = 1 + λ s/A, F = n e^{−3/2} where there is an s, and e^{−1/2} else.
fn term<'b>(footprint: &Footprint<'b>, widths: [f32; 2], s: Option<Float<'b>>) -> [Float<'b>; 3] {
    let [xx, _, yy] = *footprint.covariance;
    let [p, q] = widths.map(|w| 1.0 / w);
    let bent = footprint.determinant * (p * q);
    let linear = xx * p + yy * q;
    let inverse = 1.0 / (linear + 1.0 + bent);
    // e′/e and e″/e.
    let double = bent + bent;
    let first = (linear + double) * inverse;
    let second = double * inverse;
    let square = first.square();
    let root = inverse.sqrt();
    let Some(s) = s else {
        let v2 = square * 0.375 - second * 0.25;
        return [root, first * 0.5 * root, v2 * root];
    };
    let slope = s * (1.0 / WINDOW_WIDTH);
    let n = slope + 1.0;
    let root = root * inverse;
    let v1 = n * first * 1.5 - slope;
    let v2 = n * (square * 1.875 - second * 0.75) - slope * first * 1.5;
    [n * root, v1 * root, v2 * root]
}
