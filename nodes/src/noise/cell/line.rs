//! Numbers in every cell of a line, filtered by a Gaussian.
//!
//! A cell weighs what of the Gaussian lies in it, so that means, slopes and covariances are sums over
//! the cells of a window, as in the plane; what does not fit fades to what cells have on average.

use super::{coincidence, counted, fading, report, split, window};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::{Mode, Normal, Signal};

/// The numbers of a cell of a line, from its index and the parameters.
pub(crate) type Numbers<'a> = &'a dyn Fn(&mut Builder, Value, &[Value]) -> Vec<Value>;

/// What the numbers of all cells have in common.
pub(crate) struct Ensemble {
    /// Their means.
    pub(crate) means: Vec<Value>,
    /// The rows of the lower triangle of their covariance.
    pub(crate) covariance: Vec<Value>,
}

/// What stands in the cells of a line.
pub(crate) struct Line<'a> {
    /// Names what the numbers depend on beyond the parameters.
    pub(crate) key: String,
    /// The numbers that shape those of the cells.
    pub(crate) parameters: Vec<Value>,
    /// The numbers of a cell.
    pub(crate) numbers: Numbers<'a>,
    /// Those of all cells, where the condition says that they are wanted.
    pub(crate) ensemble: &'a dyn Fn(&mut Lower<'_>, Value) -> Ensemble,
}

/// Pairs of channels, in the order of the lower triangle of a matrix.
fn pairs(channels: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..channels).flat_map(|i| (0..=i).map(move |k| (i, k)))
}

/// Sums over the cells of a line: Φ and φ at the last edge, then Σ P, Σ P dᵢ, Σ P dᵢdₖ and
/// Σ (φ₀ − φ₁) dᵢ, d being the numbers less those at the centre.
pub(super) struct Sums {
    channels: usize,
}

impl Sums {
    pub(super) fn of(channels: usize) -> Self {
        Self { channels }
    }

    /// The names of the state of a fold.
    pub(super) fn names(&self) -> Vec<String> {
        let n = self.channels;
        let mut names = ["below", "density", "weight"].map(str::to_owned).to_vec();
        let of = |name: &str, count: usize| -> Vec<String> {
            (0..count)
                .map(|i| {
                    if n == 1 {
                        name.to_owned()
                    } else {
                        format!("{name}_{i}")
                    }
                })
                .collect()
        };
        names.extend(of("first", n));
        names.extend(of("second", n * (n + 1) / 2));
        names.extend(of("slope", n));
        names
    }

    /// The state before the first cell, whose lower edge is at a distance from the mean.
    pub(super) fn start(&self, b: &mut Builder, distance: Value, inverse: Value) -> Vec<Value> {
        let n = Normal::at(b, distance, inverse);
        let zero = b.f32(0.0);
        let mut state = vec![zero; self.names().len()];
        (state[0], state[1]) = (n.below, n.density);
        state
    }

    /// The state after a cell whose upper edge is at a distance from the mean.
    pub(super) fn after(
        &self,
        b: &mut Builder,
        state: &[Value],
        [distance, inverse]: [Value; 2],
        d: &[Value],
    ) -> Vec<Value> {
        let n = Normal::at(b, distance, inverse);
        let p = b.sub(n.below, state[0]);
        let zero = b.f32(0.0);
        let p = b.max(p, zero);
        let change = b.sub(state[1], n.density);
        let mut parts = vec![p];
        let first: Vec<Value> = d.iter().map(|&d| b.mul(p, d)).collect();
        parts.extend(&first);
        parts.extend(pairs(d.len()).map(|(i, k)| b.mul(first[i], d[k])));
        parts.extend(d.iter().map(|&d| b.mul(change, d)));
        let mut next = vec![n.below, n.density];
        next.extend(
            state[2..]
                .iter()
                .zip(parts)
                .map(|(&sum, part)| b.add(sum, part)),
        );
        next
    }
}

/// The filtered numbers at a place on the line, in cells.
pub(crate) fn filtered(lower: &mut Lower<'_>, place: &Signal, line: &Line<'_>) -> Vec<Signal> {
    let mode = lower.mode();
    lower.algebra.bent = true;
    let b = lower.b();
    if let Some([low, high]) = place.binary.filter(|_| mode.spreads()) {
        return between(b, place, line, [low, high]);
    }
    let [cell, x] = split(b, place);
    let inner = b.floor(x);
    let inner = b.trunc_i(inner);
    let centre = b.add_i(cell, inner);
    let centre = (line.numbers)(b, centre, &line.parameters);
    let channels = centre.len();
    if mode == Mode::Point || place.is_certain(b) {
        return centre.into_iter().map(|v| Signal::certain(b, v)).collect();
    }
    let place = &sound(b, place);
    let variance = place.variance(b);
    let widest = b.f32(WIDEST * WIDEST);
    let variance = b.min(variance, widest);
    let raised = b.offset(variance, 1e-12);
    let (sd, one, zero) = (b.sqrt(raised), b.f32(1.0), b.f32(0.0));
    let inverse = b.div(one, sd);
    report(lower, sd);
    let key = format!("cells of a line {}", line.key);
    let body = lower.function(&key, |module| one_more(module, channels, line));
    let b = lower.b();
    let [start, count] = window(b, x, sd);
    let fade = fading(b, sd);
    let count = counted(b, count, fade);
    let sums = Sums::of(channels);
    let distance = b.sub(start, x);
    let state = sums.start(b, distance, inverse);
    let mut captures = vec![start, x, inverse, cell];
    captures.extend(&centre);
    captures.extend(&line.parameters);
    let state = b.fold(&body, count, &state, &captures);
    let tiny = b.f32(1e-6);
    let total = b.max(state[2], tiny);
    let scale = b.div(one, total);
    let mut parts = state[3..].iter().map(|&sum| b.mul(sum, scale));
    let first: Vec<Value> = parts.by_ref().take(channels).collect();
    let second: Vec<Value> = parts.by_ref().take(channels * (channels + 1) / 2).collect();
    let slopes: Vec<Value> = parts.collect();
    let some = b.lt(fade, one);
    let Ensemble { means, covariance } = (line.ensemble)(lower, some);
    let b = lower.b();
    // M = μ + fade (v₀ + m₁ − μ).
    let carries = matches!(mode, Mode::Local | Mode::Quad);
    let faded = b.mul(inverse, fade);
    let mut signals = Vec::new();
    let mut responses = Vec::new();
    for i in 0..channels {
        let mean = b.add(centre[i], first[i]);
        let mean = b.sub(mean, means[i]);
        let mean = b.mul(mean, fade);
        let mean = b.add(mean, means[i]);
        let mut signal = Signal::certain(b, mean);
        let slope = b.mul(slopes[i], faded);
        if carries {
            let response = place.scale(b, slope);
            signal = Signal {
                mean,
                cell: None,
                ..signal.add(b, &response)
            };
        }
        signals.push(signal);
        responses.push(slope);
    }
    if !mode.spreads() {
        return signals;
    }
    let kept = b.sub(one, fade);
    let same = coincidence(b, variance);
    let same = b.mul(same, fade);
    let lost = b.sub(one, same);
    let rest: Vec<Value> = pairs(channels)
        .zip(second)
        .zip(covariance)
        .map(|(((i, k), second), ensemble)| {
            if !carries {
                return b.mul(lost, ensemble);
            }
            let product = b.mul(first[i], first[k]);
            let own = b.sub(second, product);
            let linear = b.mul(responses[i], responses[k]);
            let linear = b.mul(linear, variance);
            let rest = b.sub(own, linear);
            let rest = if i == k { b.max(rest, zero) } else { rest };
            let near = b.mul(rest, fade);
            let far = b.mul(ensemble, kept);
            b.add(near, far)
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

/// The standard deviation, in cells, of what is rounding beyond the response to the position: patterns
/// that are within 1e-6 of their number have a remainder of 3e-4, which are steps of 1/4096.
const ROUNDING: f32 = 2.0;

/// The place without its roundings.
fn sound(b: &mut Builder, place: &Signal) -> Signal {
    let other = place.other_variance(b);
    if b.is_zero(other) {
        return place.clone();
    }
    let (zero, least) = (b.f32(0.0), b.f32(ROUNDING * ROUNDING));
    let left = b.sub(other, least);
    let left = b.max(left, zero);
    let guarded = b.max(other, least);
    let share = b.div(left, guarded);
    let root = b.sqrt(share);
    let mut out = place.clone();
    out.h = out.h.map(|h| b.mul(h, root));
    for (_, coefficient) in &mut out.shared {
        *coefficient = b.mul(*coefficient, root);
    }
    out.private = b.mul(out.private, share);
    out
}

/// Of a place that is one of two: each number is one of two, and what is linear in the place.
fn between(
    b: &mut Builder,
    place: &Signal,
    line: &Line<'_>,
    [low, high]: [Value; 2],
) -> Vec<Signal> {
    let [of_low, of_high] = [low, high].map(|at| {
        let whole = b.floor(at);
        let cell = b.trunc_i(whole);
        (line.numbers)(b, cell, &line.parameters)
    });
    let (zero, one) = (b.f32(0.0), b.f32(1.0));
    let span = b.sub(high, low);
    let apart = b.lt(zero, span);
    let behind = b.lt(span, zero);
    let apart = b.or(apart, behind);
    let divisor = b.select(apart, span, one);
    let inverse = b.div(one, divisor);
    let start = b.neg(low);
    let share = place.offset(b, start).scale(b, inverse);
    (of_low.into_iter().zip(of_high))
        .map(|(from, to)| {
            let rise = b.sub(to, from);
            share.scale(b, rise).offset(b, from)
        })
        .collect()
}

/// One more cell, the body of a fold.
fn one_more(module: &mut Module, channels: usize, line: &Line<'_>) -> FunctionRef {
    let sums = Sums::of(channels);
    let mut b = Builder::new("line_cell", "One more cell of a line.");
    let index = b.param("index", Type::U32);
    let names = sums.names();
    let state: Vec<Value> = names.iter().map(|name| b.param_f32(name)).collect();
    let [start, mean, inverse] = ["start", "mean", "inverse_sd"].map(|name| b.param_f32(name));
    let cell = b.param("cell", Type::I32);
    let mut floats = |name: &str, count: usize| -> Vec<Value> {
        (0..count)
            .map(|i| b.param_f32(format!("{name}_{i}")))
            .collect()
    };
    let centre = floats("centre", channels);
    let parameters = floats("parameter", line.parameters.len());
    let offset = b.float_u(index);
    let place = b.add(start, offset);
    let edge = b.offset(place, 1.0);
    let distance = b.sub(edge, mean);
    let whole = b.trunc_i(place);
    let cell = b.add_i(cell, whole);
    let numbers = (line.numbers)(&mut b, cell, &parameters);
    let d: Vec<Value> = (numbers.iter().zip(&centre))
        .map(|(&number, &centre)| b.sub(number, centre))
        .collect();
    let next = sums.after(&mut b, &state, [distance, inverse], &d);
    for (name, value) in names.into_iter().zip(next) {
        b.result(name, value);
    }
    b.finish(module)
}
