//! Smooth transfers: sine, exponential, integer and real powers, the reciprocal.

use super::{
    Curve, Gaussian, Moments, SharedTransfer, Transfer,
    curve::scores,
    signal::{UNBOUNDED, ordered},
    wave::nearest,
};
use crate::ir::Float;
use smallvec::SmallVec;

/// sin(x + phase), x in radians. E[sin] = sin(m) e^{−v/2}; exact for a Gaussian.
#[derive(Clone, Copy, Debug)]
pub struct Sine {
    /// Radians; π/2 makes a cosine.
    pub phase: f32,
}

impl Sine {
    /// Sine and cosine of x + phase, reduced to one turn first, so that every device agrees.
    fn pair(self, x: Float<'_>) -> [Float<'_>; 2] {
        use std::f32::consts::TAU;
        let [_, turn] = nearest(x * (1.0 / TAU) + self.phase / TAU);
        let angle = turn * TAU;
        [angle.sin(), angle.cos()]
    }
}

impl<'b> Transfer<'b> for Sine {
    fn derivative(&self) -> Option<Box<dyn Transfer<'b> + 'b>> {
        Some(Box::new(Self {
            phase: self.phase + std::f32::consts::FRAC_PI_2,
        }))
    }

    fn value(&self, x: Float<'b>) -> Float<'b> {
        self.pair(x)[0]
    }

    fn moments(&self, x: &Gaussian<'b>) -> Moments<'b> {
        let [sine, cosine] = self.pair(x.mean);
        let v = x.variance.min(160.0);
        let damping = (v * -0.5).exp();
        let (mean, slope) = (sine * damping, cosine * damping);
        // D = cos² e^{−v}(sinh v − v) + ½ sin² (1 − e^{−v})².
        let square = damping.square();
        let even = (1.0 - square).square() * 0.5;
        // e^{−v}(sinh v − v): by its series below 1, where the difference cancels.
        let v2 = v.square();
        let series = (v2 * (1.0 / 42.0) + 1.0) * v2 * (1.0 / 20.0) + 1.0;
        let series = series * (v2 * v) * (1.0 / 6.0) * square;
        let direct = (1.0 - square.square()) * 0.5 - v * square;
        let odd = v.lt(1.0).select(series, direct);
        Moments {
            mean,
            slope,
            curvature: -mean,
            third: -slope,
            distortion: cosine.square() * odd + sine.square() * even,
        }
    }

    fn range(&self, _: [f32; 2]) -> [f32; 2] {
        [-1.0, 1.0]
    }

    fn period(&self) -> Option<f32> {
        Some(std::f32::consts::TAU)
    }

    fn shared(&self, _: [f32; 2]) -> Option<SharedTransfer<'b>> {
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

impl<'b> Transfer<'b> for Exponential {
    fn derivative(&self) -> Option<Box<dyn Transfer<'b> + 'b>> {
        Some(Box::new(Self))
    }

    fn value(&self, x: Float<'b>) -> Float<'b> {
        x.clamp(-80.0, 80.0).exp()
    }

    fn moments(&self, x: &Gaussian<'b>) -> Moments<'b> {
        let v = x.variance;
        let mean = self.value(x.mean + v * 0.5);
        // eᵛ − 1 − v = v²/2 (1 + v/3 (1 + v/4 (1 + …))): by its series below 1, where it cancels.
        let one = v.literal(1.0);
        let factor = (3..=9)
            .rev()
            .fold(one, |sum, k| one + v * (1.0 / k as f32) * sum);
        let series = v.square() * 0.5 * factor;
        let direct = self.value(v) - (v + 1.0);
        let excess = v.lt(1.0).select(series, direct).max(0.0);
        // M · (M · excess): the square of M alone overflows first.
        Moments::of([mean; 4], mean * (mean * excess))
    }

    fn range(&self, [low, high]: [f32; 2]) -> [f32; 2] {
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
    fn raw<'b>(self, m: Float<'b>, v: Float<'b>) -> Vec<Float<'b>> {
        let mut raw = vec![m.literal(1.0), m];
        for k in 2..=self.power as usize {
            raw.push(m * raw[k - 1] + v * raw[k - 2] * (k - 1) as f32);
        }
        raw
    }

    /// n(n − 1)…(n − k + 1).
    fn falling(self, k: u32) -> f32 {
        (0..k).map(|i| self.power as f32 - i as f32).product()
    }
}

impl<'b> Transfer<'b> for Polynomial {
    fn value(&self, x: Float<'b>) -> Float<'b> {
        (0..self.power).fold(x.literal(1.0), |product, _| product * x)
    }

    fn moments(&self, x: &Gaussian<'b>) -> Moments<'b> {
        let (n, zero) = (self.power, x.mean.literal(0.0));
        let raw = self.raw(x.mean, x.variance);
        let derivative = |k: u32| match n.checked_sub(k) {
            Some(rest) => raw[rest as usize] * self.falling(k),
            None => zero,
        };
        let mut distortion = zero;
        let (mut power, mut factorial) = (x.variance, 1.0);
        for k in 2..=n {
            power *= x.variance;
            factorial *= k as f32;
            distortion += power * derivative(k).square() * (1.0 / factorial);
        }
        Moments::of([0, 1, 2, 3].map(derivative), distortion)
    }

    fn range(&self, [low, high]: [f32; 2]) -> [f32; 2] {
        let n = self.power as i32;
        let (p, q) = (low.powi(n), high.powi(n));
        match (n % 2 == 0, low <= 0.0 && high >= 0.0) {
            _ if n == 0 => [1.0, 1.0],
            (true, true) => [0.0, p.max(q)],
            _ => ordered(p, q),
        }
    }
}

/// The moments of a smooth function with known derivatives, by seven equidistant standard scores: exact
/// to 2e-5 for functions that are smooth over σ, at positive weights.
fn sampled<'b>(
    mean: Float<'b>,
    sd: Float<'b>,
    derivatives: impl Fn(Float<'b>) -> [Float<'b>; 4],
) -> Moments<'b> {
    let mut sums = [mean.literal(0.0); 4];
    let nodes = scores::<7>(1.25).map(|(score, weight)| {
        let step = sd * score;
        let terms = derivatives(mean + step);
        for (sum, term) in sums.iter_mut().zip(terms) {
            *sum += term * weight;
        }
        (terms[0], step, weight)
    });
    let parts = nodes.map(|(value, step, weight)| {
        let residual = value - (sums[0] + sums[1] * step);
        residual.square() * weight
    });
    Moments::of(sums, mean.builder().sum(parts))
}

/// max(x, 0) to a real power. By the quadrature of [`Curve`] over the part above 0: the mean is
/// within 1e-3 of (|m| + σ)ᵖ for powers from 0.5 to 3.5.
#[derive(Clone, Copy, Debug)]
pub struct RealPower<'b> {
    /// The exponent.
    pub power: Float<'b>,
}

impl<'b> Transfer<'b> for RealPower<'b> {
    fn value(&self, x: Float<'b>) -> Float<'b> {
        let raised = (x.max(1e-9).ln() * self.power).clamp(-80.0, 80.0).exp();
        let at_zero = self.power.le(0.0).select(1.0, 0.0);
        x.gt(0.0).select(raised, at_zero)
    }

    fn is_steep(&self) -> bool {
        true
    }

    fn moments(&self, x: &Gaussian<'b>) -> Moments<'b> {
        let zero = x.mean.literal(0.0);
        let curve = Curve {
            function: |x| self.value(x),
            kinks: vec![zero],
            flat: [Some(self.value(zero)), None],
            range: UNBOUNDED,
        };
        curve.moments(x)
    }

    fn range(&self, [low, high]: [f32; 2]) -> [f32; 2] {
        match self.power.as_constant() {
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
    fn guarded<'b>(x: Float<'b>, least: Float<'b>) -> Float<'b> {
        x.lt(0.0).select(x.min(-least), x.max(least))
    }
}

impl<'b> Transfer<'b> for Reciprocal {
    fn value(&self, x: Float<'b>) -> Float<'b> {
        1.0 / Self::guarded(x, x.literal(1e-6))
    }

    fn moments(&self, x: &Gaussian<'b>) -> Moments<'b> {
        let mean = Self::guarded(x.mean, x.sd * 4.0 + 1e-6);
        sampled(mean, x.sd, |at| {
            let value = 1.0 / at;
            let first = value * -value;
            let second = first * -value;
            let third = second * -value;
            [value, first, second * 2.0, third * 6.0]
        })
    }

    fn range(&self, [low, high]: [f32; 2]) -> [f32; 2] {
        if low > 0.0 || high < 0.0 {
            ordered(1.0 / low, 1.0 / high)
        } else {
            UNBOUNDED
        }
    }
}
