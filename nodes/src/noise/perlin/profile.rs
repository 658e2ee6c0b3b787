//! The kernel's profiles along an axis, w(t) and t w(t), with their derivatives.

use mipless_codegen::ir::{Builder, Value};

/// The two profiles, each with its derivatives from the 0th on; those beyond are 0.
pub(super) type Profiles = [Vec<Value>; 2];

/// The share of the window (1 + αt² + βt⁴) e^{−t²/2b²} that stands for w beyond narrow footprints:
/// the noise differs by 0.029 of its standard deviation.
pub(super) const ALPHA: f32 = 3.544;
pub(super) const BETA: f32 = -4.86;
/// b, in cells.
pub(super) const WIDTH: f32 = 0.3284;

/// How often each derivative of a sum of kernels is taken along x and along y: the mean, the
/// gradient, the Hessian.
pub(super) const DERIVATIVES: [[usize; 2]; 6] = [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]];

/// Σ_k (cᵏ/k!) ∂ᵏf ∂ᵏh with f and h differentiated `along`[0] and `along`[1] times: the expectation
/// of f(X) h(Y) for Gaussians of covariance c, of which `powers` are cᵏ/k! from k = 1 on.
pub(super) fn joint(
    b: &mut Builder,
    [f, h]: [&[Value]; 2],
    along: [usize; 2],
    powers: &[Value],
) -> Value {
    let mut sum = b.f32(0.0);
    for k in 0..=powers.len() {
        let (Some(&x), Some(&y)) = (f.get(along[0] + k), h.get(along[1] + k)) else {
            break;
        };
        let product = b.mul(x, y);
        let part = match k {
            0 => product,
            _ => b.mul(product, powers[k - 1]),
        };
        sum = b.add(sum, part);
    }
    sum
}

/// The polynomials of the window at t in [0, 1] (`negative`: at −t), averaged over a Gaussian of
/// variance c around t: E f(t + ξ) = f + ½cf″ + ⅛c²f⁗.
pub(super) fn quintic(b: &mut Builder, t: Value, negative: bool, c: Value) -> Profiles {
    let polynomial = |b: &mut Builder, coefficients: &[f32]| {
        let mut sum = b.f32(0.0);
        for &a in coefficients.iter().rev() {
            sum = b.mul(sum, t);
            sum = b.offset(sum, a);
        }
        sum
    };
    // w and its derivatives by |t|.
    let mut w = [
        [1.0, 0.0, 0.0, -10.0, 15.0, -6.0].as_slice(),
        &[0.0, 0.0, -30.0, 60.0, -30.0],
        &[0.0, -60.0, 180.0, -120.0],
        &[-60.0, 360.0, -360.0],
        &[360.0, -720.0],
        &[-720.0],
    ]
    .map(|coefficients| polynomial(b, coefficients))
    .to_vec();
    let mut place = t;
    if negative {
        for odd in [1, 3, 5] {
            w[odd] = b.neg(w[odd]);
        }
        place = b.neg(t);
    }
    // (t w)⁽ⁿ⁾ = t w⁽ⁿ⁾ + n w⁽ⁿ⁻¹⁾.
    let mut tw = Vec::new();
    for n in 0..=w.len() {
        let mut sum = match w.get(n) {
            Some(&derivative) => b.mul(place, derivative),
            None => b.f32(0.0),
        };
        if n > 0 {
            let below = b.scale(w[n - 1], n as f32);
            sum = b.add(sum, below);
        }
        tw.push(sum);
    }
    let half = b.scale(c, 0.5);
    let eighth = b.square(half);
    let eighth = b.scale(eighth, 0.5);
    [w, tw].map(|f| {
        let mut smooth = Vec::new();
        for n in 0..5 {
            let mut sum = f[n];
            for (factor, derivative) in [(half, f.get(n + 2)), (eighth, f.get(n + 4))] {
                if let Some(&derivative) = derivative {
                    let part = b.mul(factor, derivative);
                    sum = b.add(sum, part);
                }
            }
            smooth.push(sum);
        }
        smooth
    })
}

/// The polynomials of the fit, 1 + αt² + βt⁴ and t times it, averaged over a Gaussian of mean μ and
/// variance c: a polynomial of μ by the heat polynomials H₀ = 1, H₁ = μ, Hₙ₊₁ = μHₙ + ncHₙ₋₁.
pub(super) fn fitted(b: &mut Builder, mean: Value, c: Value) -> Profiles {
    let one = b.f32(1.0);
    let mut heat = vec![one, mean];
    for n in 1..5 {
        let rise = b.mul(mean, heat[n]);
        let spread = b.scale(c, n as f32);
        let spread = b.mul(spread, heat[n - 1]);
        heat.push(b.add(rise, spread));
    }
    [0, 1].map(|shift| {
        let mut derivatives = Vec::new();
        for order in 0..=4 + shift {
            let mut sum = b.f32(0.0);
            for (coefficient, power) in [(1.0, shift), (ALPHA, 2 + shift), (BETA, 4 + shift)] {
                if power < order {
                    continue;
                }
                // Hₙ′ = nHₙ₋₁.
                let factor = (power - order + 1..=power).product::<usize>() as f32;
                let part = b.scale(heat[power - order], coefficient * factor);
                sum = b.add(sum, part);
            }
            derivatives.push(sum);
        }
        derivatives
    })
}
