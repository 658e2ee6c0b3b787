//! A polynomial times a Gaussian in place of the product of the quintic windows.
//!
//! With d in units of the Gaussian's width b, ∏ w(d_i) ≈ Q(d) e^{−d·d/2}, Q = q₀ + Σ_i P(d_i) and
//! P even of degree 6. A Gaussian footprint of covariance S turns it into an expectation: with
//! T = I + S, M = T⁻¹, μ = Md and C = SM, the filtered kernel is e^{−d·μ/2}/√det T times E of the
//! polynomial over a Gaussian of mean μ and covariance C. Of powers these are the heat polynomials,
//! H₀ = 1, H₁ = μ, Hₙ₊₁ = μHₙ + ncHₙ₋₁; and by Stein's lemma
//!
//! ```text
//! E[g·X Q(X)] = (g·μ) q + (Cg)·∇q,   q(μ) = E[Q(X)]
//! ```
//!
//! As Q is a sum over the axes, ∂_i∂_j q = 0 for i ≠ j.

use mipless_codegen::ir::{Float, dot};
use std::array;

/// Q and the width of the Gaussian.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fit {
    /// b, in cells.
    pub(crate) width: f32,
    /// q₀, and the coefficients of P: of t², t⁴ and t⁶, t in cells.
    coefficients: [f32; 4],
}

/// Gradient noise in the plane: the noise differs by 0.0233 of its standard deviation.
pub(super) const GRADIENT: Fit = Fit {
    width: 0.3625,
    coefficients: [0.971_121_2, 3.066_819_5, -7.744_056, 3.448_618],
};

/// Gradient noise in space: the noise differs by 0.0281 of its standard deviation.
pub(crate) const SPACE: Fit = Fit {
    width: 0.365,
    coefficients: [0.951_197_8, 3.217_369, -8.306_699, 3.731_257_7],
};

/// Value noise: the noise differs by 0.0109 of its standard deviation.
pub(super) const VALUE: Fit = Fit {
    width: 0.3775,
    coefficients: [1.002_915_8, 2.332_713_3, -6.760_1, 3.179_95],
};

/// Value noise with the cubic window: the noise differs by 0.0209 of its standard deviation.
pub(super) const CUBIC: Fit = Fit {
    width: 0.4325,
    coefficients: [0.980_097_6, 0.384_338_7, -2.077_853_3, 0.819_219_8],
};

/// What is random at a lattice point.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Weight<'b, const D: usize> {
    /// A factor.
    Number(Float<'b>),
    /// g of g·d, a direction.
    Direction([Float<'b>; D]),
}

/// The footprint as kernels see it, in units of b.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape<'b, const D: usize> {
    /// M.
    pub(crate) inverse: [[Float<'b>; D]; D],
    /// C.
    pub(crate) covariance: [[Float<'b>; D]; D],
    /// T.
    pub(crate) total: [[Float<'b>; D]; D],
}

/// q and its first three derivatives along each axis.
struct Expectation<'b, const D: usize> {
    value: Float<'b>,
    derivatives: [[Float<'b>; 3]; D],
}

/// A function of D numbers, its gradient and its Hessian.
struct Jet<'b, const D: usize> {
    value: Float<'b>,
    slopes: [Float<'b>; D],
    bends: [[Float<'b>; D]; D],
}

impl Fit {
    fn expectation<'b, const D: usize>(
        self,
        means: [Float<'b>; D],
        shape: &Shape<'b, D>,
    ) -> Expectation<'b, D> {
        let mut value = means[0].literal(self.coefficients[0]);
        let derivatives = array::from_fn(|i| {
            let (mean, variance) = (means[i], shape.covariance[i][i]);
            let mut heat = vec![mean.literal(1.0), mean];
            for n in 1..6 {
                heat.push(mean * heat[n] + variance * n as f32 * heat[n - 1]);
            }
            let [own, first, second, third] = array::from_fn(|order: usize| {
                let powers = self.coefficients.iter().enumerate().skip(1);
                let powers = powers.map(|(k, &coefficient)| (2 * k, coefficient));
                let terms =
                    powers
                        .filter(|&(power, _)| power >= order)
                        .map(|(power, coefficient)| {
                            // Hₙ′ = nHₙ₋₁.
                            let factor = (power - order + 1..=power).product::<usize>() as f32;
                            let factor = factor * coefficient * self.width.powi(power as i32);
                            heat[power - order] * factor
                        });
                mean.builder().sum(terms)
            });
            value += own;
            [first, second, third]
        });
        Expectation { value, derivatives }
    }

    /// The filtered kernel of a lattice point at the offset d, up to derivatives of `order` by d of
    /// all that depends on it (the pairs of axes row by row), without the envelope and with M still
    /// to be applied once for each derivative: ∇G − dG and
    /// ∇²G − d∇Gᵀ − ∇G dᵀ + (ddᵀ − T)G, where G is a function of μ.
    pub(crate) fn kernel<'b, const D: usize>(
        self,
        weight: Weight<'b, D>,
        (d, means): ([Float<'b>; D], [Float<'b>; D]),
        shape: &Shape<'b, D>,
        order: usize,
    ) -> Vec<Float<'b>> {
        let q = self.expectation(means, shape);
        let jet = match weight {
            Weight::Number(v) => Jet {
                value: v * q.value,
                slopes: q.derivatives.map(|[first, ..]| v * first),
                bends: array::from_fn(|i| {
                    let mut row = [v.literal(0.0); D];
                    row[i] = v * q.derivatives[i][1];
                    row
                }),
            },
            Weight::Direction(g) => {
                let along = dot(g, means);
                let turned = shape.covariance.map(|row| dot(row, g));
                let first = q.derivatives.map(|[first, ..]| first);
                Jet {
                    value: along * q.value + dot(turned, first),
                    slopes: array::from_fn(|i| {
                        let [first, second, _] = q.derivatives[i];
                        dot([g[i], along, turned[i]], [q.value, first, second])
                    }),
                    bends: array::from_fn(|i| {
                        array::from_fn(|j| {
                            let outer = g[i] * first[j] + g[j] * first[i];
                            if i != j {
                                return outer;
                            }
                            let [_, second, third] = q.derivatives[i];
                            outer + (along * second + turned[i] * third)
                        })
                    }),
                }
            }
        };
        bent(&jet, d, shape, order)
    }
}

/// Derivatives of e^{−d·μ/2} G by d.
fn bent<'b, const D: usize>(
    jet: &Jet<'b, D>,
    d: [Float<'b>; D],
    shape: &Shape<'b, D>,
    order: usize,
) -> Vec<Float<'b>> {
    let Jet {
        value,
        slopes,
        bends,
    } = *jet;
    let mut parts = vec![value];
    if order > 0 {
        parts.extend((0..D).map(|i| slopes[i] - d[i] * value));
    }
    if order > 1 {
        for i in 0..D {
            for j in i..D {
                let outer = d[i] * slopes[j] + d[j] * slopes[i];
                let own = (d[i] * d[j] - shape.total[i][j]) * value;
                parts.push(bends[i][j] - outer + own);
            }
        }
    }
    parts
}
