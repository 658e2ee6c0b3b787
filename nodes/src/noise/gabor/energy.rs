//! The energy of the filtered Gabor noise and its derivatives by the footprint.

use super::{Gabor, congruent, form};
use mipless_codegen::ir::{Float, Sym2, Vec2, dot};
use std::f32::consts::PI;

/// Directions with weights, as angles from the orientation: one for a single direction, the
/// trapezoid rule for all of them, the rule of Gauss and Legendre between.
pub(super) fn directions(anisotropy: f32) -> Vec<[f32; 2]> {
    let half = 0.5 * PI * (1.0 - anisotropy);
    if anisotropy >= 1.0 {
        return vec![[0.0, 1.0]];
    }
    if anisotropy <= 0.0 {
        return (0..8u8)
            .map(|i| [PI * (f32::from(i) + 0.5) / 8.0, 0.125])
            .collect();
    }
    let rule = [
        [0.183_434_64, 0.362_683_78],
        [0.525_532_4, 0.313_706_65],
        [0.796_666_5, 0.222_381_03],
        [0.960_289_86, 0.101_228_54],
    ];
    (rule.iter())
        .flat_map(|[x, w]| [[-x * half, 0.5 * w], [x * half, 0.5 * w]])
        .collect()
}

/// The share of the energy that the filter leaves, F(Σ) = E[e^{−wᵀCw}] α²/√det T, and
/// V₁ = −∂_λ F(λΣ), V₂ = ½ ∂²_λ F(λΣ) at λ = 1, then E[∇M ∇Mᵀ]; `spread` is α²/√det T.
///
/// With Y = ΣP (eigenvalues y/(1 + y), y = s/α²): ∂_λ ln of a direction's term is
/// −α⁴ wᵀPΣPw − ½ tr Y, and ∂²_λ of it is 2α⁴ wᵀPΣPΣPw + ½ tr Y².
pub(super) fn energies<'b>(
    gabor: Gabor,
    orientation: Vec2<'b>,
    c: Sym2<'b>,
    p: Sym2<'b>,
    spread: Float<'b>,
) -> ([Float<'b>; 3], Sym2<'b>) {
    let area = gabor.alpha().powi(2);
    let turn = gabor.turn() * gabor.turn();
    // Y = C/α² is symmetric, for Σ and P commute; α²PY and α²PY² likewise.
    let y = c * (1.0 / area);
    let first = product(p, y);
    let second = product(first, y);
    let trace = y[0] + y[2];
    let cross = y[1].square();
    let trace_of_square = dot([y[0], y[2]], [y[0], y[2]]) + (cross + cross);

    let zero = spread.literal(0.0);
    let [mut f, mut v1, mut v2] = [zero; 3];
    let mut waves = Sym2::splat(zero);
    for [angle, weight] in directions(gabor.anisotropy) {
        let (sin, cos) = angle.sin_cos();
        let [x, y] = *orientation;
        let w = Vec2([x * cos - y * sin, x * sin + y * cos]);
        let energy = (form(w, c) * -turn).max(-80.0).exp() * weight;
        let l1 = form(w, first) * (area * area * turn) + trace * 0.5;
        let l2 = form(w, second) * (2.0 * area * area * turn) + trace_of_square * 0.5;
        f += energy;
        v1 += energy * l1;
        v2 += energy * (l1.square() + l2);
        waves = waves + w.outer() * energy;
    }
    let [f, v1, v2] = [f, v1, v2].map(|sum| sum * spread);
    // E[∇M ∇Mᵀ] = ½F P + α⁴ P E[F w wᵀ] P.
    let bent = congruent(p, waves * (spread * (area * area * turn)));
    ([f, v1, v2 * 0.5], p * f * 0.5 + bent)
}

/// The product of two matrices that commute.
pub(super) fn product<'b>(m: Sym2<'b>, n: Sym2<'b>) -> Sym2<'b> {
    Sym2([
        dot([m[0], m[1]], [n[0], n[1]]),
        dot([m[0], m[1]], [n[1], n[2]]),
        dot([m[1], m[2]], [n[1], n[2]]),
    ])
}
