//! Smooth transfers: sine, integer and real powers, the reciprocal.

use super::{
    Gaussian, Moments, Normal, SharedTransfer, Transfer,
    signal::{UNBOUNDED, ordered},
};
use crate::ir::{Builder, Value};
use smallvec::SmallVec;

/// sin(x + phase), x in radians. E[sin] = sin(m) e^{−v/2}; exact for a Gaussian.
#[derive(Clone, Copy, Debug)]
pub struct Sine {
    /// Radians; π/2 makes a cosine.
    pub phase: f32,
}

impl Sine {
    /// Sine and cosine of x + phase, reduced to one turn first, so that every device agrees.
    fn pair(self, b: &mut Builder, x: Value) -> (Value, Value) {
        let turns = b.scale(x, 1.0 / std::f32::consts::TAU);
        let turns = b.offset(turns, self.phase / std::f32::consts::TAU);
        let rounded = b.offset(turns, 0.5);
        let whole = b.floor(rounded);
        let turn = b.sub(turns, whole);
        let angle = b.scale(turn, std::f32::consts::TAU);
        (b.sin(angle), b.cos(angle))
    }
}

impl Transfer for Sine {
    fn value(&self, b: &mut Builder, x: Value) -> Value {
        self.pair(b, x).0
    }

    fn moments(&self, b: &mut Builder, x: &Gaussian) -> Moments {
        let (sine, cosine) = self.pair(b, x.mean);
        let limit = b.f32(160.0);
        let v = b.min(x.variance, limit);
        let half = b.scale(v, -0.5);
        let damping = b.exp(half);
        let (mean, slope) = (b.mul(sine, damping), b.mul(cosine, damping));
        // D = cos² e^{−v}(sinh v − v) + ½ sin² (1 − e^{−v})².
        let square = b.square(damping);
        let one = b.f32(1.0);
        let lost = b.sub(one, square);
        let lost = b.square(lost);
        let lost = b.scale(lost, 0.5);
        // e^{−v}(sinh v − v): by its series below 1, where the difference cancels.
        let v2 = b.square(v);
        let series = b.scale(v2, 1.0 / 42.0);
        let series = b.offset(series, 1.0);
        let series = b.mul(series, v2);
        let series = b.scale(series, 1.0 / 20.0);
        let series = b.offset(series, 1.0);
        let v3 = b.mul(v2, v);
        let series = b.mul(series, v3);
        let series = b.scale(series, 1.0 / 6.0);
        let series = b.mul(series, square);
        let fourth = b.square(square);
        let direct = b.sub(one, fourth);
        let direct = b.scale(direct, 0.5);
        let linear = b.mul(v, square);
        let direct = b.sub(direct, linear);
        let small = b.lt(v, one);
        let odd = b.select(small, series, direct);
        let (c2, s2) = (b.square(cosine), b.square(sine));
        let distortion = b.dot(&[c2, s2], &[odd, lost]);
        Moments {
            mean,
            slope,
            curvature: b.neg(mean),
            third: b.neg(slope),
            distortion,
        }
    }

    fn range(&self, _: &Builder, _: [f32; 2]) -> [f32; 2] {
        [-1.0, 1.0]
    }

    fn period(&self) -> Option<f32> {
        Some(std::f32::consts::TAU)
    }

    fn shared(&self, _: &mut Builder, _: [f32; 2]) -> Option<SharedTransfer> {
        (self.phase == 0.0).then(|| SharedTransfer {
            name: "sine",
            doc: "The sine of a signal.",
            variant: 0,
            values: SmallVec::new(),
            rebuild: |_, _| Box::new(Self { phase: 0.0 }),
        })
    }
}

/// x to an integer power of 0 to [`Polynomial::MOST`]. Exact for a Gaussian: E[xⁿ] by Isserlis,
/// D = Σ_{k ≥ 2} v^k/k! · E[T^{(k)}]².
#[derive(Clone, Copy, Debug)]
pub struct Polynomial {
    /// n.
    pub power: u32,
}

impl Polynomial {
    /// The largest power.
    pub const MOST: u32 = 8;

    /// E[xᵏ] for every k up to the power, by E[xᵏ] = m E[xᵏ⁻¹] + (k − 1) v E[xᵏ⁻²].
    fn raw(self, b: &mut Builder, m: Value, v: Value) -> Vec<Value> {
        let mut raw = vec![b.f32(1.0), m];
        for k in 2..=self.power as usize {
            let first = b.mul(m, raw[k - 1]);
            let second = b.mul(v, raw[k - 2]);
            let second = b.scale(second, (k - 1) as f32);
            raw.push(b.add(first, second));
        }
        raw
    }

    /// n(n − 1)…(n − k + 1).
    fn falling(self, k: u32) -> f32 {
        (0..k).map(|i| self.power as f32 - i as f32).product()
    }
}

impl Transfer for Polynomial {
    fn value(&self, b: &mut Builder, x: Value) -> Value {
        let mut out = b.f32(1.0);
        for _ in 0..self.power {
            out = b.mul(out, x);
        }
        out
    }

    fn moments(&self, b: &mut Builder, x: &Gaussian) -> Moments {
        let n = self.power;
        let raw = self.raw(b, x.mean, x.variance);
        let derivative = |b: &mut Builder, k: u32| match n.checked_sub(k) {
            Some(rest) => b.scale(raw[rest as usize], self.falling(k)),
            None => b.f32(0.0),
        };
        let mut distortion = b.f32(0.0);
        let (mut power, mut factorial) = (x.variance, 1.0);
        for k in 2..=n {
            power = b.mul(power, x.variance);
            factorial *= k as f32;
            let d = derivative(b, k);
            let d = b.square(d);
            let part = b.mul(power, d);
            let part = b.scale(part, 1.0 / factorial);
            distortion = b.add(distortion, part);
        }
        Moments {
            mean: raw[n as usize],
            slope: derivative(b, 1),
            curvature: derivative(b, 2),
            third: derivative(b, 3),
            distortion,
        }
    }

    fn range(&self, _: &Builder, [low, high]: [f32; 2]) -> [f32; 2] {
        let n = self.power as i32;
        let (p, q) = (low.powi(n), high.powi(n));
        match (n % 2 == 0, low <= 0.0 && high >= 0.0) {
            _ if n == 0 => [1.0, 1.0],
            (true, true) => [0.0, p.max(q)],
            _ => ordered(p, q),
        }
    }
}

/// Seven equidistant standard scores with Gaussian weights of unit sum and variance: exact to 2e-5
/// for functions that are smooth over σ, at positive weights.
fn nodes() -> [(f32, f32); 7] {
    let scores: [f64; 7] = std::array::from_fn(|i| (i as f64 - 3.0) * 1.25);
    let weights = scores.map(|z| (-0.5 * z * z).exp());
    let total: f64 = weights.iter().sum();
    let variance: f64 = scores
        .iter()
        .zip(&weights)
        .map(|(z, w)| z * z * w / total)
        .sum();
    std::array::from_fn(|i| {
        (
            (scores[i] / variance.sqrt()) as f32,
            (weights[i] / total) as f32,
        )
    })
}

/// The moments of a smooth function with known derivatives, by [`nodes`].
fn sampled(
    b: &mut Builder,
    mean: Value,
    sd: Value,
    mut derivatives: impl FnMut(&mut Builder, Value) -> [Value; 4],
) -> Moments {
    let zero = b.f32(0.0);
    let mut sums = [zero; 4];
    let mut values = Vec::with_capacity(7);
    for (score, weight) in nodes() {
        let step = b.scale(sd, score);
        let x = b.add(mean, step);
        let d = derivatives(b, x);
        for (sum, d) in sums.iter_mut().zip(d) {
            let part = b.scale(d, weight);
            *sum = b.add(*sum, part);
        }
        values.push((d[0], step, weight));
    }
    let mut distortion = zero;
    for (value, step, weight) in values {
        let line = b.mul(sums[1], step);
        let line = b.add(sums[0], line);
        let residual = b.sub(value, line);
        let square = b.square(residual);
        let part = b.scale(square, weight);
        distortion = b.add(distortion, part);
    }
    let [mean, slope, curvature, third] = sums;
    Moments {
        mean,
        slope,
        curvature,
        third,
        distortion,
    }
}

/// How many σ a power is averaged over.
const REACH: f32 = 4.75;

/// Ten-point Gauss–Legendre on [0, 1].
const NODES: [(f32, f32); 10] = [
    (0.013_046_736, 0.033_335_67),
    (0.067_468_32, 0.074_725_67),
    (0.160_295_22, 0.109_543_18),
    (0.283_302_3, 0.134_633_36),
    (0.425_562_83, 0.147_762_11),
    (0.574_437_17, 0.147_762_11),
    (0.716_697_7, 0.134_633_36),
    (0.839_704_78, 0.109_543_18),
    (0.932_531_68, 0.074_725_67),
    (0.986_953_26, 0.033_335_67),
];

/// max(x, 0) to a real power. By quadrature of the difference from a tangent over the part above 0:
/// the mean is within 1e-3 of (|m| + σ)ᵖ for powers from 0.5 to 3.5.
#[derive(Clone, Copy, Debug)]
pub struct RealPower {
    /// The exponent.
    pub power: Value,
}

impl RealPower {
    /// max(x, `least`) to the power.
    fn raise(b: &mut Builder, x: Value, power: Value) -> Value {
        let least = b.f32(1e-9);
        let positive = b.max(x, least);
        let log = b.ln(positive);
        let exponent = b.mul(log, power);
        let exponent = b.clamp(exponent, -80.0, 80.0);
        b.exp(exponent)
    }
}

impl Transfer for RealPower {
    fn value(&self, b: &mut Builder, x: Value) -> Value {
        let raised = Self::raise(b, x, self.power);
        let zero = b.f32(0.0);
        let positive = b.lt(zero, x);
        let none = b.le(self.power, zero);
        let one = b.f32(1.0);
        let at_zero = b.select(none, one, zero);
        b.select(positive, raised, at_zero)
    }

    fn moments(&self, b: &mut Builder, x: &Gaussian) -> Moments {
        // The part above 0: z from `start` on, which holds the share `below` of the Gaussian.
        let n = Normal::at(b, x.mean, x.inverse_sd);
        let start = b.neg(n.z);
        let start = b.clamp(start, -REACH, REACH);
        let reach = b.f32(REACH);
        let width = b.sub(reach, start);
        // What is integrated is the difference from the tangent c + dσz at max(m, σ): constants and
        // slopes are then exact, and a small σ leaves no part of them in the derivatives.
        let touch = b.max(x.mean, x.sd);
        let c = self.value(b, touch);
        let d = b.div(c, touch);
        let d = b.mul(d, self.power);
        let rise = b.mul(d, x.sd);
        let mut rows = Vec::with_capacity(NODES.len());
        let mut total = b.f32(0.0);
        for (node, weight) in NODES {
            let step = b.scale(width, node);
            let z = b.add(start, step);
            let square = b.square(z);
            let exponent = b.scale(square, -0.5);
            let density = b.exp(exponent);
            let weight = b.scale(density, weight);
            total = b.add(total, weight);
            let deviation = b.mul(x.sd, z);
            let at = b.add(x.mean, deviation);
            rows.push((z, square, weight, self.value(b, at)));
        }
        // The weights sum to the share.
        let least = b.f32(1e-20);
        let total = b.max(total, least);
        let share = b.div(n.below, total);
        let mut sums = [b.f32(0.0); 4];
        for row in &mut rows {
            let &mut (z, square, weight, value) = row;
            row.2 = b.mul(weight, share);
            let line = b.mul(rise, z);
            let line = b.add(c, line);
            let beyond = b.sub(value, line);
            let first = b.mul(row.2, beyond);
            let (second, third) = (b.offset(square, -1.0), b.offset(square, -3.0));
            let third = b.mul(third, z);
            let parts = [
                first,
                b.mul(first, z),
                b.mul(first, second),
                b.mul(first, third),
            ];
            for (sum, part) in sums.iter_mut().zip(parts) {
                *sum = b.add(*sum, part);
            }
        }
        // Below 0, at z < s = −m/σ, the power is 0 and the difference −(c + dσz), in closed form.
        let s = b.neg(n.z);
        let s2 = b.square(s);
        let (one, edge) = (b.f32(1.0), b.mul(s, n.density));
        let (less, more) = (b.sub(s2, one), b.add(s2, one));
        let s3 = b.mul(s2, s);
        let spread = b.sub(edge, n.above);
        let (above, by_more) = (b.neg(n.above), b.mul(more, n.density));
        let (by_less, by_cube) = (b.mul(less, n.density), b.mul(s3, n.density));
        let rows_below = [
            [above, n.density],
            [n.density, spread],
            [edge, by_more],
            [by_less, by_cube],
        ];
        for (sum, row) in sums.iter_mut().zip(rows_below) {
            let part = b.dot(&row, &[c, rise]);
            *sum = b.add(*sum, part);
        }
        let [mean, first, second, third] = sums;
        let (mean, first) = (b.add(mean, c), b.add(first, rise));
        let mut distortion = b.f32(0.0);
        for (z, _, weight, value) in rows {
            let line = b.mul(first, z);
            let line = b.add(mean, line);
            let residual = b.sub(value, line);
            let square = b.square(residual);
            let part = b.mul(weight, square);
            distortion = b.add(distortion, part);
        }
        // Below 0 the power is 0, and the residual is the line: ∫ (M + S z)² φ.
        let edge = b.mul(n.z, n.density);
        let spread = b.add(n.above, edge);
        let twice = b.add(mean, mean);
        let twice = b.mul(twice, n.density);
        let (m2, s2) = (b.square(mean), b.square(first));
        let cross = b.mul(twice, first);
        let below = b.dot(&[m2, s2], &[n.above, spread]);
        let below = b.sub(below, cross);
        let zero = b.f32(0.0);
        let below = b.max(below, zero);
        let (inverse, inverse2) = (x.inverse_sd, b.square(x.inverse_sd));
        let inverse3 = b.mul(inverse, inverse2);
        Moments {
            mean,
            slope: b.mul(first, inverse),
            curvature: b.mul(second, inverse2),
            third: b.mul(third, inverse3),
            distortion: b.add(distortion, below),
        }
    }

    fn range(&self, b: &Builder, [low, high]: [f32; 2]) -> [f32; 2] {
        match b.as_constant(self.power) {
            Some(p) if p > 0.0 => [low.max(0.0).powf(p), high.max(0.0).powf(p)],
            _ => UNBOUNDED,
        }
    }
}

/// 1/x. The moments of a quotient exist only where the divisor stays away from 0: the mean is kept
/// at least 4σ (and 1e-6) from it.
#[derive(Clone, Copy, Debug)]
pub struct Reciprocal;

impl Reciprocal {
    /// x moved away from 0 to at least `least`.
    fn guarded(b: &mut Builder, x: Value, least: Value) -> Value {
        let zero = b.f32(0.0);
        let negative = b.lt(x, zero);
        let minus = b.neg(least);
        let (below, above) = (b.min(x, minus), b.max(x, least));
        b.select(negative, below, above)
    }
}

impl Transfer for Reciprocal {
    fn value(&self, b: &mut Builder, x: Value) -> Value {
        let least = b.f32(1e-6);
        let x = Self::guarded(b, x, least);
        let one = b.f32(1.0);
        b.div(one, x)
    }

    fn moments(&self, b: &mut Builder, x: &Gaussian) -> Moments {
        let least = b.scale(x.sd, 4.0);
        let least = b.offset(least, 1e-6);
        let mean = Self::guarded(b, x.mean, least);
        sampled(b, mean, x.sd, |b, at| {
            let one = b.f32(1.0);
            let value = b.div(one, at);
            let minus = b.neg(value);
            let first = b.mul(value, minus);
            let second = b.mul(first, minus);
            let third = b.mul(second, minus);
            [value, first, b.scale(second, 2.0), b.scale(third, 6.0)]
        })
    }

    fn range(&self, _: &Builder, [low, high]: [f32; 2]) -> [f32; 2] {
        if low > 0.0 || high < 0.0 {
            ordered(1.0 / low, 1.0 / high)
        } else {
            UNBOUNDED
        }
    }
}
