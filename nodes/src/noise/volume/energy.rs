//! The energy that the filter leaves of a noise in space, and its derivatives by the footprint:
//! F(Σ)/F(0), and V₁ = −∂_λ F(λΣ), V₂ = ½ ∂²_λ F(λΣ) at λ = 1 as shares of F(0).

use super::PAIRS;
use super::spread::{Inverse, Spread};
use crate::noise::perlin::energy::{PRODUCT_WIDTH, WINDOW_WIDTH};
use mipless_codegen::ir::{Builder, Value};

/// Of the quadrupole: from E[(kᵀBk)²] over Gaussian k and random B, with e = det(I + S),
/// F = (3 (tr P)² − 4 (3 + t)/e)/(15 √e).
pub(super) fn quadrupole(b: &mut Builder, spread: &Spread, inverse: &Inverse) -> [Value; 3] {
    let (t, d) = (spread.trace, spread.determinant);
    let (m, shrink) = (inverse.minors, inverse.shrink);
    // All divided by e: n = e tr P and g = 3 + t with derivatives by λ, and those of e.
    let double = b.add(t, t);
    let n = b.add(double, m);
    let n = b.offset(n, 3.0);
    let bent = b.add(m, m);
    let n1 = b.add(double, bent);
    let g = b.offset(t, 3.0);
    let triple = b.scale(d, 3.0);
    let e1 = b.add(t, bent);
    let e1 = b.add(e1, triple);
    let six = b.add(triple, triple);
    let e2 = b.add(bent, six);
    let [n, n1, n2, g, g1, e1, e2] = [n, n1, bent, g, t, e1, e2].map(|x| b.mul(x, shrink));
    let square = b.square(n);
    let square = b.scale(square, 3.0);
    let fall = b.scale(g, 4.0);
    let h = b.sub(square, fall);
    let rise = b.mul(n, n1);
    let rise = b.scale(rise, 6.0);
    let ge = b.mul(g, e1);
    let ge = b.add(g1, ge);
    let ge = b.scale(ge, 4.0);
    let h1 = b.sub(rise, ge);
    let bend = b.dot(&[n1, n], &[n1, n2]);
    let bend = b.scale(bend, 6.0);
    let cross = b.mul(g1, e1);
    let cross = b.add(cross, cross);
    let last = b.mul(g, e2);
    let cross = b.add(cross, last);
    let cross = b.scale(cross, 4.0);
    let h2 = b.sub(bend, cross);

    // F = h e^{−5/2}, h relative to e².
    let root = b.sqrt(shrink);
    let root = b.scale(root, 1.0 / 15.0);
    let drop = b.mul(h, e1);
    let drop = b.scale(drop, 2.5);
    let v1 = b.sub(drop, h1);
    let squared = b.square(e1);
    let squared = b.scale(squared, 8.75);
    let halved = b.scale(e2, 2.5);
    let curve = b.sub(squared, halved);
    let curve = b.mul(h, curve);
    let slope = b.mul(h1, e1);
    let slope = b.scale(slope, 5.0);
    let v2 = b.sub(h2, slope);
    let v2 = b.add(v2, curve);
    let v2 = b.scale(v2, 0.5);
    [h, v1, v2].map(|x| b.mul(x, root))
}

/// Of gradient noise with the quintic window, whose spectrum is that of three separable parts: with
/// D the diagonal of the spectra's widths, e(λ) = det(D + λΣ)/det D, and n(λ) the same of the two
/// axes along which the profile is w(t), each part is F = n e^{−3/2}. `width` is the unit of the
/// spread, in cells.
pub(super) fn quintic(b: &mut Builder, spread: &Spread, width: f32) -> [Value; 3] {
    let area = width * width;
    let diagonal: Vec<usize> = (0..PAIRS.len())
        .filter(|&at| PAIRS[at][0] == PAIRS[at][1])
        .collect();
    let variances: Vec<Value> = (diagonal.iter())
        .map(|&at| b.scale(spread.covariance[at], area))
        .collect();
    let minors: Vec<Value> = (diagonal.iter())
        .map(|&at| b.scale(spread.adjugate[at], area * area))
        .collect();
    let determinant = b.scale(spread.determinant, area * area * area);
    let one = b.f32(1.0);
    let mut shares = [b.f32(0.0); 3];
    for along in 0..3 {
        let finer = |axis: usize| {
            1.0 / if axis == along {
                PRODUCT_WIDTH
            } else {
                WINDOW_WIDTH
            }
        };
        let factors: [Value; 3] = [0, 1, 2].map(|axis| b.f32(finer(axis)));
        let others = [0, 1, 2].map(|axis| b.f32(finer((axis + 1) % 3) * finer((axis + 2) % 3)));
        let linear = b.dot(&factors, &variances);
        let square = b.dot(&others, &minors);
        let cube = b.scale(determinant, finer(0) * finer(1) * finer(2));
        let e = b.add(linear, square);
        let e = b.add(e, cube);
        let e = b.offset(e, 1.0);
        let inverse = b.div(one, e);
        // e′/e and e″/e.
        let (two, three, six) = (b.f32(2.0), b.f32(3.0), b.f32(6.0));
        let first = b.dot(&[one, two, three], &[linear, square, cube]);
        let first = b.mul(first, inverse);
        let second = b.dot(&[two, six], &[square, cube]);
        let second = b.mul(second, inverse);
        let sum = b.add(variances[(along + 1) % 3], variances[(along + 2) % 3]);
        let rise = b.scale(sum, 1.0 / WINDOW_WIDTH);
        let bend = b.scale(minors[along], WINDOW_WIDTH.powi(-2));
        let n = b.add(rise, bend);
        let n = b.offset(n, 1.0);
        let slope = b.dot(&[one, two], &[rise, bend]);
        // F, −F′ and ½F″, all relative to e^{−3/2}.
        let fall = b.mul(n, first);
        let fall = b.scale(fall, 1.5);
        let fall = b.sub(fall, slope);
        let curve = b.square(first);
        let (curve, turn) = (b.scale(curve, 1.875), b.scale(second, 0.75));
        let curve = b.sub(curve, turn);
        let curve = b.mul(n, curve);
        let cross = b.mul(slope, first);
        let cross = b.scale(cross, 1.5);
        let curve = b.sub(curve, cross);
        let curve = b.add(curve, bend);
        let root = b.sqrt(inverse);
        let root = b.mul(root, inverse);
        let root = b.scale(root, 1.0 / 3.0);
        for (share, part) in shares.iter_mut().zip([n, fall, curve]) {
            let part = b.mul(part, root);
            *share = b.add(*share, part);
        }
    }
    shares
}
