//! Numbers in every cell of a line, filtered by a Gaussian.
//!
//! A cell weighs what of the Gaussian lies in it, so that means, slopes and covariances are sums over
//! the cells of a window, as in the plane; what does not fit fades to what cells have on average.

use super::{REACH, around, coincidence, counted, deviation, fading, inside, report};
use mipless_codegen::ir::{Bool, Builder, Float, FunctionRef, Int, Module, Scalar, Scalars};
use mipless_codegen::moments::{Mode, Normal, Signal};
use mipless_codegen::{Ensemble, Lower, pairs};

/// The numbers of a cell of a line, from its index and the parameters.
pub(crate) type Numbers<'a> = &'a dyn for<'c> Fn(Int<'c>, &[Scalar<'c>]) -> Vec<Float<'c>>;

/// What stands in the cells of a line.
pub(crate) struct Line<'a, 'b> {
    /// Names what the numbers depend on beyond the parameters.
    pub(crate) key: String,
    /// The numbers that shape those of the cells.
    pub(crate) parameters: Vec<Scalar<'b>>,
    /// The numbers of a cell.
    pub(crate) numbers: Numbers<'a>,
    /// Those of all cells, where the condition says that they are wanted.
    pub(crate) ensemble: &'a dyn Fn(&mut Lower<'_, 'b>, Bool<'b>) -> Ensemble<'b>,
    /// How many cells are summed at most.
    pub(crate) most: f32,
    /// The standard deviation, in cells, of what is rounding of the place beyond its response to the
    /// position.
    pub(crate) rounding: f32,
}

/// Sums over the cells of a line, d being the numbers less those at the centre: the state of a fold.
#[derive(Clone, Debug)]
pub(super) struct Sums<'b> {
    /// Φ and φ at the last edge.
    below: Float<'b>,
    density: Float<'b>,
    /// Σ P.
    weight: Float<'b>,
    /// Σ P dᵢ.
    first: Vec<Float<'b>>,
    /// Σ P dᵢdₖ, in the order of [`pairs`].
    second: Vec<Float<'b>>,
    /// Σ (φ₀ − φ₁) dᵢ.
    slope: Vec<Float<'b>>,
}

impl<'b> Scalars<'b> for Sums<'b> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        (self.below, self.density, self.weight).each(visit);
        [&self.first, &self.second, &self.slope].each(visit);
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        let (below, density, weight) = (self.below, self.density, self.weight).replaced(next);
        let [first, second, slope] = [self.first, self.second, self.slope].replaced(next);
        Self {
            below,
            density,
            weight,
            first,
            second,
            slope,
        }
    }
}

impl<'b> Sums<'b> {
    /// The names of the parts.
    fn names(channels: usize) -> impl Iterator<Item = String> {
        let of = move |name: &'static str, count: usize| {
            (0..count).map(move |i| match channels {
                1 => name.to_owned(),
                _ => format!("{name}_{i}"),
            })
        };
        (["below", "density", "weight"]
            .into_iter()
            .map(str::to_owned))
        .chain(of("first", channels))
        .chain(of("second", pairs(channels).count()))
        .chain(of("slope", channels))
    }

    fn zero(b: &'b Builder, channels: usize) -> Self {
        let zero = b.float(0.0);
        Self {
            below: zero,
            density: zero,
            weight: zero,
            first: vec![zero; channels],
            second: vec![zero; pairs(channels).count()],
            slope: vec![zero; channels],
        }
    }

    /// The parameters of the body of a fold.
    pub(super) fn declare(b: &'b Builder, channels: usize) -> Self {
        let mut names = Self::names(channels);
        let mut next = || names.next().expect("a name for each part");
        Self::zero(b, channels).replaced(&mut || b.float_param(next()).into())
    }

    /// Gives them as the results of the body of a fold.
    pub(super) fn results(&self, b: &'b Builder) {
        b.results(Self::names(self.first.len()), self.scalars());
    }

    /// The state before the first cell, whose lower edge is at a distance from the mean.
    pub(super) fn start([distance, inverse]: [Float<'b>; 2], channels: usize) -> Self {
        let n = Normal::at(distance, inverse);
        Self {
            below: n.below,
            density: n.density,
            ..Self::zero(distance.builder(), channels)
        }
    }

    /// The state after a cell whose upper edge is at a distance from the mean.
    pub(super) fn after(self, [distance, inverse]: [Float<'b>; 2], d: &[Float<'b>]) -> Self {
        let n = Normal::at(distance, inverse);
        let p = (n.below - self.below).max(0.0);
        let change = self.density - n.density;
        let pairs = pairs(d.len()).map(|(i, k)| p * d[i] * d[k]);
        Self {
            below: n.below,
            density: n.density,
            weight: self.weight + p,
            first: added(self.first, d.iter().map(|&d| p * d)),
            second: added(self.second, pairs),
            slope: added(self.slope, d.iter().map(|&d| change * d)),
        }
    }

    /// The sums of d, of its products and of the slopes, over the sum of the weights.
    pub(super) fn averages(self) -> [Vec<Float<'b>>; 3] {
        let scale = 1.0 / self.weight.max(1e-6);
        [self.first, self.second, self.slope]
            .map(|sums| sums.into_iter().map(|sum| sum * scale).collect())
    }
}

/// Each sum with its part.
fn added<'b>(sums: Vec<Float<'b>>, parts: impl Iterator<Item = Float<'b>>) -> Vec<Float<'b>> {
    sums.into_iter()
        .zip(parts)
        .map(|(sum, part)| sum + part)
        .collect()
}

/// The filtered numbers at a place on the line, in cells.
pub(crate) fn filtered<'b>(
    lower: &mut Lower<'_, 'b>,
    place: &Signal<'b>,
    line: &Line<'_, 'b>,
) -> Vec<Signal<'b>> {
    let (mode, b) = (lower.mode(), lower.b());
    lower.algebra.bent = true;
    if let Some(values) = place.binary.filter(|_| mode.spreads()) {
        return between(place, line, values);
    }
    let (cell, x) = place.place();
    let centre = (line.numbers)(cell + x.floor().to_int(), &line.parameters);
    let channels = centre.len();
    if mode == Mode::Point || place.is_certain() {
        return centre.into_iter().map(Signal::certain).collect();
    }
    let place = &sound(place, line.rounding);
    let variance = place.variance().min(WIDEST * WIDEST);
    let [sd, inverse] = deviation(variance);
    report(lower, sd);

    // The sums over the window.
    let key = format!("cells of a line {}", line.key);
    let body = lower.function(&key, |module| one_more(module, channels, line));
    // A whole number is no face between two steps, but the second's.
    let x = match line.rounding {
        0.0 => inside(x, variance),
        _ => x,
    };
    let [start, count] = around(x, sd * REACH, line.most);
    let fade = fading(sd, line.most);
    let before = Sums::start([start - x, inverse], channels);
    let captures = (start, x, inverse, cell, &centre, &line.parameters);
    let sums = b.fold(&body, counted(count, fade), before, captures);
    let [first, second, slopes] = sums.averages();
    let Ensemble { means, covariance } = (line.ensemble)(lower, fade.lt(1.0));

    // M = μ + fade (v₀ + m₁ − μ).
    let carries = matches!(mode, Mode::Local | Mode::Quad);
    let responses: Vec<Float<'b>> = slopes
        .iter()
        .map(|&slope| slope * (inverse * fade))
        .collect();
    let mut signals: Vec<Signal<'b>> = (0..channels)
        .map(|i| {
            let mean = (centre[i] + first[i] - means[i]) * fade + means[i];
            let signal = Signal::certain(mean);
            if !carries {
                return signal;
            }
            Signal {
                mean,
                cell: None,
                slope: None,
                ..signal + place * responses[i]
            }
        })
        .collect();
    if !mode.spreads() {
        return signals;
    }
    let lost = 1.0 - coincidence(variance) * fade;
    let rest: Vec<Float<'b>> = (pairs(channels).zip(second).zip(covariance))
        .map(|(((i, k), second), ensemble)| {
            if !carries {
                return lost * ensemble;
            }
            let own = second - first[i] * first[k];
            let left = own - responses[i] * responses[k] * variance;
            let left = if i == k { left.max(0.0) } else { left };
            left * fade + ensemble * (1.0 - fade)
        })
        .collect();
    match &mut signals[..] {
        [signal] => lower.algebra.attach_fresh(signal, rest[0]),
        signals => lower.algebra.attach_joint(signals, &rest),
    }
    signals
}

/// Positions spread over more than this are spread over it.
const WIDEST: f32 = 1.0e4;

/// The rounding of steps of 1/4096: patterns that are within 1e-6 of their number have a remainder of
/// 3e-4.
pub(crate) const ROUNDING: f32 = 2.0;

/// The place without its roundings.
fn sound<'b>(place: &Signal<'b>, rounding: f32) -> Signal<'b> {
    let other = place.other_variance();
    if other.is_zero() || rounding == 0.0 {
        return place.clone();
    }
    let least = rounding * rounding;
    let share = (other - least).max(0.0) / other.max(least);
    let root = share.sqrt();
    let mut out = place.clone();
    out.h = out.h * root;
    for (_, coefficient) in &mut out.shared {
        *coefficient *= root;
    }
    out.private *= share;
    out
}

/// Of a place that is one of two: each number is one of two, and what is linear in the place.
fn between<'b>(
    place: &Signal<'b>,
    line: &Line<'_, 'b>,
    [low, high]: [Float<'b>; 2],
) -> Vec<Signal<'b>> {
    let [of_low, of_high] =
        [low, high].map(|at| (line.numbers)(at.floor().to_int(), &line.parameters));
    let span = high - low;
    let apart = span.gt(0.0) | span.lt(0.0);
    let share = place.offset(-low) * (1.0 / apart.select(span, 1.0));
    (of_low.into_iter().zip(of_high))
        .map(|(from, to)| (&share * (to - from)).offset(from))
        .collect()
}

/// One more cell, the body of a fold.
fn one_more(module: &mut Module, channels: usize, line: &Line<'_, '_>) -> FunctionRef {
    let b = &Builder::new("line_cell", "One more cell of a line.");
    let index = b.uint_param("index");
    let sums = Sums::declare(b, channels);
    let [start, mean, inverse] = b.float_params(["start", "mean", "inverse_sd"]);
    let cell = b.int_param("cell");
    let floats = |name: &str, count: usize| -> Vec<Float<'_>> {
        (0..count)
            .map(|i| b.float_param(format!("{name}_{i}")))
            .collect()
    };
    let centre = floats("centre", channels);
    let declared =
        |(i, of): (usize, &Scalar<'_>)| b.scalar_param(format!("parameter_{i}"), of.ty());
    let parameters: Vec<Scalar<'_>> = line.parameters.iter().enumerate().map(declared).collect();
    let place = start + index.to_float();
    let numbers = (line.numbers)(cell + place.to_int(), &parameters);
    let d: Vec<Float<'_>> = (numbers.iter().zip(&centre))
        .map(|(&number, &centre)| number - centre)
        .collect();
    sums.after([place + 1.0 - mean, inverse], &d).results(b);
    b.finish(module)
}
