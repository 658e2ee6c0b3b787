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

use mipless_codegen::ir::{Builder, Value};

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

/// What is random at a lattice point.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Weight<const D: usize> {
    /// A factor.
    Number(Value),
    /// g of g·d, a direction.
    Direction([Value; D]),
}

/// The footprint as kernels see it, in units of b.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape<const D: usize> {
    /// M.
    pub(crate) inverse: [[Value; D]; D],
    /// C.
    pub(crate) covariance: [[Value; D]; D],
    /// T.
    pub(crate) total: [[Value; D]; D],
}

/// q and its first three derivatives along each axis.
struct Expectation<const D: usize> {
    value: Value,
    derivatives: [[Value; 3]; D],
}

impl Fit {
    fn expectation<const D: usize>(
        self,
        b: &mut Builder,
        means: [Value; D],
        shape: &Shape<D>,
    ) -> Expectation<D> {
        let mut value = b.f32(self.coefficients[0]);
        let derivatives = std::array::from_fn(|i| {
            let (mean, variance) = (means[i], shape.covariance[i][i]);
            let mut heat = vec![b.f32(1.0), mean];
            for n in 1..6 {
                let rise = b.mul(mean, heat[n]);
                let spread = b.scale(variance, n as f32);
                let spread = b.mul(spread, heat[n - 1]);
                heat.push(b.add(rise, spread));
            }
            let [own, first, second, third] = std::array::from_fn(|order: usize| {
                let mut sum = b.f32(0.0);
                for (k, &coefficient) in self.coefficients.iter().enumerate().skip(1) {
                    let power = 2 * k;
                    if power < order {
                        continue;
                    }
                    // Hₙ′ = nHₙ₋₁.
                    let factor = (power - order + 1..=power).product::<usize>() as f32;
                    let factor = factor * coefficient * self.width.powi(power as i32);
                    let part = b.scale(heat[power - order], factor);
                    sum = b.add(sum, part);
                }
                sum
            });
            value = b.add(value, own);
            [first, second, third]
        });
        Expectation { value, derivatives }
    }

    /// The filtered kernel of a lattice point at the offset d, up to derivatives of `order` by d of
    /// all that depends on it (the pairs of axes row by row), without the envelope and with M still
    /// to be applied once for each derivative: ∇G − dG and
    /// ∇²G − d∇Gᵀ − ∇G dᵀ + (ddᵀ − T)G, where G is a function of μ.
    pub(crate) fn kernel<const D: usize>(
        self,
        b: &mut Builder,
        weight: Weight<D>,
        (d, means): ([Value; D], [Value; D]),
        shape: &Shape<D>,
        order: usize,
    ) -> Vec<Value> {
        let q = self.expectation(b, means, shape);
        let (value, slopes, bends) = match weight {
            Weight::Number(v) => (
                b.mul(v, q.value),
                q.derivatives.map(|[first, ..]| b.mul(v, first)),
                std::array::from_fn(|i| {
                    let mut row = [b.f32(0.0); D];
                    row[i] = b.mul(v, q.derivatives[i][1]);
                    row
                }),
            ),
            Weight::Direction(g) => {
                let along = b.dot(&g, &means);
                let turned = shape.covariance.map(|row| b.dot(&row, &g));
                let first = q.derivatives.map(|[first, ..]| first);
                let lean = b.dot(&turned, &first);
                let own = b.mul(along, q.value);
                let value = b.add(own, lean);
                let slopes = std::array::from_fn(|i| {
                    let [first, second, _] = q.derivatives[i];
                    b.dot(&[g[i], along, turned[i]], &[q.value, first, second])
                });
                let bends = std::array::from_fn(|i| {
                    std::array::from_fn(|j| {
                        let outer = b.dot(&[g[i], g[j]], &[first[j], first[i]]);
                        if i != j {
                            return outer;
                        }
                        let [_, second, third] = q.derivatives[i];
                        let own = b.dot(&[along, turned[i]], &[second, third]);
                        b.add(outer, own)
                    })
                });
                (value, slopes, bends)
            }
        };
        bent(b, (value, slopes, bends), d, shape, order)
    }
}

/// Derivatives of e^{−d·μ/2} G by d.
fn bent<const D: usize>(
    b: &mut Builder,
    (value, slopes, bends): (Value, [Value; D], [[Value; D]; D]),
    d: [Value; D],
    shape: &Shape<D>,
    order: usize,
) -> Vec<Value> {
    let mut parts = vec![value];
    if order > 0 {
        for i in 0..D {
            let drop = b.mul(d[i], value);
            parts.push(b.sub(slopes[i], drop));
        }
    }
    if order > 1 {
        for i in 0..D {
            for j in i..D {
                let outer = b.dot(&[d[i], d[j]], &[slopes[j], slopes[i]]);
                let square = b.mul(d[i], d[j]);
                let square = b.sub(square, shape.total[i][j]);
                let own = b.mul(square, value);
                let part = b.sub(bends[i][j], outer);
                parts.push(b.add(part, own));
            }
        }
    }
    parts
}
