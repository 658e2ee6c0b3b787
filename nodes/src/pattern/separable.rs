//! Sums of products of pulses, one factor a coordinate, over a footprint that may be rotated.
//!
//! The two coordinates are Gaussians of covariance c. The mean of a product of functions of them is
//! Σ ρⁿ σ₁ⁿσ₂ⁿ/n! A⁽ⁿ⁾B⁽ⁿ⁾ with A and B the means of the factors and ρ = |c|/(σ₁σ₂) (Mehler), of which
//! four terms are within 1e-3 up to ρ = ½. Of a larger one r is taken apart: the coordinates are
//! m + w t + √(1 − r) (σ₁ε₁, ±σ₂ε₂), w = √r (σ₁, ±σ₂), with a standard t and with ε₁ and ε₂ of the
//! correlation ½. What is left is one integral over t of a function that is smooth at the scale
//! √((1 − r)/r): three nodes to r = 0.15, then the trapezoid rule at 1.6 of it, within ±3.7. Where the
//! rest alone covers the unit cell, one node is enough.
//!
//! Correlations are limited to [`MOST_CORRELATED`]: 10:1 at 45 degrees. A longer footprint keeps its
//! spread along both coordinates and is blurred across.

use super::pulse::{Axis, Pulse, Series};
use crate::noise::field::{Field, Spread};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::{Mode, Signal};
use std::fmt::Write as _;

/// The largest correlation of the coordinates that is followed.
const MOST_CORRELATED: f32 = 0.981;

/// The largest correlation whose effect is expanded.
const EXPANDED: f32 = 0.5;

/// How much of a correlation three nodes suffice for.
const THREE_NODES: f32 = 0.15;

/// Nodes are at most this far from each other, in standard deviations of t.
const WIDEST_STEP: f32 = 1.6;

/// … and in the scale at which the function of t is smooth.
const SMOOTH_STEP: f32 = 1.6;

/// From this standard deviation on, in unit cells, a coordinate leaves its mean of every pulse: the first
/// harmonic has 1.6e-3 left.
const SETTLED: f32 = 0.55;

/// Where the integral over t ends.
const REACH: f32 = 3.7;

/// A coefficient times at most one pulse a coordinate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Term {
    /// The coefficient.
    pub(crate) coefficient: f32,
    /// The factor of the first coordinate, else 1.
    pub(crate) x: Option<Pulse>,
    /// The factor of the second coordinate, else 1.
    pub(crate) y: Option<Pulse>,
}

impl Term {
    /// The product of two pulses.
    pub(crate) fn product(x: Pulse, y: Pulse) -> Self {
        Self {
            coefficient: 1.0,
            x: Some(x),
            y: Some(y),
        }
    }

    /// `by` times the same.
    pub(crate) fn times(self, by: f32) -> Self {
        Self {
            coefficient: self.coefficient * by,
            ..self
        }
    }
}

/// A constant and terms whose sum is a function on the unit cell, from parameters.
pub(crate) type Terms<'a> = &'a dyn Fn(&mut Builder, &[Value]) -> (f32, Vec<Term>);

/// A pattern with values in [0, 1].
pub(crate) struct Pattern<'a> {
    /// Names what the terms depend on beyond the parameters.
    pub(crate) key: String,
    /// The numbers that shape the pulses.
    pub(crate) parameters: Vec<Value>,
    /// A constant and terms of the unit cell, from the parameters.
    pub(crate) terms: Terms<'a>,
    /// The terms of the square of the pattern, where edges are ramps, and the width of the ramps in
    /// units of each coordinate.
    pub(crate) soft: Option<Soft<'a>>,
}

/// What a pattern with ramps says of itself.
pub(crate) struct Soft<'a> {
    /// A constant and terms whose sum has the mean of the pattern's square.
    pub(crate) squares: Terms<'a>,
    /// The width of the ramps along each coordinate.
    pub(crate) width: [Value; 2],
}

/// A coordinate modulo 1.
pub(crate) fn phase(b: &mut Builder, coordinate: &Signal) -> Value {
    match coordinate.cell {
        Some(_) => coordinate.mean,
        None => {
            let whole = b.floor(coordinate.mean);
            b.sub(coordinate.mean, whole)
        }
    }
}

/// The pattern at a position in unit cells, as a signal.
pub(crate) fn filtered(
    lower: &mut Lower<'_>,
    position: &[Signal; 2],
    pattern: &Pattern<'_>,
) -> Signal {
    let mode = lower.mode();
    let b = lower.b();
    let [x, y] = [0, 1].map(|i| phase(b, &position[i]));
    let certain = position.iter().all(|axis| axis.is_certain(b));
    let sharp = pattern.soft.is_none();
    if mode == Mode::Point || certain {
        let (constant, terms) = (pattern.terms)(b, &pattern.parameters);
        let value = point(b, constant, &terms, [x, y]);
        return finished(lower, value, sharp);
    }
    let spread = Spread::of(b, position);
    let taps = Taps::of(b, spread.covariance).of_periodic(b);
    let constants: Vec<Option<f32>> = (pattern.parameters.iter())
        .map(|&v| b.as_constant(v))
        .collect();
    let mut key = format!("pattern {} {mode:?}", pattern.key);
    for constant in &constants {
        // Writing to a string cannot fail.
        let _ = write!(key, " {constant:?}");
    }
    let orders = orders(mode) + usize::from(!sharp && mode.spreads());
    let tap = lower.function(&key, |module| tap(module, mode, pattern, &constants));
    let b = lower.b();
    let zero = b.f32(0.0);
    let mut captures = vec![x, y];
    captures.extend(taps.captures());
    captures.extend(
        (pattern.parameters.iter().zip(&constants))
            .filter(|(_, constant)| constant.is_none())
            .map(|(&value, _)| value),
    );
    let sums = b.fold(&tap, taps.count, &vec![zero; orders + 1], &captures);
    let one = b.f32(1.0);
    let inverse = b.div(one, sums[0]);
    let mut at = |i: usize| {
        if i < orders {
            b.mul(sums[i + 1], inverse)
        } else {
            zero
        }
    };
    let derivatives = usize::from(matches!(mode, Mode::Local | Mode::Quad));
    let curvatures = usize::from(mode == Mode::Quad);
    let pick = |on: usize, i: usize| if on == 1 { i } else { usize::MAX };
    let field = Field {
        mean: at(0),
        gradient: [1, 2].map(|i| at(pick(derivatives, i))),
        hessian: [3, 4, 5].map(|i| at(pick(curvatures, i))),
        rest: zero,
    };
    let square = (!sharp && mode.spreads()).then(|| at(orders - 1));
    let b = lower.b();
    let mean = b.clamp(field.mean, 0.0, 1.0);
    let mut field = Field { mean, ..field };
    if mode.spreads() {
        field.rest = match (square, &pattern.soft) {
            (Some(square), Some(soft)) => rest_of_ramps(b, &mut field, &spread, square, soft.width),
            _ => rest_of_two(b, &mut field, &spread),
        };
    }
    let signal = field.at(lower, position);
    finished_signal(lower, signal, sharp)
}

fn finished(lower: &mut Lower<'_>, value: Value, sharp: bool) -> Signal {
    let signal = Signal::certain(lower.b(), value);
    finished_signal(lower, signal, sharp)
}

/// A sharp pattern takes two values, and every pattern bends.
pub(crate) fn finished_signal(lower: &mut Lower<'_>, signal: Signal, sharp: bool) -> Signal {
    lower.algebra.bent = true;
    let b = lower.b();
    let binary = (sharp && !signal.is_certain(b)).then(|| [0.0, 1.0].map(|x| b.f32(x)));
    Signal {
        binary,
        ..signal.with_range([0.0, 1.0])
    }
}

/// What the response of a field to the footprint leaves of a variance: Var − |g|² − ½‖H‖², at least 0.
/// A Hessian that claims more than its share, as one of a truncated series may, is made smaller.
pub(crate) fn rest(b: &mut Builder, field: &mut Field, spread: &Spread, variance: Value) -> Value {
    let [xx, xy, yy] = spread.covariance;
    let [dx, dy] = field.gradient;
    let (px, py) = (b.dot(&[xx, xy], &[dx, dy]), b.dot(&[xy, yy], &[dx, dy]));
    let linear = b.dot(&[dx, dy], &[px, py]);
    let rest = b.sub(variance, linear);
    let zero = b.f32(0.0);
    let rest = b.max(rest, zero);
    let [h11, h12, h22] = field.hessian;
    if b.is_zero(h11) && b.is_zero(h12) && b.is_zero(h22) {
        return rest;
    }
    // ½ tr (HΣ)².
    let (a, d) = (b.dot(&[h11, h12], &[xx, xy]), b.dot(&[h12, h22], &[xy, yy]));
    let (p, q) = (b.dot(&[h11, h12], &[xy, yy]), b.dot(&[h12, h22], &[xx, xy]));
    let (a, d, pq) = (b.square(a), b.square(d), b.mul(p, q));
    let trace = b.add(a, d);
    let trace = b.scale(trace, 0.5);
    let trace = b.add(trace, pq);
    let least = b.f32(1e-30);
    let claimed = b.max(trace, least);
    let share = b.div(rest, claimed);
    let one = b.f32(1.0);
    let share = b.min(share, one);
    let by = b.sqrt(share);
    field.hessian = field.hessian.map(|h| b.mul(h, by));
    let rest = b.sub(rest, trace);
    b.max(rest, zero)
}

/// The same of a pattern that is 0 or 1, whose variance is P(1 − P).
pub(crate) fn rest_of_two(b: &mut Builder, field: &mut Field, spread: &Spread) -> Value {
    let one = b.f32(1.0);
    let other = b.sub(one, field.mean);
    let variance = b.mul(field.mean, other);
    rest(b, field, spread, variance)
}

/// The same of a pattern with ramps, from the mean of its square: no more than the ramps' linear
/// response is left while the footprint lies within them.
fn rest_of_ramps(
    b: &mut Builder,
    field: &mut Field,
    spread: &Spread,
    square: Value,
    [wide, high]: [Value; 2],
) -> Value {
    let squared = b.square(field.mean);
    let variance = b.sub(square, squared);
    let rest = rest(b, field, spread, variance);
    // 1 − (1 − f₁)(1 − f₂) with f = σ²/(σ² + (0.4 w)²).
    let share = |b: &mut Builder, variance: Value, width: Value| {
        let square = b.square(width);
        let square = b.scale(square, 0.16);
        let sum = b.add(variance, square);
        let sum = b.offset(sum, 1e-12);
        b.div(square, sum)
    };
    let [xx, _, yy] = spread.covariance;
    let (left, right) = (share(b, xx, wide), share(b, yy, high));
    let within = b.mul(left, right);
    let one = b.f32(1.0);
    let beyond = b.sub(one, within);
    b.mul(rest, beyond)
}

pub(super) fn orders(mode: Mode) -> usize {
    match mode {
        Mode::Point | Mode::Naive | Mode::Ensemble => 1,
        Mode::Local => 3,
        Mode::Quad => 6,
    }
}

fn point(b: &mut Builder, constant: f32, terms: &[Term], at: [Value; 2]) -> Value {
    let mut sum = b.f32(constant);
    for term in terms {
        let mut product = b.f32(term.coefficient);
        for (pulse, x) in [term.x, term.y].into_iter().zip(at) {
            if let Some(pulse) = pulse {
                let value = pulse.value(b, x);
                product = b.mul(product, value);
            }
        }
        sum = b.add(sum, product);
    }
    sum
}

/// The nodes of the integral over t.
pub(crate) struct Taps {
    /// w.
    pub(crate) along: [Value; 2],
    /// The standard deviations that are left, at least 1e-6.
    pub(crate) sd: [Value; 2],
    /// Their correlation.
    pub(crate) correlation: Value,
    /// The first node.
    pub(crate) start: Value,
    /// From a node to the next.
    pub(crate) step: Value,
    /// How many, as u32.
    pub(crate) count: Value,
}

impl Taps {
    /// The nodes for this covariance.
    pub(crate) fn of(b: &mut Builder, [xx, xy, yy]: [Value; 3]) -> Self {
        let (one, zero) = (b.f32(1.0), b.f32(0.0));
        let [sx, sy] = [xx, yy].map(|v| {
            let v = b.offset(v, 1e-12);
            b.sqrt(v)
        });
        let both = b.mul(sx, sy);
        let magnitude = b.abs(xy);
        let rho = b.div(magnitude, both);
        let most = b.f32(MOST_CORRELATED);
        let rho = b.min(rho, most);
        let expanded = b.f32(EXPANDED);
        let kept = b.min(rho, expanded);
        let (beyond, rest) = (b.sub(rho, kept), b.sub(one, kept));
        let shared = b.div(beyond, rest);
        let left = b.sub(one, shared);
        let (root, root_left) = (b.sqrt(shared), b.sqrt(left));
        let negative = b.lt(xy, zero);
        let minus = b.f32(-1.0);
        let sign = b.select(negative, minus, one);
        let sd = [sx, sy].map(|s| b.mul(s, root_left));
        // 1/step² = 1/1.6² + r/(1.6² (1 − r)).
        let ratio = b.div(shared, left);
        let ratio = b.scale(ratio, 1.0 / (SMOOTH_STEP * SMOOTH_STEP));
        let inverse = b.offset(ratio, 1.0 / (WIDEST_STEP * WIDEST_STEP));
        let inverse = b.sqrt(inverse);
        // One node is always in the middle: as the footprint turns, nodes come and go where their
        // weight is next to nothing.
        let half = b.scale(inverse, REACH);
        let half = b.floor(half);
        // Three nodes at the distance that gives them the variance 1 have nearly the weights of
        // Gauss–Hermite.
        let few = b.f32(THREE_NODES);
        let few = b.lt(shared, few);
        let (three, inverse_three) = (b.f32(1.039_3), b.f32(1.0 / 3f32.sqrt()));
        let half = b.select(few, one, half);
        let inverse = b.select(few, inverse_three, inverse);
        let stretch = b.select(few, three, one);
        let along = b.mul(root, stretch);
        let (wx, wy) = (b.mul(along, sx), b.mul(along, sy));
        let wy = b.mul(sign, wy);
        // Without a shared part there is nothing to integrate.
        let alone = b.le(shared, zero);
        let half = b.select(alone, zero, half);
        let step = b.div(one, inverse);
        let start = b.mul(half, step);
        let start = b.neg(start);
        let count = b.scale(half, 2.0);
        let count = b.offset(count, 1.0);
        let count = b.trunc_i(count);
        let count = b.cast_u(count);
        Self {
            along: [wx, wy],
            sd,
            correlation: b.mul(sign, kept),
            start,
            step,
            count,
        }
    }

    /// The same for a function that repeats after 1 along both coordinates: where what is left of both
    /// covers it, one node is all.
    fn of_periodic(self, b: &mut Builder) -> Self {
        let settled = b.f32(SETTLED);
        let [x, y] = self.sd.map(|sd| b.lt(settled, sd));
        let both = b.and(x, y);
        let (zero, once) = (b.f32(0.0), b.u32(1));
        Self {
            start: b.select(both, zero, self.start),
            count: b.select(both, once, self.count),
            ..self
        }
    }

    /// The numbers that the body of the fold takes, by [`Self::NAMES`].
    pub(crate) fn captures(&self) -> [Value; 7] {
        let ([wx, wy], [sx, sy]) = (self.along, self.sd);
        [wx, wy, sx, sy, self.start, self.step, self.correlation]
    }

    /// Names of the captures.
    pub(crate) const NAMES: [&str; 7] = [
        "along_x",
        "along_y",
        "sd_x",
        "sd_y",
        "start",
        "step",
        "correlation",
    ];

    /// Inside the body: the two coordinates at this node, and the node's weight.
    pub(crate) fn node(
        b: &mut Builder,
        index: Value,
        [x, y]: [Value; 2],
        captures: [Value; 7],
    ) -> ([Axis; 2], Value) {
        let [wx, wy, sx, sy, start, step, _] = captures;
        let number = b.float_u(index);
        let t = b.mul(number, step);
        let t = b.add(start, t);
        let square = b.square(t);
        let exponent = b.scale(square, -0.5);
        let weight = b.exp(exponent);
        let axes = [(x, wx, sx), (y, wy, sy)].map(|(mean, along, sd)| {
            let shift = b.mul(along, t);
            let mean = b.add(mean, shift);
            Axis { mean, sd }
        });
        (axes, weight)
    }
}

/// One node of the integral, the body of a fold: weights, then the weighted mean and derivatives,
/// then the mean of the square.
fn tap(
    module: &mut Module,
    mode: Mode,
    pattern: &Pattern<'_>,
    constants: &[Option<f32>],
) -> FunctionRef {
    let soft = pattern.soft.as_ref().filter(|_| mode.spreads());
    let orders = orders(mode);
    let doc = "A pattern at one place of the footprint, averaged over what is left of it.";
    let name: String = (pattern.key.chars())
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .collect();
    let mut b = Builder::new(format!("{name}_tap"), doc);
    let index = b.param("index", Type::U32);
    let total = b.param_f32("weights");
    let sums: Vec<Value> = (0..orders + usize::from(soft.is_some()))
        .map(|i| b.param_f32(format!("sum_{i}")))
        .collect();
    let place = [b.param_f32("x"), b.param_f32("y")];
    let captures = Taps::NAMES.map(|name| b.param_f32(name));
    let mut parameters = Vec::new();
    for (i, constant) in constants.iter().enumerate() {
        parameters.push(match constant {
            Some(x) => b.f32(*x),
            None => b.param_f32(format!("parameter_{i}")),
        });
    }
    let (axes, weight) = Taps::node(&mut b, index, place, captures);
    let (constant, terms) = (pattern.terms)(&mut b, &parameters);
    let [.., correlation] = captures;
    let of = (axes, correlation);
    let mut series = Series::default();
    let mut parts = averaged(
        &mut b,
        (module, &mut series),
        (constant, &terms),
        of,
        orders,
    );
    if let Some(soft) = soft {
        let (constant, terms) = (soft.squares)(&mut b, &parameters);
        let of_square = (constant, &terms[..]);
        parts.extend(averaged(&mut b, (module, &mut series), of_square, of, 1));
    }
    let total = b.add(total, weight);
    b.result("weights", total);
    for (i, (&sum, part)) in sums.iter().zip(parts).enumerate() {
        let part = b.mul(weight, part);
        let sum = b.add(sum, part);
        b.result(format!("sum_{i}"), sum);
    }
    b.finish(module)
}

/// The mean of the terms over two coordinates, and as many derivatives as are asked for: ∂x, ∂y, ∂xx,
/// ∂xy, ∂yy.
fn averaged(
    b: &mut Builder,
    (module, series): (&mut Module, &mut Series),
    (constant, terms): (f32, &[Term]),
    (axes, correlation): ([Axis; 2], Value),
    orders: usize,
) -> Vec<Value> {
    let zero = b.f32(0.0);
    let mut out = vec![zero; orders];
    out[0] = b.f32(constant);
    for term in terms {
        let [x, y] = [(term.x, axes[0]), (term.y, axes[1])].map(|(pulse, axis)| match pulse {
            Some(pulse) => pulse.moments(b, (&mut *module, &mut *series), axis),
            None => [b.f32(1.0), zero, zero, zero],
        });
        let x = x.map(|v| b.scale(v, term.coefficient));
        for (sum, part) in out.iter_mut().zip(joined(b, x, y, correlation)) {
            *sum = b.add(*sum, part);
        }
    }
    by_place(b, &mut out, axes.map(|axis| axis.sd));
    out
}

/// The mean of a product of functions of two Gaussians and its derivatives, each times as many σ, from
/// those of the factors: the first four terms of Mehler's series, as far as third derivatives go.
pub(super) fn joined(
    b: &mut Builder,
    x: [Value; 4],
    y: [Value; 4],
    correlation: Value,
) -> [Value; 6] {
    let square = b.square(correlation);
    let cube = b.mul(square, correlation);
    let (half, sixth) = (b.scale(square, 0.5), b.scale(cube, 1.0 / 6.0));
    let series = [b.f32(1.0), correlation, half, sixth];
    // The series of y's derivatives of order k.
    let [value, slope, bend] = [0, 1, 2].map(|k| {
        let terms = series.iter().zip(&y[k..]);
        terms.map(|(&c, &y)| b.mul(c, y)).collect::<Vec<Value>>()
    });
    [
        b.dot(&x, &value),
        b.dot(&x[1..], &value),
        b.dot(&x, &slope),
        b.dot(&x[2..], &value),
        b.dot(&x[1..], &slope),
        b.dot(&x, &bend),
    ]
}

/// Derivatives times σ as derivatives.
pub(super) fn by_place(b: &mut Builder, parts: &mut [Value], sd: [Value; 2]) {
    let one = b.f32(1.0);
    let [x, y] = sd.map(|sd| b.div(one, sd));
    let factors = [x, y, b.square(x), b.mul(x, y), b.square(y)];
    for (part, factor) in parts.iter_mut().skip(1).zip(factors) {
        *part = b.mul(*part, factor);
    }
}
