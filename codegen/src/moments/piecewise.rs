//! Piecewise linear functions with jumps, and cubic segments, in closed form.
//!
//! T(x) = c₀ + d₀x + Σ_k [J_k (x ≥ t_k) + B_k max(x − t_k, 0)] + Σ_j c_j(τ_j),
//! τ_j = (x − t_j)/(t_{j+1} − t_j), c(τ) = τ(1 − τ)(p(1 − τ) − qτ) on [0, 1], else 0. With z_k = (m − t_k)/σ:
//! E[T] = c₀ + d₀m + Σ J_k Φ(z_k) + B_k σ(z_k Φ(z_k) + φ(z_k)) + …, and its derivatives by m
//! (MATH §6; RULES, transfers).

mod cubic;
mod distortion;
mod segment;

use super::{Gaussian, Moments, Normal, SharedTransfer, Transfer, signal::UNBOUNDED};
use crate::ir::{Builder, Value};
use segment::Segment;
use smallvec::smallvec;

pub(super) use distortion::Residual;
pub use segment::Bump;
pub(super) use segment::probability;

/// Where a piecewise function jumps or bends.
#[derive(Clone, Copy, Debug)]
pub struct Knot {
    /// t: where; knots are sorted.
    pub at: Value,
    /// J: by how much the value jumps (T is the right limit at t itself).
    pub jump: Value,
    /// B: by how much the slope changes.
    pub bend: Value,
}

/// A piecewise function: see the module documentation.
#[derive(Clone, Debug)]
pub struct Piecewise {
    /// c₀.
    pub offset: Value,
    /// d₀.
    pub slope: Value,
    /// The knots, sorted.
    pub knots: Vec<Knot>,
    /// The bumps of the segments between neighbouring knots, monotone on top of the straight ones;
    /// empty where every segment is straight.
    pub bumps: Vec<Bump>,
}

impl Piecewise {
    /// 1 where x ≥ `at`, else 0.
    pub fn step(b: &mut Builder, at: Value) -> Self {
        let (zero, one) = (b.f32(0.0), b.f32(1.0));
        let knots = vec![Knot {
            at,
            jump: one,
            bend: zero,
        }];
        Self {
            offset: zero,
            slope: zero,
            knots,
            bumps: Vec::new(),
        }
    }

    /// max(x, 0).
    pub fn hinge(b: &mut Builder) -> Self {
        let (zero, one) = (b.f32(0.0), b.f32(1.0));
        let knots = vec![Knot {
            at: zero,
            jump: zero,
            bend: one,
        }];
        Self {
            offset: zero,
            slope: zero,
            knots,
            bumps: Vec::new(),
        }
    }

    /// |x|.
    pub fn absolute(b: &mut Builder) -> Self {
        let (zero, minus, two) = (b.f32(0.0), b.f32(-1.0), b.f32(2.0));
        let knots = vec![Knot {
            at: zero,
            jump: zero,
            bend: two,
        }];
        Self {
            offset: zero,
            slope: minus,
            knots,
            bumps: Vec::new(),
        }
    }

    /// |x| with its corner rounded by a parabola: (x² + k²)/2k where |x| < k = `width`.
    pub fn rounded(b: &mut Builder, width: Value) -> Self {
        let least = b.f32(1e-6);
        let width = b.max(width, least);
        let (zero, one, minus) = (b.f32(0.0), b.f32(1.0), b.f32(-1.0));
        let (low, span) = (b.neg(width), b.add(width, width));
        let knots = [low, width].map(|at| Knot {
            at,
            jump: zero,
            bend: one,
        });
        let start = b.neg(span);
        Self {
            offset: zero,
            slope: minus,
            knots: knots.to_vec(),
            bumps: vec![Bump { start, end: span }],
        }
    }

    /// x limited to `[low, high]`; `low` where they are swapped, as by `max` after `min`.
    pub fn clamp(b: &mut Builder, low: Value, high: Value) -> Self {
        let high = b.max(low, high);
        let (zero, one, minus) = (b.f32(0.0), b.f32(1.0), b.f32(-1.0));
        let knots = vec![
            Knot {
                at: low,
                jump: zero,
                bend: one,
            },
            Knot {
                at: high,
                jump: zero,
                bend: minus,
            },
        ];
        Self {
            offset: low,
            slope: zero,
            knots,
            bumps: Vec::new(),
        }
    }

    /// 0 below `low`, 1 above `high`, cubic between (a step where they are equal).
    pub fn smoothstep(b: &mut Builder, low: Value, high: Value) -> Self {
        let (zero, one) = (b.f32(0.0), b.f32(1.0));
        Self::ramp(b, &[(low, zero), (high, one)], Shape::Smooth)
    }

    /// A ramp through `(at, value)`, sorted; constant outside. Neighbours at one place jump.
    ///
    /// # Panics
    /// If there is no stop: a bug of the caller.
    pub fn ramp(b: &mut Builder, stops: &[(Value, Value)], shape: Shape) -> Self {
        let zero = b.f32(0.0);
        let mut knots: Vec<Knot> = Vec::new();
        let mut bumps = Vec::new();
        let mut secants = Vec::new();
        let mut before = zero;
        for (i, &(at, value)) in stops.iter().enumerate() {
            let (mut jump, mut after) = (zero, zero);
            let mut difference = zero;
            if shape == Shape::Constant {
                if i > 0 {
                    jump = b.sub(value, stops[i - 1].1);
                }
            } else if let Some(&(next_at, next)) = stops.get(i + 1) {
                difference = b.sub(next, value);
                let width = b.sub(next_at, at);
                // Stops closer than this are one place: the ramp between them is a jump, which the
                // later stop makes.
                let least = b.f32(1e-6);
                let distinct = b.lt(least, width);
                let guarded = b.max(width, least);
                let slope = b.div(difference, guarded);
                after = b.select(distinct, slope, zero);
                difference = b.select(distinct, difference, zero);
                secants.push(cubic::Secant {
                    slope: after,
                    width: guarded,
                });
            }
            if shape != Shape::Constant && i > 0 {
                let (previous_at, previous) = stops[i - 1];
                let width = b.sub(at, previous_at);
                let least = b.f32(1e-6);
                let distinct = b.lt(least, width);
                let step = b.sub(value, previous);
                jump = b.select(distinct, zero, step);
            }
            let bend = b.sub(after, before);
            knots.push(Knot { at, jump, bend });
            if shape == Shape::Smooth && i + 1 < stops.len() {
                bumps.push(Bump::smooth(b, difference));
            }
            before = after;
        }
        if shape == Shape::Cubic {
            bumps = cubic::monotone(b, &secants);
        }
        let slope = zero;
        Self {
            offset: stops[0].1,
            slope,
            knots,
            bumps,
        }
    }

    /// `a·T + c`.
    pub fn affine(mut self, b: &mut Builder, a: Value, c: Value) -> Self {
        let scaled = b.mul(self.offset, a);
        self.offset = b.add(scaled, c);
        self.slope = b.mul(self.slope, a);
        for knot in &mut self.knots {
            knot.jump = b.mul(knot.jump, a);
            knot.bend = b.mul(knot.bend, a);
        }
        for bump in &mut self.bumps {
            *bump = bump.scale(b, a);
        }
        self
    }

    /// The same function on `range`, without the knots that no input reaches: a ramp over all of a
    /// bounded signal is linear there.
    fn within(&self, b: &mut Builder, [low, high]: [f32; 2]) -> Self {
        if !self.bumps.is_empty() {
            return self.clone();
        }
        let mut out = Self {
            knots: Vec::new(),
            ..self.clone()
        };
        for knot in &self.knots {
            match b.as_constant(knot.at) {
                Some(at) if at >= high => {}
                Some(at) if at <= low => {
                    let back = b.mul(knot.bend, knot.at);
                    let rise = b.sub(knot.jump, back);
                    out.offset = b.add(out.offset, rise);
                    out.slope = b.add(out.slope, knot.bend);
                }
                _ => out.knots.push(*knot),
            }
        }
        out
    }

    /// The input limited to where the function is not constant, by `margin` on both sides: far
    /// outside, sums of slopes would leave their rounding errors.
    fn limited(&self, b: &mut Builder, x: Value, margin: Value) -> Value {
        let (Some(first), Some(last)) = (self.knots.first(), self.knots.last()) else {
            return x;
        };
        let mut x = x;
        if b.is_zero(self.slope) {
            let low = b.sub(first.at, margin);
            x = b.max(x, low);
        }
        let mut after = self.slope;
        for knot in &self.knots {
            after = b.add(after, knot.bend);
        }
        if b.as_constant(after).is_some_and(|slope| slope.abs() < 1e-6) || self.is_ramp(b) {
            let high = b.add(last.at, margin);
            x = b.min(x, high);
        }
        x
    }

    /// Whether bends are differences of neighbouring slopes from 0 to 0, whatever their values.
    fn is_ramp(&self, b: &Builder) -> bool {
        b.is_zero(self.slope) && self.knots.len() > 1
    }

    fn segments(&self) -> impl Iterator<Item = Segment> + '_ {
        (self.bumps.iter().zip(self.knots.windows(2))).map(|(&bump, pair)| Segment {
            from: pair[0].at,
            to: pair[1].at,
            bump,
        })
    }
}

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

impl Transfer for Piecewise {
    fn value(&self, b: &mut Builder, x: Value) -> Value {
        let zero = b.f32(0.0);
        let limited = self.limited(b, x, zero);
        let linear = b.mul(self.slope, limited);
        let mut sum = b.add(self.offset, linear);
        for knot in &self.knots {
            let distance = b.sub(limited, knot.at);
            let positive = b.max(distance, zero);
            let rise = b.mul(knot.bend, positive);
            sum = b.add(sum, rise);
            let on = b.le(knot.at, x);
            let jump = b.select(on, knot.jump, zero);
            sum = b.add(sum, jump);
        }
        for segment in self.segments() {
            let bump = segment.value(b, x);
            sum = b.add(sum, bump);
        }
        sum
    }

    fn moments(&self, b: &mut Builder, x: &Gaussian) -> Moments {
        let t = self.within(b, x.range);
        let margin = b.scale(x.sd, 8.0);
        let m = t.limited(b, x.mean, margin);
        let x = &Gaussian { mean: m, ..*x };
        let linear = b.mul(t.slope, m);
        let zero = b.f32(0.0);
        let mut out = Moments {
            mean: b.add(t.offset, linear),
            slope: t.slope,
            curvature: zero,
            third: zero,
            distortion: zero,
        };
        let inverse_variance = b.square(x.inverse_sd);
        for knot in &t.knots {
            let distance = b.sub(m, knot.at);
            let n = Normal::at(b, distance, x.inverse_sd);
            let hinge = n.hinge(b, distance, x.sd);
            let density = b.mul(n.density, x.inverse_sd);
            let rise = b.dot(&[knot.jump, knot.bend], &[n.below, hinge]);
            out.mean = b.add(out.mean, rise);
            let rise = b.dot(&[knot.jump, knot.bend], &[density, n.below]);
            out.slope = b.add(out.slope, rise);
            // (B − J z/σ) φ/σ and (J(z² − 1)/σ − B z) φ/σ².
            let steep = b.mul(knot.jump, x.inverse_sd);
            let falling = b.mul(steep, n.z);
            let bent = b.sub(knot.bend, falling);
            let bent = b.mul(bent, density);
            out.curvature = b.add(out.curvature, bent);
            let square = b.square(n.z);
            let square = b.offset(square, -1.0);
            let skewed = b.mul(steep, square);
            let back = b.mul(knot.bend, n.z);
            let skewed = b.sub(skewed, back);
            let weight = b.mul(n.density, inverse_variance);
            let skewed = b.mul(skewed, weight);
            out.third = b.add(out.third, skewed);
        }
        for segment in t.segments() {
            let bump = segment.moments(b, x);
            out.mean = b.add(out.mean, bump.mean);
            out.slope = b.add(out.slope, bump.slope);
            out.curvature = b.add(out.curvature, bump.curvature);
            out.third = b.add(out.third, bump.third);
        }
        out.distortion = t.distortion(b, x, out.mean, out.slope);
        out
    }

    fn shared(&self, b: &mut Builder, range: [f32; 2]) -> Option<SharedTransfer> {
        let t = self.within(b, range);
        let mut values = smallvec![t.offset, t.slope];
        for knot in &t.knots {
            values.extend([knot.at, knot.jump, knot.bend]);
        }
        values.extend(t.bumps.iter().flat_map(|bump| [bump.start, bump.end]));
        Some(SharedTransfer {
            name: "piecewise",
            doc: "A piecewise function of a signal.",
            variant: t.knots.len() as u32,
            values,
            rebuild: |knots, values| {
                let (line, rest) = values.split_at(2);
                let (knots, bumps) = rest.split_at(3 * knots as usize);
                Box::new(Self {
                    offset: line[0],
                    slope: line[1],
                    knots: (knots.chunks_exact(3))
                        .map(|k| Knot {
                            at: k[0],
                            jump: k[1],
                            bend: k[2],
                        })
                        .collect(),
                    bumps: (bumps.chunks_exact(2))
                        .map(|p| Bump {
                            start: p[0],
                            end: p[1],
                        })
                        .collect(),
                })
            },
        })
    }

    fn binary(&self, b: &Builder) -> Option<[f32; 2]> {
        let [knot] = self.knots[..] else { return None };
        let flat = b.is_zero(self.slope) && b.is_zero(knot.bend);
        let low = b.as_constant(self.offset).filter(|_| flat)?;
        Some([low, low + b.as_constant(knot.jump)?])
    }

    fn range(&self, b: &Builder, [low, high]: [f32; 2]) -> [f32; 2] {
        // The extremes are at knots (either side), at the ends, and where the slope of a cubic is 0.
        let constant = |v: Value| b.as_constant(v);
        let (Some(offset), Some(slope)) = (constant(self.offset), constant(self.slope)) else {
            return UNBOUNDED;
        };
        let knots: Option<Vec<[f32; 3]>> = (self.knots.iter())
            .map(|k| Some([constant(k.at)?, constant(k.jump)?, constant(k.bend)?]))
            .collect();
        let Some(knots) = knots else { return UNBOUNDED };
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
