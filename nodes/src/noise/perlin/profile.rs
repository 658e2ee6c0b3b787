//! The kernel's profiles along an axis, w(t) and t w(t), with their derivatives.

use mipless_codegen::ir::Float;

/// The two profiles, each with its derivatives from the 0th on; those beyond are 0.
pub(super) type Profiles<'b> = [Vec<Float<'b>>; 2];

/// How often each derivative of a sum of kernels is taken along x and along y: the mean, the
/// gradient, the Hessian.
pub(super) const DERIVATIVES: [[usize; 2]; 6] = [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]];

/// Σ_k (cᵏ/k!) ∂ᵏf ∂ᵏh with f and h differentiated `along`[0] and `along`[1] times: the expectation
/// of f(X) h(Y) for Gaussians of covariance c, of which `powers` are cᵏ/k! from k = 1 on.
pub(super) fn joint<'b>(
    [f, h]: [&[Float<'b>]; 2],
    along: [usize; 2],
    powers: &[Float<'b>],
) -> Float<'b> {
    let b = powers[0].builder();
    let derivatives = f[along[0]..].iter().zip(&h[along[1]..]);
    b.sum(
        derivatives
            .zip(0..=powers.len())
            .map(|((&f, &h), k)| match k {
                0 => f * h,
                _ => f * h * powers[k - 1],
            }),
    )
}

/// w and its five derivatives by |t|, for |t| in [0, 1].
pub(in crate::noise) fn window(t: Float<'_>) -> Vec<Float<'_>> {
    let polynomials = [
        [1.0, 0.0, 0.0, -10.0, 15.0, -6.0].as_slice(),
        &[0.0, 0.0, -30.0, 60.0, -30.0],
        &[0.0, -60.0, 180.0, -120.0],
        &[-60.0, 360.0, -360.0],
        &[360.0, -720.0],
        &[-720.0],
    ];
    let horner = |coefficients: &[f32]| {
        (coefficients.iter().rev()).fold(t.literal(0.0), |sum, &a| sum * t + a)
    };
    polynomials.map(horner).to_vec()
}

/// The first derivatives of a polynomial of degree 5, from all of them, averaged over a Gaussian of
/// variance c: E f(t + ξ) = f + ½cf″ + ⅛c²f⁗.
pub(in crate::noise) fn averaged<'b>(f: &[Float<'b>], c: Float<'b>) -> Vec<Float<'b>> {
    let half = c * 0.5;
    let eighth = half.square() * 0.5;
    (0..5)
        .map(|n| {
            let mut sum = f[n];
            for (factor, derivative) in [(half, f.get(n + 2)), (eighth, f.get(n + 4))] {
                if let Some(&derivative) = derivative {
                    sum += factor * derivative;
                }
            }
            sum
        })
        .collect()
}

/// The same of the cubic window, 1 − 3t² + 2|t|³.
pub(super) fn cubic(t: Float<'_>) -> Vec<Float<'_>> {
    let zero = t.literal(0.0);
    vec![
        t.square() * (t * 2.0 - 3.0) + 1.0,
        t * (t * 6.0 - 6.0),
        t * 12.0 - 6.0,
        t.literal(12.0),
        zero,
        zero,
    ]
}

/// The polynomials of a window at t in [0, 1] (`negative`: at −t), averaged over a Gaussian of
/// variance c around t; `w` are the window and its derivatives by |t|.
pub(super) fn profiles<'b>(
    mut w: Vec<Float<'b>>,
    t: Float<'b>,
    negative: bool,
    c: Float<'b>,
) -> Profiles<'b> {
    let mut place = t;
    if negative {
        for odd in [1, 3, 5] {
            w[odd] = -w[odd];
        }
        place = -t;
    }
    // (t w)⁽ⁿ⁾ = t w⁽ⁿ⁾ + n w⁽ⁿ⁻¹⁾.
    let product = |n: usize| {
        let own = w.get(n).map(|&derivative| place * derivative);
        let below = n.checked_sub(1).map(|below| w[below] * n as f32);
        t.builder().sum(own.into_iter().chain(below))
    };
    let tw = (0..=w.len()).map(product).collect();
    [w, tw].map(|f: Vec<Float<'b>>| averaged(&f, c))
}
