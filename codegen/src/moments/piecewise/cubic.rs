//! Monotone cubic ramps (Steffen 1990, *A simple method for monotonic interpolation in one
//! dimension*, eqs. 8 and 11).

use super::Bump;
use crate::ir::{Builder, Value};

/// A straight segment between two stops.
#[derive(Clone, Copy, Debug)]
pub(super) struct Secant {
    /// The slope; 0 where the stops are at one place.
    pub(super) slope: Value,
    /// The width, which is positive.
    pub(super) width: Value,
}

/// The bumps that make the segments one function with a continuous slope, monotone between stops:
/// no value lies outside its two stops'. The slope is 0 at the first and last stop, as outside.
pub(super) fn monotone(b: &mut Builder, secants: &[Secant]) -> Vec<Bump> {
    let zero = b.f32(0.0);
    let mut tangents = vec![zero];
    for pair in secants.windows(2) {
        tangents.push(tangent(b, pair[0], pair[1]));
    }
    tangents.push(zero);
    (secants.iter().zip(tangents.windows(2)))
        .map(|(secant, ends)| {
            let [start, end] = [ends[0], ends[1]].map(|tangent| {
                let beyond = b.sub(tangent, secant.slope);
                b.mul(beyond, secant.width)
            });
            // Two stops at one place are a jump, which has no shape.
            let least = b.f32(1e-6);
            let distinct = b.lt(least, secant.width);
            Bump {
                start: b.select(distinct, start, zero),
                end: b.select(distinct, end, zero),
            }
        })
        .collect()
}

/// (sgn s₀ + sgn s₁) min(|s₀|, |s₁|, ½|(s₀w₁ + s₁w₀)/(w₀ + w₁)|).
fn tangent(b: &mut Builder, before: Secant, after: Secant) -> Value {
    let (zero, one) = (b.f32(0.0), b.f32(1.0));
    let parabola = b.dot(&[before.slope, after.slope], &[after.width, before.width]);
    let widths = b.add(before.width, after.width);
    let parabola = b.div(parabola, widths);
    let parabola = b.abs(parabola);
    let parabola = b.scale(parabola, 0.5);
    let [p, q] = [before.slope, after.slope].map(|slope| b.abs(slope));
    let least = b.min(p, q);
    let least = b.min(least, parabola);
    let minus = b.f32(-1.0);
    let [s, t] = [before.slope, after.slope].map(|slope| {
        let falls = b.lt(slope, zero);
        b.select(falls, minus, one)
    });
    let signs = b.add(s, t);
    b.mul(signs, least)
}
