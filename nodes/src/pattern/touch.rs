//! Whether a footprint reaches the edge of a figure. Where it does not, the figure's measure is 0 or 1,
//! and nothing needs to be summed.

use super::measure::Measure;
use mipless_codegen::ir::{Bool, Float, Sym2, Uint};

/// How far a footprint reaches, in standard deviations: what lies beyond is 3e-7 of it.
const REACH: f32 = 5.0;

/// No footprint reaches less, in units of the position: the places of edges are rounded.
const LEAST: f32 = 1e-5;

/// What is known of a figure's measure before it is summed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touch<'b> {
    /// Whether the edge may lie within reach.
    touches: Bool<'b>,
    /// Whether all within reach is inside; else all is outside.
    inside: Bool<'b>,
}

impl<'b> Touch<'b> {
    /// Of a figure whose edge lies between two distances from what is `square` (a squared distance)
    /// away from the mean, under a footprint of this covariance.
    pub(crate) fn between(
        square: Float<'b>,
        [inner, outer]: [Float<'b>; 2],
        covariance: Sym2<'b>,
    ) -> Self {
        let distance = square.sqrt();
        // √tr Σ is at least the larger standard deviation.
        let [xx, _, yy] = *covariance;
        let reach = (xx + yy + LEAST * LEAST).sqrt() * REACH;
        let inside = distance.lt(inner - reach);
        let outside = distance.gt(outer + reach);
        Self {
            touches: !(inside | outside),
            inside,
        }
    }

    /// So many turns where the edge is within reach, else none.
    pub(crate) fn turns(self, count: u32) -> Uint<'b> {
        self.touches.select(count, 0u32)
    }

    /// The measure: what was summed, from zeros, or what is known.
    pub(crate) fn measure(self, summed: Measure<'b>) -> Measure<'b> {
        let mut measure = summed;
        measure[0] = self.touches.select(summed[0], self.inside.select(1.0, 0.0));
        measure
    }
}
