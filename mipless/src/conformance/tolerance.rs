//! How far a graph or a node may be from a law, with the reason.

/// The share of pixels that need not agree with the oracle: those that an edge runs through.
pub const LEFT_OUT: f64 = 0.01;

/// How far a value may leave the range of its colour map, relative to max(1, |bound|): the
/// roundings of the sum over the map's segments.
pub const RANGE: f64 = 2e-5;

/// The difference between a filtered value and the point value at a vanishing footprint, relative
/// to max(1, |x|). Closed forms switch to their limits below σ ≈ 1e-6.
pub const VANISHING: f64 = 1e-4;

/// The difference between f32 and f64, relative to max(1, |x|), up to which a random graph agrees
/// beyond what moving its footprint by a rounding does. Its numbers may be a thousand times as large
/// inside as they are in its outputs.
pub const ROUNDING: f64 = 1e-3;

/// By how much of the square of its bounds' distance a variance may exceed what numbers within them
/// can have.
pub const SPREAD: f64 = 1e-3;

/// The share of the observed range of an output by which its far-field mean may be off beyond the
/// statistical error of the samples and beyond what the check predicts: the distance of the noises'
/// distributions from a Gaussian (0.0046 of each jump, four jumps in a ramp).
pub const FAR_FIELD: f64 = 0.02;

/// By how much of its extent the two sides of the heat equation may differ: both are differences of means
/// that a table interpolates (14/1000 of a function's range at most).
pub const HEAT: f64 = 0.06;

/// The difference, relative to the variances, up to which Var(X + Y) + Var(X − Y) is 2 Var X + 2 Var Y in
/// f64: constants are rounded to f32, some hundred of them.
pub const COVARIANCE: f64 = 1e-4;
