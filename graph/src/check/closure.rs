//! The predicted error of closing moments: root mean square on [0, 1], from measured cascades.
//!
//! The measurements are over footprints from 0.03 to 2 wavelengths of the noise, with gradient and
//! remainder statistics, against supersampled truth (`cargo bench -p mipless-tests --bench cascades`).
//! They are typical of the class, not bounds; `tests/tests/closure.rs` holds them against renders of
//! every graph in `graphs/` and of a set of chains.

/// A function of one or two Gaussians, fused and filtered once: where continuous .013 (mix by a
/// product) to .049 (turbulence ∘ smoothstep), through a hard step .037 to .066.
pub(super) const FUSED: f32 = 0.045;

/// A product, maximum or other function of several signals closed by its moments: .02 to .05.
pub(super) const CLOSED: f32 = 0.05;

/// A sum of functions: its moments are exact where its terms' are, but the next function takes the
/// sum for a Gaussian; the measured error through a sum is .05 to .08. This is the part that
/// the sum itself is charged with.
pub(super) const SUMMED: f32 = 0.03;

/// A noise at a position that another signal displaces, with Σ′ = JΣJᵀ + a² diag(R) (.000 / .012 /
/// .064 / .121 of the noise's standard deviation, taken as 1, at .03 / .1 / .2 / .35
/// wavelengths; their mean), for a noise whose standard deviation is a quarter.
pub(super) const WARPED: f32 = 0.049 / 4.0;

/// max |CDF − Φ| of the product of two independent centred Gaussians: ∫₀ˣ K₀/π − Φ(x) + ½ is
/// largest near x = .55, where it is .104.
pub(super) const PRODUCT_DEVIATION: f32 = 0.104;

/// max |CDF − Φ| of |X|: Φ(−E|X|/sd|X|) = Φ(−1.324) at 0. Taken as typical of continuous functions;
/// a hard step has .34.
pub(super) const FUNCTION_DEVIATION: f32 = 0.093;

/// A noise read at a displaced position is a mixture of Gaussians of different variance; taken as
/// half of a product's deviation, of which it is the smooth case.
pub(super) const WARPED_DEVIATION: f32 = 0.05;

/// The worse of two errors. In quadrature they would be up to fifteen times what graphs of many
/// closures measure: most of what follows a closure makes its error smaller, or masks it.
pub(super) fn together(first: f32, second: f32) -> f32 {
    first.max(second)
}
