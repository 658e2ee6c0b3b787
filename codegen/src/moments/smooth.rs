//! Smooth transfers: sine, exponential, integer and real powers, the reciprocal.

use super::{
    Curve, Gaussian, Moments, SharedTransfer, Transfer,
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

/// eˣ. E = M = e^{m + v/2}, D = M²(eᵛ − 1 − v); exact for a Gaussian.
#[derive(Clone, Copy, Debug)]
pub struct Exponential;

impl Transfer for Exponential {
    fn value(&self, b: &mut Builder, x: Value) -> Value {
        let x = b.clamp(x, -80.0, 80.0);
        b.exp(x)
    }

    fn moments(&self, b: &mut Builder, x: &Gaussian) -> Moments {
        let half = b.scale(x.variance, 0.5);
        let exponent = b.add(x.mean, half);
        let mean = self.value(b, exponent);
        // eᵛ − 1 − v = v²/2 (1 + v/3 (1 + v/4 (1 + …))): by its series below 1, where it cancels.
        let v = x.variance;
        let one = b.f32(1.0);
        let mut series = one;
        for k in (3..=9).rev() {
            let term = b.scale(v, 1.0 / k as f32);
            let term = b.mul(term, series);
            series = b.add(one, term);
        }
        let square = b.square(v);
        let square = b.scale(square, 0.5);
        let series = b.mul(square, series);
        let direct = self.value(b, v);
        let beyond = b.offset(v, 1.0);
        let direct = b.sub(direct, beyond);
        let small = b.lt(v, one);
        let excess = b.select(small, series, direct);
        let zero = b.f32(0.0);
        let excess = b.max(excess, zero);
        // M · (M · excess): the square of M alone overflows first.
        let distortion = b.mul(mean, excess);
        Moments {
            mean,
            slope: mean,
            curvature: mean,
            third: mean,
            distortion: b.mul(mean, distortion),
        }
    }

    fn range(&self, _: &Builder, [low, high]: [f32; 2]) -> [f32; 2] {
        if high > 80.0 {
            [low.exp(), f32::INFINITY]
        } else {
            [low.exp(), high.exp()]
        }
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

/// max(x, 0) to a real power. By the quadrature of [`Curve`] over the part above 0: the mean is
/// within 1e-3 of (|m| + σ)ᵖ for powers from 0.5 to 3.5.
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

    fn curve(self, b: &mut Builder) -> Curve<impl Fn(&mut Builder, Value) -> Value + use<>> {
        let zero = b.f32(0.0);
        let below = self.value(b, zero);
        Curve {
            function: move |b: &mut Builder, x| self.value(b, x),
            kinks: vec![zero],
            flat: [Some(below), None],
            range: UNBOUNDED,
        }
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
        let curve = self.curve(b);
        curve.moments(b, x)
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
