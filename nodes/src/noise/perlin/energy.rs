//! The energy that a filter leaves of a noise with the quintic window.

use super::Kind;
use mipless_codegen::ir::{Builder, Value};

/// The spectrum of w, |ŵ(k)|², is e^{−Ak²} (A is this) to within 2.3 % of the energy that any Gaussian filter
/// leaves or removes.
pub(in crate::noise) const WINDOW_WIDTH: f32 = 0.135_6;

/// That of t w is k² e^{−Bk²} (B is this), to within 6.6 %.
pub(in crate::noise) const PRODUCT_WIDTH: f32 = 0.107_2;

/// The footprint in squared cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Footprint {
    /// Σ₁₁, Σ₁₂, Σ₂₂.
    pub(super) covariance: [Value; 3],
    /// det Σ.
    pub(super) determinant: Value,
}

/// F(Σ)/F(0), and V₁ = −∂_λ F(λΣ), V₂ = ½ ∂²_λ F(λΣ) at λ = 1 as shares of F(0). The spectra are
/// positive, so all three and 1 − F − V₁ − V₂ are.
pub(super) fn energies(b: &mut Builder, kind: Kind, footprint: &Footprint) -> [Value; 3] {
    let [xx, _, yy] = footprint.covariance;
    match kind {
        Kind::Value => term(b, footprint, [WINDOW_WIDTH, WINDOW_WIDTH], None),
        Kind::Gradient => {
            let along = term(b, footprint, [PRODUCT_WIDTH, WINDOW_WIDTH], Some(yy));
            let across = term(b, footprint, [WINDOW_WIDTH, PRODUCT_WIDTH], Some(xx));
            let mut both = [along[0]; 3];
            for (i, sum) in both.iter_mut().enumerate() {
                let total = b.add(along[i], across[i]);
                *sum = b.scale(total, 0.5);
            }
            both
        }
    }
}

/// One separable part of the spectrum: with D the diagonal of `widths`, e(λ) = det(D + λΣ)/det D
/// and n(λ) = 1 + λ s/A, F = n e^{−3/2} where there is an s, and e^{−1/2} else.
fn term(b: &mut Builder, footprint: &Footprint, widths: [f32; 2], s: Option<Value>) -> [Value; 3] {
    let [xx, _, yy] = footprint.covariance;
    let [p, q] = widths.map(|w| 1.0 / w);
    let bent = b.scale(footprint.determinant, p * q);
    let (along, across) = (b.scale(xx, p), b.scale(yy, q));
    let linear = b.add(along, across);
    let e = b.offset(linear, 1.0);
    let e = b.add(e, bent);
    let one = b.f32(1.0);
    let inverse = b.div(one, e);
    // e′/e and e″/e.
    let double = b.add(bent, bent);
    let first = b.add(linear, double);
    let first = b.mul(first, inverse);
    let second = b.mul(double, inverse);
    let square = b.square(first);
    let root = b.sqrt(inverse);
    let Some(s) = s else {
        let v1 = b.scale(first, 0.5);
        let (square, second) = (b.scale(square, 0.375), b.scale(second, 0.25));
        let v2 = b.sub(square, second);
        return [root, b.mul(v1, root), b.mul(v2, root)];
    };
    let slope = b.scale(s, 1.0 / WINDOW_WIDTH);
    let n = b.offset(slope, 1.0);
    let root = b.mul(root, inverse);
    let fall = b.mul(n, first);
    let fall = b.scale(fall, 1.5);
    let v1 = b.sub(fall, slope);
    let (square, second) = (b.scale(square, 1.875), b.scale(second, 0.75));
    let bend = b.sub(square, second);
    let bend = b.mul(n, bend);
    let cross = b.mul(slope, first);
    let cross = b.scale(cross, 1.5);
    let v2 = b.sub(bend, cross);
    [b.mul(n, root), b.mul(v1, root), b.mul(v2, root)]
}
