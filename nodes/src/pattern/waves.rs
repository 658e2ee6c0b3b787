//! Waves that a footprint damps, the terms of every Fourier series of a pattern.

use mipless_codegen::ir::{Float, Sym2, Vec2};
use std::f64::consts::{PI, TAU};

/// kᵀΣk of a frequency k, in cycles, and what a Gaussian footprint leaves of the wave: e^{−2π²kᵀΣk}.
pub(super) fn damping<'b>(k: Vec2<'b>, covariance: Sym2<'b>) -> (Float<'b>, Float<'b>) {
    let form = k.dot(covariance.times(k));
    let left = (form * (-2.0 * PI * PI) as f32).clamp(-80.0, 0.0).exp();
    (form, left)
}

/// Turns less their whole part, in [−½, ½].
pub(super) fn nearest(turns: Float<'_>) -> Float<'_> {
    turns - (turns + 0.5).floor()
}

/// Cosine and sine of the phase of a wave at a place.
pub(super) fn phase<'b>(k: Vec2<'b>, place: Vec2<'b>) -> [Float<'b>; 2] {
    nearest(k.dot(place)).circle()
}

/// A wave of an amplitude and its derivatives (x, y, xx, xy, yy), the first so many of them.
pub(super) fn derivatives<'b>(
    amplitude: Float<'b>,
    [cosine, sine]: [Float<'b>; 2],
    k: Vec2<'b>,
    orders: usize,
) -> Vec<Float<'b>> {
    let value = amplitude * cosine;
    let mut parts = vec![value];
    if orders > 1 {
        let slope = amplitude * sine * -TAU as f32;
        parts.extend(k.map(|k| slope * k));
    }
    if orders > 3 {
        let bend = value * (-TAU * TAU) as f32;
        parts.extend(k.outer().map(|kk| bend * kk));
    }
    parts
}
