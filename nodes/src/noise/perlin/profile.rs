//! The kernel's profiles along an axis, w(t) and t w(t), with their derivatives.

use mipless_codegen::ir::{Builder, Value};

/// The two profiles, each with its derivatives from the 0th on; those beyond are 0.
pub(super) type Profiles = [Vec<Value>; 2];

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

/// w and its five derivatives by |t|, for |t| in [0, 1].
pub(in crate::noise) fn window(b: &mut Builder, t: Value) -> Vec<Value> {
    [
        [1.0, 0.0, 0.0, -10.0, 15.0, -6.0].as_slice(),
        &[0.0, 0.0, -30.0, 60.0, -30.0],
        &[0.0, -60.0, 180.0, -120.0],
        &[-60.0, 360.0, -360.0],
        &[360.0, -720.0],
        &[-720.0],
    ]
    .map(|coefficients: &[f32]| {
        let mut sum = b.f32(0.0);
        for &a in coefficients.iter().rev() {
            sum = b.mul(sum, t);
            sum = b.offset(sum, a);
        }
        sum
    })
    .to_vec()
}

/// The first derivatives of a polynomial of degree 5, from all of them, averaged over a Gaussian of
/// variance c: E f(t + ξ) = f + ½cf″ + ⅛c²f⁗.
pub(in crate::noise) fn averaged(b: &mut Builder, f: &[Value], c: Value) -> Vec<Value> {
    let half = b.scale(c, 0.5);
    let eighth = b.square(half);
    let eighth = b.scale(eighth, 0.5);
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
}

/// The polynomials of the window at t in [0, 1] (`negative`: at −t), averaged over a Gaussian of
/// variance c around t.
pub(super) fn quintic(b: &mut Builder, t: Value, negative: bool, c: Value) -> Profiles {
    let mut w = window(b, t);
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
    [w, tw].map(|f| averaged(b, &f, c))
}
