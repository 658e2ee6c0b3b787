//! Piecewise linear functions with jumps, and cubic segments, in closed form.
//!
//! T(x) = c₀ + d₀x + Σ_k [J_k (x ≥ t_k) + B_k max(x − t_k, 0)] + Σ_j c_j(τ_j),
//! τ_j = (x − t_j)/(t_{j+1} − t_j), c(τ) = τ(1 − τ)(p(1 − τ) − qτ) on [0, 1], else 0. With z_k = (m − t_k)/σ:
//! E[T] = c₀ + d₀m + Σ J_k Φ(z_k) + B_k σ(z_k Φ(z_k) + φ(z_k)) + …, and its derivatives by m
//! (MATH §6; RULES, transfers).

mod distortion;
mod ramp;
mod segment;
mod stretch;

use super::{Curve, Gaussian, Moments, Normal, SharedTransfer, Transfer, signal::UNBOUNDED};
use crate::ir::{Builder, Float, Operand};
use segment::Segment;
use smallvec::smallvec;

pub(super) use distortion::Residual;
pub use ramp::Shape;
pub use segment::Bump;

/// Two places closer than this are one: what lies between them is a jump.
const CLOSEST: f32 = 1e-6;

/// Where a piecewise function jumps or bends.
#[derive(Clone, Copy, Debug)]
pub struct Knot<'b> {
    /// t: where; knots are sorted.
    pub at: Float<'b>,
    /// J: by how much the value jumps (T is the right limit at t itself).
    pub jump: Float<'b>,
    /// B: by how much the slope changes.
    pub bend: Float<'b>,
}

impl<'b> Knot<'b> {
    /// The value jumps, the slope stays.
    pub fn jump(at: Float<'b>, by: impl Operand<'b, f32>) -> Self {
        Self {
            at,
            jump: by.within(at.builder()),
            bend: at.literal(0.0),
        }
    }

    /// The slope changes, the value does not jump.
    pub fn bend(at: Float<'b>, by: impl Operand<'b, f32>) -> Self {
        Self {
            at,
            jump: at.literal(0.0),
            bend: by.within(at.builder()),
        }
    }
}

/// A piecewise function: see the module documentation.
#[derive(Clone, Debug)]
pub struct Piecewise<'b> {
    /// c₀.
    pub offset: Float<'b>,
    /// d₀.
    pub slope: Float<'b>,
    /// The knots, sorted.
    pub knots: Vec<Knot<'b>>,
    /// The bumps of the segments between neighbouring knots, monotone on top of the straight ones;
    /// empty where every segment is straight.
    pub bumps: Vec<Bump<'b>>,
    /// Whether it is constant after the last knot, whatever the rounded sum of the slopes is.
    pub level: bool,
    /// The least and the largest value, where they are known though the places of the knots are not.
    pub values: Option<[f32; 2]>,
}

impl<'b> Piecewise<'b> {
    /// c₀ + d₀x with knots, all of whose segments are straight.
    pub fn straight(offset: Float<'b>, slope: impl Operand<'b, f32>, knots: Vec<Knot<'b>>) -> Self {
        Self {
            offset,
            slope: slope.within(offset.builder()),
            knots,
            bumps: Vec::new(),
            level: false,
            values: None,
        }
    }

    /// The same, constant after the last knot.
    fn levelled(self) -> Self {
        Self {
            level: true,
            ..self
        }
    }

    /// 1 where x ≥ `at`, else 0.
    pub fn step(at: Float<'b>) -> Self {
        Self {
            values: Some([0.0, 1.0]),
            ..Self::straight(at.literal(0.0), 0.0, vec![Knot::jump(at, 1.0)])
        }
    }

    /// max(x, 0).
    pub fn hinge(b: &'b Builder) -> Self {
        let zero = b.float(0.0);
        Self::straight(zero, 0.0, vec![Knot::bend(zero, 1.0)])
    }

    /// |x|.
    pub fn absolute(b: &'b Builder) -> Self {
        let zero = b.float(0.0);
        Self::straight(zero, -1.0, vec![Knot::bend(zero, 2.0)])
    }

    /// |x| with its corner rounded by a parabola: (x² + k²)/2k where |x| < k = `width`.
    pub fn rounded(width: Float<'b>) -> Self {
        let width = width.max(CLOSEST);
        let span = width + width;
        let knots = [-width, width].map(|at| Knot::bend(at, 1.0));
        Self {
            bumps: vec![Bump {
                start: -span,
                end: span,
            }],
            ..Self::straight(width.literal(0.0), -1.0, knots.to_vec())
        }
    }

    /// x limited to `[low, high]`; `low` where they are swapped, as by `max` after `min`.
    pub fn clamp(low: Float<'b>, high: Float<'b>) -> Self {
        let knots = vec![Knot::bend(low, 1.0), Knot::bend(low.max(high), -1.0)];
        Self::straight(low, 0.0, knots).levelled()
    }

    /// 0 below `low`, 1 above `high`, cubic between; a step at `high` where they are equal or swapped.
    pub fn smoothstep(low: Float<'b>, high: Float<'b>) -> Self {
        let [zero, one] = [0.0, 1.0].map(|y| low.literal(y));
        Self::ramp(&[(low.min(high), zero), (high, one)], Shape::Smooth)
    }

    /// `a·T + c`.
    pub fn affine(mut self, a: impl Operand<'b, f32>, c: impl Operand<'b, f32>) -> Self {
        let a = a.within(self.offset.builder());
        let c = c.within(self.offset.builder());
        self.values = match (self.values, a.as_constant(), c.as_constant()) {
            (Some(values), Some(a), Some(c)) => {
                let [p, q] = values.map(|value| a * value + c);
                Some([p.min(q), p.max(q)])
            }
            _ => None,
        };
        self.offset = self.offset * a + c;
        self.slope *= a;
        for knot in &mut self.knots {
            knot.jump *= a;
            knot.bend *= a;
        }
        for bump in &mut self.bumps {
            bump.start *= a;
            bump.end *= a;
        }
        self
    }

    /// The same function on `range`, without the knots that no input reaches: a ramp over all of a
    /// bounded signal is linear there.
    fn within(&self, [low, high]: [f32; 2]) -> Self {
        let mut out = self.clone();
        if !self.bumps.is_empty() {
            return out;
        }
        let last = |knots: &[Knot<'b>]| knots.last().map(|knot| knot.at.value());
        let before = last(&out.knots);
        out.knots.retain(|knot| match knot.at.as_constant() {
            Some(at) if at >= high => false,
            Some(at) if at <= low => {
                out.offset += knot.jump - knot.bend * knot.at;
                out.slope += knot.bend;
                false
            }
            _ => true,
        });
        out.level &= last(&out.knots) == before;
        out
    }

    /// The input limited to where the function is not constant, by `margin` on both sides: far
    /// outside, sums of slopes would leave their rounding errors.
    fn limited(&self, x: Float<'b>, margin: impl Operand<'b, f32>) -> Float<'b> {
        let (Some(first), Some(last)) = (self.knots.first(), self.knots.last()) else {
            return x;
        };
        let margin = margin.within(x.builder());
        let mut x = x;
        if self.slope.is_zero() {
            x = x.max(first.at - margin);
        }
        if self.level {
            x = x.min(last.at + margin);
        }
        x
    }

    /// T′(x) of a function without jumps.
    fn steepness(&self, x: Float<'b>) -> Float<'b> {
        let bends = self.knots.iter().map(|k| x.ge(k.at).select(k.bend, 0.0));
        let straight = bends.fold(self.slope, |sum, bend| sum + bend);
        (self.segments()).fold(straight, |sum, segment| sum + segment.steepness(x))
    }

    fn segments(&self) -> impl Iterator<Item = Segment<'b>> {
        (self.bumps.iter().zip(self.knots.windows(2))).map(|(&bump, pair)| Segment {
            from: pair[0].at,
            to: pair[1].at,
            bump,
        })
    }
}

impl<'b> Transfer<'b> for Piecewise<'b> {
    fn value(&self, x: Float<'b>) -> Float<'b> {
        let limited = self.limited(x, 0.0);
        let mut sum = self.offset + self.slope * limited;
        for knot in &self.knots {
            sum += knot.bend * (limited - knot.at).max(0.0);
            sum += x.ge(knot.at).select(knot.jump, 0.0);
        }
        (self.segments()).fold(sum, |sum, segment| sum + segment.value(x))
    }

    fn is_steep(&self) -> bool {
        self.knots.iter().any(|knot| !knot.jump.is_zero())
    }

    fn moments(&self, x: &Gaussian<'b>) -> Moments<'b> {
        let t = self.within(x.range);
        let m = t.limited(x.mean, x.sd * 8.0);
        let x = &Gaussian { mean: m, ..*x };
        let normals: Vec<Normal<'b>> = (t.knots.iter())
            .map(|knot| Normal::at(m - knot.at, x.inverse_sd))
            .collect();
        let lines = t.lines();
        // The mean and its derivatives by m.
        let mut sums = lines.moments(x, &t.knots, &normals);
        let mut add = |terms: [Float<'b>; 4]| {
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum += term;
            }
        };
        for (&Knot { jump, .. }, n) in t.knots.iter().zip(&normals) {
            let steep = jump * x.inverse_sd;
            // −z J φ/σ² and J (z² − 1) φ/σ³.
            let bell = steep * x.inverse_sd * n.density;
            add([
                jump * n.below,
                steep * n.density,
                -n.z * bell,
                (n.z.square() + -1.0) * bell * x.inverse_sd,
            ]);
        }
        t.segments().for_each(|segment| add(segment.moments(x)));
        let [mean, alpha, ..] = sums;
        Moments::of(sums, t.distortion(x, (&lines, &normals), mean, alpha))
    }

    fn shared(&self, range: [f32; 2]) -> Option<SharedTransfer<'b>> {
        let t = self.within(range);
        let mut values = smallvec![t.offset, t.slope];
        values.extend(t.knots.iter().flat_map(|k| [k.at, k.jump, k.bend]));
        values.extend(t.bumps.iter().flat_map(|bump| [bump.start, bump.end]));
        Some(SharedTransfer {
            name: "piecewise",
            doc: "A piecewise function of a signal.",
            variant: (t.knots.len() as u32) << 1 | u32::from(t.level),
            values,
            rebuild: |variant, values| {
                let (line, rest) = values.split_at(2);
                let (knots, bumps) = rest.split_at(3 * (variant >> 1) as usize);
                let knot = |k: &[_]| Knot {
                    at: k[0],
                    jump: k[1],
                    bend: k[2],
                };
                let bump = |p: &[_]| Bump {
                    start: p[0],
                    end: p[1],
                };
                Box::new(Piecewise {
                    offset: line[0],
                    slope: line[1],
                    knots: knots.chunks_exact(3).map(knot).collect(),
                    bumps: bumps.chunks_exact(2).map(bump).collect(),
                    level: variant & 1 == 1,
                    values: None,
                })
            },
        })
    }

    fn derivative(&self) -> Option<Box<dyn Transfer<'b> + 'b>> {
        if self.is_steep() {
            return None;
        }
        if self.bumps.is_empty() {
            let steps = self.knots.iter().map(|k| Knot::jump(k.at, k.bend));
            let slope = Self::straight(self.slope, 0.0, steps.collect());
            return Some(Box::new(slope));
        }
        let t = self.clone();
        Some(Box::new(Curve {
            kinks: t.knots.iter().map(|knot| knot.at).collect(),
            flat: [Some(t.slope), t.level.then(|| t.offset.literal(0.0))],
            range: UNBOUNDED,
            function: move |x| t.steepness(x),
        }))
    }

    fn binary(&self) -> Option<[f32; 2]> {
        let [knot] = self.knots[..] else { return None };
        let flat = self.slope.is_zero() && knot.bend.is_zero();
        let low = self.offset.as_constant().filter(|_| flat)?;
        Some([low, low + knot.jump.as_constant()?])
    }

    fn values(&self) -> Option<[f32; 2]> {
        let mut value = self.offset.as_constant().filter(|_| self.slope.is_zero())?;
        let mut values = [value; 2];
        for knot in &self.knots {
            if !knot.bend.is_zero() {
                return None;
            }
            value += knot.jump.as_constant()?;
            if value == values[0] || value == values[1] {
                continue;
            }
            if values[0] != values[1] {
                return None;
            }
            values[1] = value;
        }
        Some(values)
    }

    fn knots(&self) -> u32 {
        self.knots.len() as u32
    }

    fn range(&self, [low, high]: [f32; 2]) -> [f32; 2] {
        // The extremes are at knots (either side), at the ends, and where the slope of a cubic is 0.
        let constant = Float::as_constant;
        let (Some(offset), Some(slope)) = (constant(self.offset), constant(self.slope)) else {
            return self.values.unwrap_or(UNBOUNDED);
        };
        let knots: Option<Vec<[f32; 3]>> = (self.knots.iter())
            .map(|k| Some([constant(k.at)?, constant(k.jump)?, constant(k.bend)?]))
            .collect();
        let Some(knots) = knots else {
            return self.values.unwrap_or(UNBOUNDED);
        };
        let value = |x: f32, jumps: bool| {
            knots
                .iter()
                .fold(offset + slope * x, |sum, &[at, jump, bend]| {
                    let jumped = if x > at || (jumps && x == at) {
                        jump
                    } else {
                        0.0
                    };
                    sum + jumped + bend * (x - at).max(0.0)
                })
        };
        let after = knots.iter().fold(slope, |sum, k| sum + k[2]);
        let (first, last) = (
            knots.first().map_or(0.0, |k| k[0]),
            knots.last().map_or(0.0, |k| k[0]),
        );
        let flat = |s: f32| s.abs() < 1e-6;
        if (!low.is_finite() && !flat(slope)) || (!high.is_finite() && !flat(after)) {
            return UNBOUNDED;
        }
        let (low, high) = (
            if low.is_finite() { low } else { first },
            if high.is_finite() { high } else { last },
        );
        let inside = knots
            .iter()
            .map(|k| k[0])
            .filter(|&t| t >= low && t <= high);
        let mut range = [f32::INFINITY, f32::NEG_INFINITY];
        for x in inside.chain([low, high]) {
            for jumps in [false, true] {
                let y = value(x, jumps);
                range = [range[0].min(y), range[1].max(y)];
            }
        }
        for (i, bump) in self.bumps.iter().enumerate() {
            let (Some(p), Some(q)) = (constant(bump.start), constant(bump.end)) else {
                return UNBOUNDED;
            };
            let (from, to) = (knots[i][0], knots[i + 1][0]);
            let ends = [value(from, true), value(to, false)];
            for turn in turns(ends[1] - ends[0], p, q) {
                let y = ends[0] + turn * (ends[1] - ends[0]);
                let y = y + turn * (1.0 - turn) * (p * (1.0 - turn) - q * turn);
                range = [range[0].min(y), range[1].max(y)];
            }
        }
        if !self.knots.is_empty() {
            // Rounding of sums of slopes must not push a clamp inside the function's range.
            let slack = 1e-6 * range[0].abs().max(range[1].abs());
            range = [range[0] - slack, range[1] + slack];
        }
        range
    }
}

/// Where in (0, 1) the slope of a straight segment with a bump is 0:
/// rise + p − 2(2p + q)τ + 3(p + q)τ² = 0.
fn turns(rise: f32, p: f32, q: f32) -> impl Iterator<Item = f32> {
    let (a, half, c) = (3.0 * (p + q), -(2.0 * p + q), rise + p);
    let root = (half * half - a * c).max(0.0).sqrt();
    // The root of larger magnitude first: neither of the two loses digits.
    let larger = if half < 0.0 {
        root - half
    } else {
        -root - half
    };
    [larger / a, c / larger]
        .into_iter()
        .filter(|t| *t > 0.0 && *t < 1.0)
}
