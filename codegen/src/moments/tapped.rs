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
use crate::ir::{Builder, Float, FunctionRef, Module, Scalar};

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
        let rule = SIDES.iter().position(|&s| s == side);
        let step = 2.4 / side as f64 * [1.05, 1.33, 1.45][rule.expect("one of the rules")];
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
pub(crate) struct Tapped<'b> {
    /// Gives the components at a value and for the parameters.
    pub(crate) value: FunctionRef,
    /// Made by [`Self::function`].
    pub(crate) moments: FunctionRef,
    /// Which one this is.
    pub(crate) component: usize,
    pub(crate) parameters: Vec<Scalar<'b>>,
    /// The least and largest value.
    pub(crate) range: [f32; 2],
}

impl Tapped<'_> {
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
        parameters: impl for<'c> Fn(&'c Builder) -> Vec<Scalar<'c>>,
    ) -> FunctionRef {
        let rule = Rule::new(side);
        let turn = turn(module, name, part, (components, side), &parameters);
        let b = &Builder::new(
            format!("{name}_moments"),
            "The moments of a function of a Gaussian, from those of its parts.",
        );
        let [mean, sd] = b.float_params(["mean", "sd"]);
        let parameters = parameters(b);
        let narrow = sd * rule.tau as f32;
        let middle = b.call(part, (mean, narrow, &parameters));
        let sums = b.fold(
            &turn,
            b.uint(2 * side as u32),
            vec![b.float(0.0); SUMS * components],
            (mean, sd, narrow, &middle, &parameters),
        );
        let by_sd = 1.0 / sd;
        for (i, (sums, middle)) in sums.chunks(SUMS).zip(middle.chunks(3)).enumerate() {
            let [first, beta, squares, second, third] = std::array::from_fn(|k| sums[k]);
            let [centre, slope, rest] = std::array::from_fn(|k| middle[k]);
            // The middle has no r and no a.
            let squares = squares + rest * rule.weight as f32;
            let distortion = squares - (beta * sd).square() - first.square();
            let of_second = by_sd * (1.0 / rule.variance) as f32;
            let moments = [
                ("mean", centre + first),
                ("slope", slope + beta),
                ("curvature", second * of_second),
                ("third", third * (of_second * by_sd)),
                ("distortion", distortion.max(0.0)),
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
    parameters: &impl for<'c> Fn(&'c Builder) -> Vec<Scalar<'c>>,
) -> FunctionRef {
    let rule = Rule::new(side);
    let b = &Builder::new(format!("{name}_turn"), "One more part of a Gaussian.");
    let numbers = |name: &str, count: usize| -> Vec<Float<'_>> {
        (0..count)
            .map(|i| b.float_param(format!("{name}_{i}")))
            .collect()
    };
    let index = b.uint_param("index");
    let sums = numbers("sum", SUMS * components);
    let [mean, sd, narrow] = b.float_params(["mean", "sd", "narrow"]);
    let middle = numbers("middle", 3 * components);
    let parameters = parameters(b);

    // The middle is left out: … −2, −1, 1, 2 …
    let place = index.to_float() + -(side as f32);
    let place = place.lt(0.0).select(place, place + 1.0);
    let weight = (place.square() * rule.exponent as f32).exp() * rule.weight as f32;
    let xi = place * rule.step as f32;
    let away = sd * xi;
    let found = b.call(part, (mean + away, narrow, &parameters));
    let by_place = xi * (1.0 / sd);
    let hermite = xi.square() * (1.0 / rule.variance) as f32 + -1.0;
    for i in 0..components {
        let [centre, slope, _] = std::array::from_fn(|k| middle[3 * i + k]);
        let [level, steep, rest] = std::array::from_fn(|k| found[3 * i + k]);
        // r and a.
        let beyond = level - centre - slope * away;
        let turned = steep - slope;
        let terms = [
            beyond,
            turned * (rule.tau * rule.tau) as f32 + beyond * by_place,
            rest + beyond.square() + (turned * narrow).square(),
            turned * xi,
            turned * hermite,
        ];
        for (k, term) in (SUMS * i..).zip(terms) {
            b.result(format!("sum_{k}"), sums[k] + term * weight);
        }
    }
    b.finish(module)
}

impl<'b> Transfer<'b> for Tapped<'b> {
    fn value(&self, x: Float<'b>) -> Float<'b> {
        x.builder().call(&self.value, (x, &self.parameters))[self.component]
    }

    fn moments(&self, x: &Gaussian<'b>) -> Moments<'b> {
        let all = (x.mean.builder()).call(&self.moments, (x.mean, x.sd, &self.parameters));
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

    fn range(&self, _: [f32; 2]) -> [f32; 2] {
        self.range
    }
}
