//! Ramps through stops: constant, straight, smooth, and monotone cubic (Steffen 1990, *A simple method
//! for monotonic interpolation in one dimension*, eqs. 8 and 11).

use super::{Bump, CLOSEST, Knot, Piecewise};
use crate::ir::{Float, dot};

/// How a ramp goes from stop to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// The value of the last stop.
    Constant,
    /// Straight.
    Linear,
    /// 3τ² − 2τ³.
    Smooth,
    /// A cubic with continuous slopes that overshoots no stop.
    Cubic,
}

/// A place and the value there.
type Stop<'b> = (Float<'b>, Float<'b>);

/// What is between two neighbouring stops. Stops at one place are a jump, which the later stop makes.
#[derive(Clone, Copy, Debug)]
struct Secant<'b> {
    /// The slope; 0 where the stops are at one place.
    slope: Float<'b>,
    /// By how much the ramp rises; 0 where the stops are at one place.
    rise: Float<'b>,
    /// By how much it jumps at the later stop; 0 where it rises.
    jump: Float<'b>,
    /// The width, which is positive.
    width: Float<'b>,
}

impl<'b> Piecewise<'b> {
    /// A ramp through `(at, value)`, sorted; constant outside. Neighbours at one place jump.
    ///
    /// # Panics
    /// If there is no stop: a bug of the caller.
    pub fn ramp(stops: &[Stop<'b>], shape: Shape) -> Self {
        let offset = stops[0].1;
        let zero = offset.literal(0.0);
        let secants: Vec<Secant<'b>> = (stops.windows(2))
            .map(|pair| match shape {
                Shape::Constant => Secant {
                    slope: zero,
                    rise: zero,
                    jump: pair[1].1 - pair[0].1,
                    ..Secant::between(pair[0], pair[1])
                },
                _ => Secant::between(pair[0], pair[1]),
            })
            .collect();
        let knots = stops.iter().enumerate().map(|(i, &(at, _))| {
            let before = i.checked_sub(1).map(|i| secants[i]);
            let slope = |secant: Option<&Secant<'b>>| secant.map_or(zero, |secant| secant.slope);
            Knot {
                at,
                jump: before.map_or(zero, |secant| secant.jump),
                bend: slope(secants.get(i)) - slope(before.as_ref()),
            }
        });
        let bumps = match shape {
            Shape::Constant | Shape::Linear => Vec::new(),
            Shape::Smooth => secants.iter().map(|s| Bump::smooth(s.rise)).collect(),
            Shape::Cubic => monotone(&secants, zero),
        };
        let values: Option<Vec<f32>> = stops.iter().map(|(_, value)| value.as_constant()).collect();
        let values = values.map(|values| {
            let extreme = |pick: fn(f32, f32) -> f32| values.iter().copied().fold(values[0], pick);
            [extreme(f32::min), extreme(f32::max)]
        });
        Self {
            bumps,
            values,
            ..Self::straight(offset, zero, knots.collect()).levelled()
        }
    }
}

impl<'b> Secant<'b> {
    /// From stop to stop on a straight line.
    fn between((from, start): Stop<'b>, (to, end): Stop<'b>) -> Self {
        let (rise, width) = (end - start, to - from);
        let distinct = width.gt(CLOSEST);
        let positive = width.max(CLOSEST);
        Self {
            slope: distinct.select(rise / positive, 0.0),
            rise: distinct.select(rise, 0.0),
            jump: distinct.select(0.0, rise),
            width: positive,
        }
    }
}

/// The bumps that make the segments one function with a continuous slope, monotone between stops:
/// no value lies outside its two stops'. The slope is 0 at the first and last stop, as outside.
fn monotone<'b>(secants: &[Secant<'b>], zero: Float<'b>) -> Vec<Bump<'b>> {
    let between = secants.windows(2).map(|pair| tangent(pair[0], pair[1]));
    let tangents: Vec<Float<'b>> = ([zero].into_iter().chain(between).chain([zero])).collect();
    (secants.iter().zip(tangents.windows(2)))
        .map(|(&Secant { slope, width, .. }, ends)| {
            // Two stops at one place are a jump, which has no shape.
            let distinct = width.gt(CLOSEST);
            let [start, end] = [0, 1].map(|i| distinct.select((ends[i] - slope) * width, 0.0));
            Bump { start, end }
        })
        .collect()
}

/// (sgn s₀ + sgn s₁) min(|s₀|, |s₁|, ½|(s₀w₁ + s₁w₀)/(w₀ + w₁)|).
fn tangent<'b>(before: Secant<'b>, after: Secant<'b>) -> Float<'b> {
    let slopes = [before.slope, after.slope];
    let parabola = dot(slopes, [after.width, before.width]) / (before.width + after.width);
    let [p, q] = slopes.map(Float::abs);
    let [s, t] = slopes.map(|slope| slope.lt(0.0).select(-1.0, 1.0));
    (s + t) * p.min(q).min(parabola.abs() * 0.5)
}
