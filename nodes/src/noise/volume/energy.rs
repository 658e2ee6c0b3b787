//! The energy that the filter leaves of a noise in space, and its derivatives by the footprint:
//! F(Σ)/F(0), and V₁ = −∂_λ F(λΣ), V₂ = ½ ∂²_λ F(λΣ) at λ = 1 as shares of F(0).

use super::spread::{Inverse, Spread};
use crate::noise::perlin::energy::{PRODUCT_WIDTH, WINDOW_WIDTH};
use mipless_codegen::ir::{Float, dot};

/// Of the quadrupole: from E[(kᵀBk)²] over Gaussian k and random B, with e = det(I + S),
/// F = (3 (tr P)² − 4 (3 + t)/e)/(15 √e).
pub(super) fn quadrupole<'b>(spread: &Spread<'b>, inverse: &Inverse<'b>) -> [Float<'b>; 3] {
    let (t, d) = (spread.trace, spread.determinant);
    let (m, shrink) = (inverse.minors, inverse.shrink);
    // All divided by e: n = e tr P and g = 3 + t with derivatives by λ, and those of e.
    let (double, bent, triple) = (t + t, m + m, d * 3.0);
    let n = double + m + 3.0;
    let n1 = double + bent;
    let g = t + 3.0;
    let e1 = t + bent + triple;
    let e2 = bent + (triple + triple);
    let [n, n1, n2, g, g1, e1, e2] = [n, n1, bent, g, t, e1, e2].map(|x| x * shrink);
    let h = n.square() * 3.0 - g * 4.0;
    let h1 = n * n1 * 6.0 - (g1 + g * e1) * 4.0;
    let cross = g1 * e1;
    let h2 = (n1 * n1 + n * n2) * 6.0 - (cross + cross + g * e2) * 4.0;

    // F = h e^{−5/2}, h relative to e².
    let root = shrink.sqrt() * (1.0 / 15.0);
    let v1 = h * e1 * 2.5 - h1;
    let curve = h * (e1.square() * 8.75 - e2 * 2.5);
    let v2 = (h2 - h1 * e1 * 5.0 + curve) * 0.5;
    [h, v1, v2].map(|x| x * root)
}

/// Of gradient noise with the quintic window, whose spectrum is that of three separable parts: with
/// D the diagonal of the spectra's widths, e(λ) = det(D + λΣ)/det D, and n(λ) the same of the two
/// axes along which the profile is w(t), each part is F = n e^{−3/2}. `width` is the unit of the
/// spread, in cells.
pub(super) fn quintic<'b>(spread: &Spread<'b>, width: f32) -> [Float<'b>; 3] {
    let b = spread.trace.builder();
    let area = width * width;
    let variances = spread.covariance.diagonal().map(|s| s * area);
    let minors = spread.adjugate.diagonal().map(|s| s * (area * area));
    let determinant = spread.determinant * (area * area * area);
    let mut shares = [b.float(0.0); 3];
    for along in 0..3 {
        let finer = |axis: usize| {
            1.0 / if axis == along {
                PRODUCT_WIDTH
            } else {
                WINDOW_WIDTH
            }
        };
        let factors = [0, 1, 2].map(|axis| b.float(finer(axis)));
        let others = [0, 1, 2].map(|axis| b.float(finer((axis + 1) % 3) * finer((axis + 2) % 3)));
        let linear = dot(factors, variances);
        let square = dot(others, minors);
        let cube = determinant * (finer(0) * finer(1) * finer(2));
        let inverse = 1.0 / (linear + square + cube + 1.0);
        // e′/e and e″/e.
        let first = (linear + 2.0 * square + 3.0 * cube) * inverse;
        let second = (2.0 * square + 6.0 * cube) * inverse;
        let rise = (variances[(along + 1) % 3] + variances[(along + 2) % 3]) * (1.0 / WINDOW_WIDTH);
        let bend = minors[along] * WINDOW_WIDTH.powi(-2);
        let n = rise + bend + 1.0;
        let slope = rise + 2.0 * bend;
        // F, −F′ and ½F″, all relative to e^{−3/2}.
        let fall = n * first * 1.5 - slope;
        let curve = n * (first.square() * 1.875 - second * 0.75) - slope * first * 1.5 + bend;
        let root = inverse.sqrt() * inverse * (1.0 / 3.0);
        for (share, part) in shares.iter_mut().zip([n, fall, curve]) {
            *share += part * root;
        }
    }
    shares
}
