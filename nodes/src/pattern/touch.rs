//! Whether a footprint reaches the edge of a figure. Where it does not, the figure's measure is 0 or 1,
//! and nothing needs to be summed.

use super::measure::Measure;
use mipless_codegen::ir::{Builder, Value};

/// How far a footprint reaches, in standard deviations: what lies beyond is 3e-7 of it.
const REACH: f32 = 5.0;

/// No footprint reaches less, in units of the position: the places of edges are rounded.
const LEAST: f32 = 1e-5;

/// What is known of a figure's measure before it is summed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touch {
    /// Whether the edge may lie within reach.
    touches: Value,
    /// Whether all within reach is inside; else all is outside.
    inside: Value,
}

impl Touch {
    /// Of a figure whose edge lies between two distances from what is `square` (a squared distance)
    /// away from the mean, under a footprint of this covariance.
    pub(crate) fn between(
        b: &mut Builder,
        square: Value,
        [inner, outer]: [Value; 2],
        [xx, _, yy]: [Value; 3],
    ) -> Self {
        let distance = b.sqrt(square);
        // √tr Σ is at least the larger standard deviation.
        let trace = b.add(xx, yy);
        let trace = b.offset(trace, LEAST * LEAST);
        let sd = b.sqrt(trace);
        let reach = b.scale(sd, REACH);
        let (low, high) = (b.sub(inner, reach), b.add(outer, reach));
        let inside = b.lt(distance, low);
        let outside = b.lt(high, distance);
        let settled = b.or(inside, outside);
        Self {
            touches: b.not(settled),
            inside,
        }
    }

    /// So many turns where the edge is within reach, else none.
    pub(crate) fn turns(self, b: &mut Builder, count: u32) -> Value {
        let (count, none) = (b.u32(count), b.u32(0));
        b.select(self.touches, count, none)
    }

    /// The measure: what was summed, from zeros, or what is known.
    pub(crate) fn measure(self, b: &mut Builder, summed: Measure) -> Measure {
        let (zero, one) = (b.f32(0.0), b.f32(1.0));
        let known = b.select(self.inside, one, zero);
        let [value, ..] = summed;
        let mut measure = summed;
        measure[0] = b.select(self.touches, value, known);
        measure
    }
}
