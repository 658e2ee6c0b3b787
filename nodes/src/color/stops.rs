//! Ramps of many stops: a table of their segments, of which each value looks up its own by bisection,
//! so that the code does not grow with the stops and a value takes log₂ of their number.
//!
//! Segment i, from stop i to the next, is v + t(a + t(b + tc)) with t = (x − atᵢ)/wᵢ limited to
//! [0, 1]: straight, 3t² − 2t³, or Steffen's cubic (Steffen 1990, *A simple method for monotonic
//! interpolation in one dimension*, eqs. 8 and 11), as `Piecewise::ramp` has them.

use mipless_codegen::ir::{Builder, Float};
use mipless_codegen::moments::Shape;
use mipless_graph::Stops;

/// With more stops than this the code of a sum over them is longer than that of a search.
pub(crate) const FEW: usize = 64;

/// Two stops closer than this are one: what lies between them is a jump.
const CLOSEST: f64 = 1e-6;

/// How many numbers of a segment come before those of its channels: where it begins, and 1/w.
const HEAD: usize = 2;
/// How many numbers a channel of a segment has.
const COEFFICIENTS: usize = 4;

/// The segments of a ramp.
#[derive(Clone, Debug)]
pub(crate) struct Segments {
    channels: usize,
    /// A power of two of rows, those that fill it up beginning where no number is.
    rows: Vec<f32>,
}

impl Segments {
    /// Of these stops, which are sorted.
    pub(crate) fn of(stops: &Stops, shape: Shape) -> Self {
        let (channels, stops) = (stops.ty.components(), &stops.stops);
        let count = stops.len();
        let at = |i: usize| f64::from(stops[i].at);
        let value = |i: usize, channel: usize| f64::from(stops[i].value[channel]);
        let width = |i: usize| match i + 1 < count {
            true => (at(i + 1) - at(i)).max(0.0),
            false => 0.0,
        };
        let rises = |i: usize| width(i) > CLOSEST && shape != Shape::Constant;
        let rise = |i: usize, channel: usize| value(i + 1, channel) - value(i, channel);
        // The slope of a secant; 0 of a jump.
        let secant = |i: usize, channel: usize| match rises(i) {
            true => rise(i, channel) / width(i),
            false => 0.0,
        };
        let tangent = |i: usize, channel: usize| {
            if i == 0 || i + 1 >= count {
                return 0.0;
            }
            let [before, after] = [i - 1, i].map(|i| (secant(i, channel), width(i).max(CLOSEST)));
            let parabola = (before.0 * after.1 + after.0 * before.1) / (before.1 + after.1);
            let least = before.0.abs().min(after.0.abs()).min(0.5 * parabola.abs());
            (before.0.signum() + after.0.signum()) * least
        };
        let mut rows = Vec::new();
        for i in 0..count {
            let inverse = if rises(i) { 1.0 / width(i) } else { 0.0 };
            rows.extend([stops[i].at, inverse as f32]);
            for channel in 0..channels {
                let curve = match (rises(i), shape) {
                    (false, _) | (_, Shape::Constant) => [0.0; 3],
                    (_, Shape::Linear) => [rise(i, channel), 0.0, 0.0],
                    (_, Shape::Smooth) => [0.0, 3.0 * rise(i, channel), -2.0 * rise(i, channel)],
                    (_, Shape::Cubic) => {
                        let [p, q] = [i, i + 1].map(|i_end| width(i) * tangent(i_end, channel));
                        let rise = rise(i, channel);
                        [p, 3.0 * rise - 2.0 * p - q, p + q - 2.0 * rise]
                    }
                };
                rows.push(stops[i].value[channel]);
                rows.extend(curve.map(|x| x as f32));
            }
        }
        let stride = HEAD + COEFFICIENTS * channels;
        let filled = count.next_power_of_two();
        for _ in count..filled {
            rows.push(f32::MAX);
            rows.extend(vec![0.0; stride - 1]);
        }
        Self { channels, rows }
    }

    /// The table.
    pub(crate) fn rows(&self) -> &[f32] {
        &self.rows
    }

    fn stride(&self) -> usize {
        HEAD + COEFFICIENTS * self.channels
    }

    /// The channels at x, from the table of [`Self::rows`].
    pub(crate) fn at<'b>(&self, b: &'b Builder, table: u32, x: Float<'b>) -> Vec<Float<'b>> {
        let stride = self.stride() as u32;
        let mut step = (self.rows.len() / self.stride()) as u32 / 2;
        let mut row = b.uint(0);
        while step > 0 {
            let next = row + step;
            row = x.ge(b.load(table, next * stride)).select(next, row);
            step /= 2;
        }
        let first = row * stride;
        let number = |i: usize| b.load(table, first + i as u32);
        let t = ((x - number(0)) * number(1)).clamp(0.0, 1.0);
        (0..self.channels)
            .map(|channel| {
                let [v, p, q, r] = [0, 1, 2, 3].map(|i| number(HEAD + COEFFICIENTS * channel + i));
                v + t * (p + t * (q + t * r))
            })
            .collect()
    }

    /// The channels at x.
    pub(crate) fn value(&self, x: f64) -> Vec<f64> {
        let stride = self.stride();
        let count = self.rows.len() / stride;
        let mut row = 0;
        let mut step = count / 2;
        while step > 0 {
            if x >= f64::from(self.rows[(row + step) * stride]) {
                row += step;
            }
            step /= 2;
        }
        let numbers = &self.rows[row * stride..][..stride];
        let number = |i: usize| f64::from(numbers[i]);
        let t = ((x - number(0)) * number(1)).clamp(0.0, 1.0);
        (0..self.channels)
            .map(|channel| {
                let [v, p, q, r] = [0, 1, 2, 3].map(|i| number(HEAD + COEFFICIENTS * channel + i));
                v + t * (p + t * (q + t * r))
            })
            .collect()
    }
}
