//! A function of one signal by the moments of its parts: X = m + σ (ξ + τ z) with a few places ξ.
//!
//! With weights w of the places, Σ w ξ² = s² and s² + τ² = 1, that mixture is the Gaussian but for
//! an error of 0.0007 of its distribution function. Each part has a mean M, a slope A and a
//! variance D beyond it; with r = M − M₀ − A₀σξ, the rest over the line through the middle part, and
//! a = A − A₀, the law of total variance gives, without a difference of large numbers:
//!
//! ```text
//! E[T]  = M₀ + Σ w r                       E[T′] = A₀ + β,  β = Σ w (a τ² + r ξ/σ)
//! Var T − E[T′]² σ² = Σ w (D + r² + a² τ² σ²) − (Σ w r)² − β² σ²
//! E[T″] = Σ w a ξ/(s² σ)                   E[T‴] = Σ w a (ξ²/s² − 1)/(s² σ²)
//! ```
//!
//! The last two are Stein's identity for ξ.

use super::{Gaussian, Moments, Transfer};
use crate::ir::{Builder, FunctionRef, Module, Type, Value};

/// How many places there may be on each side of the middle: the fewest that a region needs.
pub(crate) const SIDES: [usize; 3] = [3, 7, 15];

/// Where the parts of a Gaussian are.
#[derive(Clone, Debug)]
struct Rule {
    /// How far apart the places are, in σ.
    step: f64,
    /// The exponent of the weights, −½ (step/spread)².
    exponent: f64,
    /// The weight of the middle.
    weight: f64,
    /// s², the variance of the places.
    variance: f64,
    /// τ, the standard deviation of a part.
    tau: f64,
}

impl Rule {
    /// Two thirds of a step are one τ, and the outermost places 2.8 standard deviations of their
    /// weights away.
    fn new(side: usize) -> Self {
        let step = 2.4 / side as f64
            * [1.05, 1.33, 1.45][SIDES
                .iter()
                .position(|&s| s == side)
                .expect("one of the rules")];
        let spread = (1.0 - (2.0 / 3.0 * step).powi(2)).sqrt();
        let exponent = -0.5 * (step / spread).powi(2);
        let weight = |k: usize| (exponent * (k * k) as f64).exp();
        let total = 1.0 + 2.0 * (1..=side).map(weight).sum::<f64>();
        let square = |k: usize| 2.0 * weight(k) / total * (k as f64 * step).powi(2);
        let variance = (1..=side).map(square).sum::<f64>();
        Self {
            step,
            exponent,
            weight: 1.0 / total,
            variance,
            tau: (1.0 - variance).sqrt(),
        }
    }
}

/// A function and its moments as functions of a module, and the parameters of both.
#[derive(Clone, Debug)]
pub(crate) struct Tapped {
    /// Gives the components at a value and for the parameters.
    pub(crate) value: FunctionRef,
    /// Made by [`Self::function`].
    pub(crate) moments: FunctionRef,
    /// Which one this is.
    pub(crate) component: usize,
    pub(crate) parameters: Vec<Value>,
    /// The least and largest value.
    pub(crate) range: [f32; 2],
}

impl Tapped {
    /// The moments of one component: mean, slope, curvature, third, distortion.
    pub(crate) const MOMENTS: usize = 5;

    /// The moments of all components as a function of m, σ and the parameters. `part` takes a mean, a
    /// standard deviation and the parameters, and gives mean, slope and the variance beyond it of each
    /// component.
    pub(crate) fn function(
        module: &mut Module,
        name: &str,
        part: &FunctionRef,
        (components, side): (usize, usize),
        parameters: impl Fn(&mut Builder) -> Vec<Value>,
    ) -> FunctionRef {
        let rule = Rule::new(side);
        let turn = turn(module, name, part, (components, side), &parameters);
        let mut b = Builder::new(
            format!("{name}_moments"),
            "The moments of a function of a Gaussian, from those of its parts.",
        );
        let (mean, sd) = (b.param_f32("mean"), b.param_f32("sd"));
        let parameters = parameters(&mut b);
        let narrow = b.scale(sd, rule.tau as f32);
        let mut arguments = vec![mean, narrow];
        arguments.extend(&parameters);
        let middle = b.call(part, &arguments);
        let zero = b.f32(0.0);
        let mut captures = vec![mean, sd, narrow];
        captures.extend(&middle);
        captures.extend(&parameters);
        let count = b.u32(2 * side as u32);
        let sums = b.fold(&turn, count, &vec![zero; SUMS * components], &captures);
        let one = b.f32(1.0);
        let inverse = b.div(one, sd);
        for i in 0..components {
            let [first, beta, square, second, third] = std::array::from_fn(|k| sums[SUMS * i + k]);
            let [centre, slope, rest] = std::array::from_fn(|k| middle[3 * i + k]);
            let own = b.scale(rest, rule.weight as f32);
            let square = b.add(square, own);
            // The middle has no r and no a.
            let line = b.mul(beta, sd);
            let (explained, shifted) = (b.square(line), b.square(first));
            let distortion = b.sub(square, explained);
            let distortion = b.sub(distortion, shifted);
            let distortion = b.max(distortion, zero);
            let of_second = b.scale(inverse, (1.0 / rule.variance) as f32);
            let of_third = b.mul(of_second, inverse);
            let moments = [
                ("mean", b.add(centre, first)),
                ("slope", b.add(slope, beta)),
                ("curvature", b.mul(second, of_second)),
                ("third", b.mul(third, of_third)),
                ("distortion", distortion),
            ];
            for (of, value) in moments {
                b.result(format!("{of}_{i}"), value);
            }
        }
        b.finish(module)
    }
}

/// How many sums there are of a component: r; β; D + r² + a² τ² σ²; a ξ; a (ξ²/s² − 1).
const SUMS: usize = 5;

/// One more part, beside the middle: the turn of a fold over the sums.
fn turn(
    module: &mut Module,
    name: &str,
    part: &FunctionRef,
    (components, side): (usize, usize),
    parameters: &impl Fn(&mut Builder) -> Vec<Value>,
) -> FunctionRef {
    let rule = Rule::new(side);
    let mut b = Builder::new(format!("{name}_turn"), "One more part of a Gaussian.");
    let index = b.param("index", Type::U32);
    let sums: Vec<Value> = (0..SUMS * components)
        .map(|i| b.param_f32(format!("sum_{i}")))
        .collect();
    let [mean, sd, narrow] = ["mean", "sd", "narrow"].map(|name| b.param_f32(name));
    let middle: Vec<Value> = (0..3 * components)
        .map(|i| b.param_f32(format!("middle_{i}")))
        .collect();
    let parameters = parameters(&mut b);
    // The middle is left out: … −2, −1, 1, 2 …
    let place = b.float_u(index);
    let place = b.offset(place, -(side as f32));
    let zero = b.f32(0.0);
    let negative = b.lt(place, zero);
    let next = b.offset(place, 1.0);
    let place = b.select(negative, place, next);
    let square = b.square(place);
    let exponent = b.scale(square, rule.exponent as f32);
    let weight = b.exp(exponent);
    let weight = b.scale(weight, rule.weight as f32);
    let xi = b.scale(place, rule.step as f32);
    let away = b.mul(sd, xi);
    let at = b.add(mean, away);
    let mut arguments = vec![at, narrow];
    arguments.extend(&parameters);
    let found = b.call(part, &arguments);
    let one = b.f32(1.0);
    let inverse = b.div(one, sd);
    let by_place = b.mul(xi, inverse);
    let hermite = b.square(xi);
    let hermite = b.scale(hermite, (1.0 / rule.variance) as f32);
    let hermite = b.offset(hermite, -1.0);
    for i in 0..components {
        let [centre, slope, _] = std::array::from_fn(|k| middle[3 * i + k]);
        let [level, steep, rest] = std::array::from_fn(|k| found[3 * i + k]);
        let line = b.mul(slope, away);
        let beyond = b.sub(level, centre);
        let beyond = b.sub(beyond, line);
        let turned = b.sub(steep, slope);
        let (own, between) = (
            b.scale(turned, (rule.tau * rule.tau) as f32),
            b.mul(beyond, by_place),
        );
        let beta = b.add(own, between);
        let (spread, squared) = (b.mul(turned, narrow), b.square(beyond));
        let spread = b.square(spread);
        let total = b.add(rest, squared);
        let total = b.add(total, spread);
        let of_place = b.mul(turned, xi);
        let of_hermite = b.mul(turned, hermite);
        for (k, term) in [beyond, beta, total, of_place, of_hermite]
            .into_iter()
            .enumerate()
        {
            let part = b.mul(term, weight);
            let sum = b.add(sums[SUMS * i + k], part);
            b.result(format!("sum_{}", SUMS * i + k), sum);
        }
    }
    b.finish(module)
}

impl Transfer for Tapped {
    fn value(&self, b: &mut Builder, x: Value) -> Value {
        let mut arguments = vec![x];
        arguments.extend(&self.parameters);
        b.call(&self.value, &arguments)[self.component]
    }

    fn moments(&self, b: &mut Builder, x: &Gaussian) -> Moments {
        let mut arguments = vec![x.mean, x.sd];
        arguments.extend(&self.parameters);
        let all = b.call(&self.moments, &arguments);
        let [mean, slope, curvature, third, distortion] =
            std::array::from_fn(|k| all[Self::MOMENTS * self.component + k]);
        Moments {
            mean,
            slope,
            curvature,
            third,
            distortion,
        }
    }

    fn range(&self, _: &Builder, _: [f32; 2]) -> [f32; 2] {
        self.range
    }
}
