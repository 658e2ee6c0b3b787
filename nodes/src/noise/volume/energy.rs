//! The energy of the filtered noise in space and its derivatives by the footprint.

use super::spread::Spread;
use mipless_codegen::ir::{Builder, Value};

/// (I + S)⁻¹ and the energy that the filter leaves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Energy {
    /// P, in the order of the pairs.
    pub(super) inverse: [Value; 6],
    /// tr P.
    pub(super) trace: Value,
    /// 1/det(I + S).
    pub(super) shrink: Value,
    /// F(Σ)/F(0), and V₁ = −∂_λ F(λΣ), V₂ = ½ ∂²_λ F(λΣ) at λ = 1 as shares of F(0).
    pub(super) shares: [Value; 3],
}

impl Energy {
    /// With t = tr S, m = tr adj S, e = 1 + t + m + det S: P = ((1 + t)I − S + adj S)/e, and from
    /// E[(kᵀBk)²] over Gaussian k and random B, F = (3 (tr P)² − 4 (3 + t)/e)/(15 √e).
    pub(super) fn of(b: &mut Builder, spread: &Spread) -> Self {
        let one = b.f32(1.0);
        let t = spread.trace;
        let [a, c] = [0, 3].map(|at| spread.adjugate[at]);
        let m = b.add(a, c);
        let m = b.add(m, spread.adjugate[5]);
        let zero = b.f32(0.0);
        let m = b.max(m, zero);
        let d = spread.determinant;
        let e = b.add(t, m);
        let e = b.add(e, d);
        let e = b.offset(e, 1.0);
        let shrink = b.div(one, e);
        // 1 + t − S₁₁ is 1 + S₂₂ + S₃₃, without a difference.
        let diagonal = [0, 3, 5].map(|at| spread.covariance[at]);
        let mut inverse = spread.covariance;
        for (at, out) in inverse.iter_mut().enumerate() {
            let first = match at {
                0 => b.add(diagonal[1], diagonal[2]),
                3 => b.add(diagonal[0], diagonal[2]),
                5 => b.add(diagonal[0], diagonal[1]),
                _ => b.neg(spread.covariance[at]),
            };
            let first = match at {
                0 | 3 | 5 => b.offset(first, 1.0),
                _ => first,
            };
            let sum = b.add(first, spread.adjugate[at]);
            *out = b.mul(sum, shrink);
        }

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
        Self {
            inverse,
            trace: n,
            shrink,
            shares: [h, v1, v2].map(|x| b.mul(x, root)),
        }
    }
}
