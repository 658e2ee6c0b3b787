//! Functions of one signal: Stein's slope, Bussgang's distortion, and the third cumulant.

use super::{Algebra, Mode, Signal, signal::ordered};
use crate::ir::{Builder, Value};

/// The Gaussian that a transfer is averaged over.
#[derive(Clone, Copy, Debug)]
pub struct Gaussian {
    /// The mean m.
    pub mean: Value,
    /// The variance v.
    pub variance: Value,
    /// σ, at least 1e-6.
    pub sd: Value,
    /// 1/σ.
    pub inverse_sd: Value,
    /// The range of the input, as far as is known.
    pub range: [f32; 2],
}

/// The moments of T(X) for a Gaussian X.
#[derive(Clone, Copy, Debug)]
pub struct Moments {
    /// E[T].
    pub mean: Value,
    /// E[T′] = ∂E[T]/∂m (Stein).
    pub slope: Value,
    /// E[T″] = ∂²E[T]/∂m².
    pub curvature: Value,
    /// E[T‴] = ∂³E[T]/∂m³.
    pub third: Value,
    /// Var T − E[T′]² v, never negative (Bussgang).
    pub distortion: Value,
}

/// A function of one number, with its moments over a Gaussian.
pub trait Transfer {
    /// T(x).
    fn value(&self, b: &mut Builder, x: Value) -> Value;
    /// The moments over a Gaussian.
    fn moments(&self, b: &mut Builder, x: &Gaussian) -> Moments;
    /// The period, where the function has one: positions then give their fraction alone.
    fn period(&self) -> Option<f32> {
        None
    }
    /// The two values of a function that takes no others.
    fn binary(&self, _: &Builder) -> Option<[f32; 2]> {
        None
    }
    /// The least and largest value on `[low, high]` (which may be infinite).
    fn range(&self, b: &Builder, input: [f32; 2]) -> [f32; 2];
}

impl Algebra {
    /// T(X): mean E[T] + (κ₃/6) E[T‴] inside T's range, coefficients E[T′]·x, second order
    /// E[T′] H + E[T″] g gᵀ, and the distortion into a fresh ε (RULES: transfers, H and the third
    /// cumulant). Where several transfers read X, the second Hermite part of the distortion is
    /// shared among them.
    pub fn transfer(&mut self, x: &Signal, t: &dyn Transfer) -> Signal {
        let b = &mut self.b;
        let range = t.range(b, x.range);
        // Whole periods do not matter, and a fraction keeps its detail far from the origin.
        let fraction = Signal {
            cell: None,
            ..x.clone()
        };
        let x = if t.period() == Some(1.0) {
            &fraction
        } else {
            x
        };
        if !self.mode.spreads() || x.is_certain(b) {
            let mean = x.flat_mean(b);
            let value = t.value(b, mean);
            return Signal::certain(b, value).with_range(range);
        }
        if let Some(values) = x.binary {
            return self.between(x, t, values);
        }
        let x = &x.flat(b);
        let linear = x.linear_variance(b);
        let other = x.other_variance(b);
        let variance = b.add(linear, other);
        let (sd, inverse_sd) = self.spread(variance);
        let b = &mut self.b;
        let gaussian = Gaussian {
            mean: x.mean,
            variance,
            sd,
            inverse_sd,
            range: x.range,
        };
        let m = t.moments(b, &gaussian);
        if !b.is_zero(m.distortion) {
            self.bent = true;
            self.period = t.period();
        }
        let mut out = x.scale(b, m.slope);
        out.range = range;
        out.mean = m.mean;
        let skewness = x.skewness(b, inverse_sd);
        if !b.is_zero(skewness) {
            // (κ₃/6) E[T‴]: σ by σ, since σ³ alone overflows.
            let mut correction = b.scale(skewness, 1.0 / 6.0);
            correction = b.mul(correction, m.third);
            for _ in 0..3 {
                correction = b.mul(correction, sd);
            }
            out.mean = b.add(m.mean, correction);
            if range[0].is_finite() && range[1].is_finite() {
                out.mean = b.clamp(out.mean, range[0], range[1]);
            }
        }
        let mut distortion = m.distortion;
        if self.mode == Mode::Quad {
            let [g1, g2] = x.g;
            let outer = [b.square(g1), b.mul(g1, g2), b.square(g2)];
            for (h, o) in out.h.iter_mut().zip(outer) {
                let bent = b.mul(m.curvature, o);
                *h = b.add(*h, bent);
            }
        }
        // The second Hermite coefficient squared: v² E[T″]²/2, of which the second order carries
        // |g|⁴ E[T″]²/2. A footprint's fourth power overflows: the curvature goes to each factor.
        let zero = b.f32(0.0);
        let carries = self.mode == Mode::Quad;
        if let Some(symbol) = x.hermite {
            let left = if carries {
                let sum = b.add(variance, linear);
                let (sum, rest) = (b.sqrt(sum), b.sqrt(other));
                b.mul(sum, rest)
            } else {
                variance
            };
            let coefficient = b.mul(m.curvature, left);
            let coefficient = b.scale(coefficient, std::f32::consts::FRAC_1_SQRT_2);
            out.push_shared(symbol, coefficient);
        }
        let explained = if x.hermite.is_some() {
            variance
        } else {
            linear
        };
        if x.hermite.is_some() || carries {
            let second = b.mul(m.curvature, explained);
            let second = b.square(second);
            let second = b.scale(second, 0.5);
            distortion = b.sub(distortion, second);
            distortion = b.max(distortion, zero);
        }
        out.binary = t.binary(b).map(|values| values.map(|v| b.f32(v)));
        self.attach_fresh(&mut out, distortion);
        out
    }

    /// T(X) of a signal that takes two values is linear in it: exact, whatever T is.
    fn between(&mut self, x: &Signal, t: &dyn Transfer, [low, high]: [Value; 2]) -> Signal {
        let b = &mut self.b;
        let (at_low, at_high) = (t.value(b, low), t.value(b, high));
        let (rise, span) = (b.sub(at_high, at_low), b.sub(high, low));
        // Two equal values are one: then the rise is 0 as well.
        let (zero, one) = (b.f32(0.0), b.f32(1.0));
        let magnitude = b.abs(span);
        let distinct = b.lt(zero, magnitude);
        let span = b.select(distinct, span, one);
        let slope = b.div(rise, span);
        let mut out = x.scale(b, slope);
        let mean = x.flat_mean(b);
        let share = b.sub(mean, low);
        let part = b.mul(share, slope);
        out.mean = b.add(at_low, part);
        out.cell = None;
        out.binary = Some([at_low, at_high]);
        out.range = match [at_low, at_high].map(|v| b.as_constant(v)) {
            [Some(p), Some(q)] => ordered(p, q),
            _ => t.range(b, x.range),
        };
        out
    }
}
