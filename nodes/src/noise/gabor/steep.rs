//! The slopes that a footprint removes from Gabor noise.

use super::energy::{directions, product};
use super::{Gabor, congruent, form};
use crate::noise::cell::place::declared_spread;
use crate::noise::field::Spread;
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Float, FunctionRef, Module, Sym2, Vec2, dot};
use mipless_codegen::moments::Signal;

/// R(Σ) = S(0) − G(Σ) + ∂_λ G(λΣ) at λ = 1, with G = E[∇M ∇Mᵀ] (`noise/steep.rs`), at this position.
pub(crate) fn steepness<'b>(
    lower: &mut Lower<'_, 'b>,
    position: &[Signal<'b>],
    gabor: Gabor,
    orientation: Vec2<'b>,
) -> Sym2<'b> {
    let key = format!("gabor steepness {} {gabor:?}", gabor.turn());
    let function = lower.function(&key, |module| build(module, gabor));
    let Spread {
        covariance,
        eigenvalues,
    } = Spread::of(position);
    let arguments = (orientation, (covariance, eigenvalues));
    let results = lower.b().call(&function, arguments);
    Sym2([results[0], results[1], results[2]])
}

/// With W(λ) = E[e^{−wᵀCw} ŵŵᵀ], A = PWP and c = |w|² α⁴ · α²/√det T: G = ½F P + c A. By λ, with Y = ΣP
/// and C′ = α⁴ ΣP²: P′ = −PΣP, F′ = −V₁, c′ = −½ tr Y c, and A′ = −(YA + AY) − P E[wᵀC′w …] P.
fn build(module: &mut Module, gabor: Gabor) -> FunctionRef {
    let b = &Builder::new(
        "gabor_steepness",
        "The slopes that a footprint removes from Gabor noise.",
    );
    let orientation = Vec2(b.float_params(["cosine", "sine"]));
    let Spread {
        covariance: s,
        eigenvalues: [major, minor],
    } = declared_spread(b);
    let area = gabor.alpha().powi(2);
    let turn = gabor.turn() * gabor.turn();
    let determinant = (major + area) * (minor + area);
    let inverse = 1.0 / determinant;
    let p = Sym2([
        (s[2] + area) * inverse,
        -(s[1] * inverse),
        (s[0] + area) * inverse,
    ]);
    // Y = ΣP without the difference: (Σ + det Σ/α² I) α²/det T, and C = α² Y.
    let diagonal = major * minor * (1.0 / area);
    let scale = area * inverse;
    let y = Sym2([s[0] + diagonal, s[1], s[2] + diagonal]) * scale;
    let c = y * area;
    let moved = product(p, y);
    let trace = y[0] + y[2];
    let strength = inverse.sqrt() * area;

    let none = b.float(0.0);
    let [mut f, mut v1] = [none; 2];
    let [mut waves, mut turned, mut still] = [Sym2::splat(none); 3];
    for [angle, weight] in directions(gabor.anisotropy) {
        let (sin, cos) = angle.sin_cos();
        let [x, y] = *orientation;
        let w = Vec2([x * cos - y * sin, x * sin + y * cos]);
        let energy = (form(w, c) * -turn).max(-80.0).exp() * weight;
        let faster = form(w, moved) * (area * area * turn);
        f += energy;
        v1 += energy * (faster + trace * 0.5);
        waves = waves + w.outer() * energy;
        turned = turned + w.outer() * (energy * faster);
        still = still + w.outer() * weight;
    }
    let [f, v1] = [f, v1].map(|sum| sum * strength);
    let steep = strength * (area * area * turn);
    let bent = congruent(p, waves) * steep;
    let left = p * (f * 0.5) + bent;
    let response = p * (v1 * 0.5)
        + moved * (f * 0.5)
        + bent * (trace * 0.5)
        + twice_symmetric(y, bent)
        + congruent(p, turned) * steep;
    let whole = still * turn;
    let own = b.float(0.5 / area);
    let [xx, xy, yy] = *(whole + -(left + response));
    b.results(["uu", "uv", "vv"], [xx + own, xy, yy + own]);
    b.finish(module)
}

/// MN + NM.
fn twice_symmetric<'b>(m: Sym2<'b>, n: Sym2<'b>) -> Sym2<'b> {
    let ([m11, m12, m22], [n11, n12, n22]): ([Float<'b>; 3], [Float<'b>; 3]) = (m.0, n.0);
    Sym2([
        2.0 * dot([m11, m12], [n11, n12]),
        m12 * (n11 + n22) + n12 * (m11 + m22),
        2.0 * dot([m12, m22], [n12, n22]),
    ])
}
