//! The energy of the filtered Gabor noise and its derivatives by the footprint.

use super::Gabor;
use mipless_codegen::ir::{Builder, Value};
use std::f32::consts::PI;

/// Directions with weights, as angles from the orientation: one for a single direction, the
/// trapezoid rule for all of them, the rule of Gauss and Legendre between.
fn directions(anisotropy: f32) -> Vec<[f32; 2]> {
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
pub(super) fn energies(
    b: &mut Builder,
    gabor: Gabor,
    orientation: [Value; 2],
    c: [Value; 3],
    p: [Value; 3],
    spread: Value,
) -> ([Value; 3], [Value; 3]) {
    let area = gabor.alpha().powi(2);
    // Y = C/α² is symmetric, for Σ and P commute; α²PY and α²PY² likewise.
    let y = c.map(|c| b.scale(c, 1.0 / area));
    let multiply = |b: &mut Builder, m: [Value; 3], n: [Value; 3]| {
        [
            b.dot(&[m[0], m[1]], &[n[0], n[1]]),
            b.dot(&[m[0], m[1]], &[n[1], n[2]]),
            b.dot(&[m[1], m[2]], &[n[1], n[2]]),
        ]
    };
    let first = multiply(b, p, y);
    let second = multiply(b, first, y);
    let trace = b.add(y[0], y[2]);
    let cross = b.square(y[1]);
    let cross = b.add(cross, cross);
    let squares = b.dot(&[y[0], y[2]], &[y[0], y[2]]);
    let trace2 = b.add(squares, cross);
    let (zero, one) = (b.f32(0.0), b.f32(1.0));
    let turn = gabor.turn() * gabor.turn();
    let mut sums = [zero; 3];
    let mut waves = [zero; 3];
    for [angle, weight] in directions(gabor.anisotropy) {
        let (sin, cos) = angle.sin_cos();
        let (x, y) = (b.scale(orientation[0], cos), b.scale(orientation[1], sin));
        let wx = b.sub(x, y);
        let (x, y) = (b.scale(orientation[0], sin), b.scale(orientation[1], cos));
        let wy = b.add(x, y);
        let (xx, yx, yy) = (b.square(wx), b.mul(wx, wy), b.square(wy));
        let xy = b.add(yx, yx);
        let form = |b: &mut Builder, m: [Value; 3], factor: f32| {
            let form = b.dot(&[xx, xy, yy], &m);
            b.scale(form, factor)
        };
        let exponent = form(b, c, -turn);
        let least = b.f32(-80.0);
        let exponent = b.max(exponent, least);
        let energy = b.exp(exponent);
        let energy = b.scale(energy, weight);
        let half = b.scale(trace, 0.5);
        let l1 = form(b, first, area * area * turn);
        let l1 = b.add(l1, half);
        let l2 = form(b, second, 2.0 * area * area * turn);
        let half = b.scale(trace2, 0.5);
        let l2 = b.add(l2, half);
        let bend = b.square(l1);
        let bend = b.add(bend, l2);
        for (wave, square) in waves.iter_mut().zip([xx, yx, yy]) {
            let part = b.mul(energy, square);
            *wave = b.add(*wave, part);
        }
        let parts = [one, l1, bend];
        for (sum, part) in sums.iter_mut().zip(parts) {
            let part = b.mul(energy, part);
            *sum = b.add(*sum, part);
        }
    }
    let [f, v1, v2] = sums.map(|sum| b.mul(sum, spread));
    // E[∇M ∇Mᵀ] = ½F P + α⁴ P E[F w wᵀ] P.
    let factor = b.scale(spread, area * area * turn);
    let inner = waves.map(|wave| b.mul(wave, factor));
    let rows = [[p[0], p[1]], [p[1], p[2]]];
    let mut slopes = [zero; 3];
    for (slope, (i, j)) in slopes.iter_mut().zip([(0, 0), (0, 1), (1, 1)]) {
        let left = b.dot(&[inner[0], inner[1]], &rows[j]);
        let right = b.dot(&[inner[1], inner[2]], &rows[j]);
        let own = b.mul(f, rows[i][j]);
        let own = b.scale(own, 0.5);
        let bent = b.dot(&rows[i], &[left, right]);
        *slope = b.add(own, bent);
    }
    ([f, v1, b.scale(v2, 0.5)], slopes)
}
