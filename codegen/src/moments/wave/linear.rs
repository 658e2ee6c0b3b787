//! Periodic functions that are straight between knots: sawtooth, triangle, and the hexagon of hues.

use super::super::{Gaussian, Knot, Moments, Piecewise, Transfer, signal::UNBOUNDED};
use super::{CROSSOVER, fraction};
use crate::ir::{Builder, Float};
use std::f64::consts::TAU;

/// A knot of a [`LinearWave`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// Where in the period, in [0, 1).
    pub at: f32,
    /// The limit from the left.
    pub before: f32,
    /// The value.
    pub after: f32,
}

/// A function of period 1, straight between its corners.
///
/// For σ ≤ 0.2 periods the piecewise function of the corners within reach (error 3e-7 of the
/// largest jump), beyond it three harmonics, damped by e^{−2π²k²v}, of the function and of its
/// square, whose coefficients are computed in f64 when it is built. Exact for a Gaussian. Of a signal
/// that stays between two corners it is the line between them, which is exact for any signal.
#[derive(Clone, Debug)]
pub struct LinearWave {
    corners: Vec<Corner>,
    /// Mean, then cosine and sine of each harmonic: of the function, and of its square.
    series: [Series; 2],
}

/// How many harmonics.
const HARMONICS: usize = 3;

/// Periods in which corners are looked for where a signal's bounds are known, and how far away these
/// may lie: numbers beyond have no digits left for the corners.
const REACHED: f32 = 2.0;
const FARTHEST: f32 = 1024.0;

#[derive(Clone, Copy, Debug, Default)]
struct Series {
    mean: f64,
    harmonics: [(f64, f64); HARMONICS],
}

/// Four-point Gauss–Legendre on [0, 1].
const NODES: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];
/// Panels of the integration of a period: the error is below 1e-12.
const PANELS: usize = 32;

impl LinearWave {
    /// The wave through corners, sorted by place.
    ///
    /// # Panics
    /// If there is none, or one lies outside [0, 1): a bug of the caller.
    pub fn new(corners: Vec<Corner>) -> Self {
        assert!(!corners.is_empty(), "a wave has corners");
        assert!(
            corners.iter().all(|corner| (0.0..1.0).contains(&corner.at)),
            "corners lie in the period"
        );
        let series = [1, 2].map(|power| Series::of(&corners, power));
        Self { corners, series }
    }

    /// The fraction of x.
    pub fn sawtooth() -> Self {
        Self::new(vec![Corner {
            at: 0.0,
            before: 1.0,
            after: 0.0,
        }])
    }

    /// 2|x − ⌊x + ½⌋|: 0 at whole numbers, 1 halfway.
    pub fn triangle() -> Self {
        Self::through(&[(0.0, 0.0), (0.5, 1.0)])
    }

    /// The continuous wave through points of a period.
    pub fn through(points: &[(f32, f32)]) -> Self {
        let corner = |&(at, value): &(f32, f32)| Corner {
            at,
            before: value,
            after: value,
        };
        Self::new(points.iter().map(corner).collect())
    }

    /// The corner `i` places after the first, in later periods or earlier ones.
    fn corner(&self, i: isize) -> Corner {
        let count = self.corners.len() as isize;
        let corner = self.corners[i.rem_euclid(count) as usize];
        Corner {
            at: corner.at + i.div_euclid(count) as f32,
            ..corner
        }
    }

    /// The slope after corner `i`.
    fn slope(&self, i: isize) -> f32 {
        let (from, to) = (self.corner(i), self.corner(i + 1));
        (to.before - from.after) / (to.at - from.at)
    }

    /// The function on an interval of the corners strictly between `from` and `to`.
    fn unrolled<'b>(&self, b: &'b Builder, from: f32, to: f32) -> Piecewise<'b> {
        let count = self.corners.len() as isize;
        // The line before the first corner inside.
        let last = (-3 * count..3 * count)
            .rfind(|&i| self.corner(i).at <= from)
            .unwrap_or(-3 * count);
        let (start, slope) = (self.corner(last), self.slope(last));
        let knots = (-2 * count..3 * count).filter_map(|i| {
            let corner = self.corner(i);
            (corner.at > from && corner.at < to).then(|| Knot {
                at: b.float(corner.at),
                jump: b.float(corner.after - corner.before),
                bend: b.float(self.slope(i) - self.slope(i - 1)),
            })
        });
        let offset = b.float(start.after - slope * start.at);
        Piecewise::straight(offset, slope, knots.collect())
    }

    /// The whole periods before a range that reaches two periods at most. Where it ends at a jump, nobody
    /// knows on which side of it a signal is that may be next to its bound.
    fn start(&self, [low, high]: [f32; 2]) -> Option<f32> {
        let start = low.floor();
        let is_near = start.abs() < FARTHEST && high - start <= REACHED;
        let ends = |corner: &Corner| {
            let apart = fraction_of(high - corner.at);
            corner.before != corner.after && apart.min(1.0 - apart) < 1e-5
        };
        (is_near && !self.corners.iter().any(ends)).then_some(start)
    }

    /// The value at 0 and the slope of the line that a range lies on, if no corner is inside it.
    fn line(&self, range: [f32; 2]) -> Option<[f32; 2]> {
        let start = self.start(range)?;
        let [from, to] = range.map(|end| end - start);
        let count = self.corners.len() as isize;
        let last = (-count..3 * count).rfind(|&i| self.corner(i).at <= from)?;
        let (corner, slope) = (self.corner(last), self.slope(last));
        let offset = corner.after - slope * (corner.at + start);
        (self.corner(last + 1).at >= to).then_some([offset, slope])
    }

    /// The damped harmonics: mean, slope, curvature and third of the function, and the mean of its
    /// square.
    fn harmonics<'b>(&self, u: Float<'b>, variance: Float<'b>) -> [Float<'b>; 5] {
        let v = variance.min(4.0);
        let angle = u * TAU as f32;
        let (cosine, sine) = (angle.cos(), angle.sin());
        let mut turned = [cosine, sine];
        let [of, squared] = self.series;
        let mut sums = [of.mean, 0.0, 0.0, 0.0, squared.mean].map(|x| u.literal(x as f32));
        for k in 0..HARMONICS {
            if k > 0 {
                let [c, s] = turned;
                turned = [c * cosine - s * sine, s * cosine + c * sine];
            }
            let w = TAU * (k + 1) as f64;
            let damping = (v * (-0.5 * w * w) as f32).clamp(-80.0, 0.0).exp();
            let [c, s] = turned.map(|turned| turned * damping);
            // p cos + q sin, its derivatives, and the same of the square.
            let (p, q) = of.harmonics[k];
            let rows = [
                (p, q),
                (q * w, -p * w),
                (-p * w * w, -q * w * w),
                (-q * w * w * w, p * w * w * w),
                squared.harmonics[k],
            ];
            for (sum, (p, q)) in sums.iter_mut().zip(rows) {
                *sum += c * p as f32 + s * q as f32;
            }
        }
        sums
    }
}

fn fraction_of(x: f32) -> f32 {
    x - x.floor()
}

impl Series {
    /// Of the function that is straight between the corners, to a power.
    fn of(corners: &[Corner], power: i32) -> Self {
        let mut series = Self::default();
        for (i, from) in corners.iter().enumerate() {
            let (to, end) = match corners.get(i + 1) {
                Some(next) => (f64::from(next.at), next.before),
                None => (f64::from(corners[0].at) + 1.0, corners[0].before),
            };
            let (start, height) = (f64::from(from.at), f64::from(from.after));
            let (width, rise) = (to - start, f64::from(end) - height);
            for panel in 0..PANELS {
                for (node, weight) in NODES {
                    let share = (panel as f64 + node) / PANELS as f64;
                    let y = (height + rise * share).powi(power);
                    let part = y * weight * width / PANELS as f64;
                    series.mean += part;
                    for (k, harmonic) in series.harmonics.iter_mut().enumerate() {
                        let angle = TAU * (k + 1) as f64 * (start + width * share);
                        harmonic.0 += 2.0 * part * angle.cos();
                        harmonic.1 += 2.0 * part * angle.sin();
                    }
                }
            }
        }
        series
    }
}

impl<'b> Transfer<'b> for LinearWave {
    fn derivative(&self) -> Option<Box<dyn Transfer<'b> + 'b>> {
        if self
            .corners
            .iter()
            .any(|corner| corner.before != corner.after)
        {
            return None;
        }
        let steps = (0..).zip(&self.corners).map(|(i, corner)| Corner {
            at: corner.at,
            before: self.slope(i - 1),
            after: self.slope(i),
        });
        Some(Box::new(Self::new(steps.collect())))
    }

    fn value(&self, x: Float<'b>) -> Float<'b> {
        // A corner at 0 is where the line starts.
        let piece = self.unrolled(x.builder(), 0.0, 1.0);
        piece.value(fraction(x))
    }

    fn is_steep(&self) -> bool {
        let jumps = |corner: &Corner| corner.before != corner.after;
        self.corners.iter().any(jumps)
    }

    fn moments(&self, x: &Gaussian<'b>) -> Moments<'b> {
        let [least, most] = <Self as Transfer<'b>>::range(self, x.range);
        if let Some([offset, slope]) = self.line(x.range) {
            let zero = x.mean.literal(0.0);
            return Moments {
                mean: (x.mean * slope + offset).clamp(least, most),
                slope: x.mean.literal(slope),
                curvature: zero,
                third: zero,
                distortion: zero,
            };
        }
        let u = fraction(x.mean);
        let near = self.unrolled(u.builder(), -1.0, 2.0).moments(&Gaussian {
            mean: u,
            range: UNBOUNDED,
            ..*x
        });
        let [mean, slope, curvature, third, square] = self.harmonics(u, x.variance);
        // Here the squares are far apart: nothing cancels.
        let distortion = (square - mean.square() - (slope * x.sd).square()).max(0.0);
        let narrow = x.sd.lt(CROSSOVER);
        Moments {
            mean: narrow.select(near.mean, mean).clamp(least, most),
            slope: narrow.select(near.slope, slope),
            curvature: narrow.select(near.curvature, curvature),
            third: narrow.select(near.third, third),
            distortion: narrow.select(near.distortion, distortion),
        }
    }

    fn range(&self, input: [f32; 2]) -> [f32; 2] {
        let hull = |values: &mut dyn Iterator<Item = f32>| {
            values.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], y| {
                [low.min(y), high.max(y)]
            })
        };
        let of = |corner: &Corner| [corner.before, corner.after];
        let all = hull(&mut self.corners.iter().flat_map(of));
        let Some(start) = self.start(input) else {
            return all;
        };
        let [from, to] = input.map(|end| end - start);
        let count = self.corners.len() as isize;
        let corners = (-count..3 * count).map(|i| (i, self.corner(i)));
        // Each stretch between two corners, as far as it is reached.
        let mut ends = corners
            .filter(|(_, corner)| corner.at <= to)
            .flat_map(|(i, corner)| {
                let end = self.corner(i + 1).at;
                let line = |x: f32| corner.after + self.slope(i) * (x - corner.at);
                let reached = (end >= from).then(|| [corner.at.max(from), end.min(to)].map(line));
                reached.into_iter().flatten()
            });
        let [low, high] = hull(&mut ends);
        // Rounding must not push what is reached outside.
        let slack = 1e-6 * (all[1] - all[0]);
        [(low - slack).max(all[0]), (high + slack).min(all[1])]
    }

    fn period(&self) -> Option<f32> {
        Some(1.0)
    }
}
