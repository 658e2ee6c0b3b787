//! Functions of two coordinates that repeat along both, over a footprint that may be rotated.
//!
//! The unit cell is a sum of products of pulses, one factor a coordinate ([`Terms`]), or the bricks of a
//! wall ([`super::wall`]). What the coordinates share is integrated ([`super::taps`]); the rest is
//! averaged in closed form.

use super::harmonics::{Spectrum, declared, unknown};
use super::pulse::{Axis, Moments, Pulse, Series};
use super::taps::{Taps, by_place, joined};
use super::wanted::Wanted;
use crate::noise::field::{Field, Spread};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::{Mode, Signal};
use std::fmt::Write as _;

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

    /// The value at a point.
    pub(crate) fn value(&self, b: &mut Builder, at: [Value; 2]) -> Value {
        let mut product = b.f32(self.coefficient);
        for (pulse, x) in [self.x, self.y].into_iter().zip(at) {
            if let Some(pulse) = pulse {
                let value = pulse.value(b, x);
                product = b.mul(product, value);
            }
        }
        product
    }
}

/// A function of two coordinates that repeats after 1 along both, with values in [0, 1].
pub(crate) trait Cell {
    /// Names what the function depends on beyond the parameters.
    fn key(&self) -> String;

    /// The value at a point.
    fn value(&self, b: &mut Builder, parameters: &[Value], at: [Value; 2]) -> Value;

    /// The mean over two Gaussians and its derivatives (∂x, ∂y, ∂xx, ∂xy, ∂yy) as far as `orders` go;
    /// then, where they are `squared`, the mean of the square.
    fn averaged(
        &self,
        b: &mut Builder,
        module: &mut Module,
        parameters: &[Value],
        place: &Place,
        of: Wanted,
    ) -> Vec<Value>;

    /// Its Fourier series, if it has one that is shorter for wide footprints, from the parameters that are
    /// known.
    fn spectrum(&self, parameters: &[Option<f32>]) -> Option<Spectrum<'_>> {
        let _ = parameters;
        None
    }
}

/// Two Gaussians.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    /// The coordinates.
    pub(crate) axes: [Axis; 2],
    /// Their correlation, of at most ½.
    pub(crate) correlation: Value,
}

/// A constant and terms whose sum is a function on the unit cell, from parameters.
pub(crate) struct Terms<'a> {
    /// Names the terms.
    pub(crate) key: String,
    /// The constant and the terms.
    #[expect(clippy::type_complexity, reason = "one closure")]
    pub(crate) of: &'a dyn Fn(&mut Builder, &[Value]) -> (f32, Vec<Term>),
}

impl Cell for Terms<'_> {
    fn key(&self) -> String {
        self.key.clone()
    }

    fn value(&self, b: &mut Builder, parameters: &[Value], at: [Value; 2]) -> Value {
        let (constant, terms) = (self.of)(b, parameters);
        let mut sum = b.f32(constant);
        for term in terms {
            let part = term.value(b, at);
            sum = b.add(sum, part);
        }
        sum
    }

    fn averaged(
        &self,
        b: &mut Builder,
        module: &mut Module,
        parameters: &[Value],
        place: &Place,
        of: Wanted,
    ) -> Vec<Value> {
        assert!(!of.squared, "the square of a sum has terms of its own");
        let (constant, terms) = (self.of)(b, parameters);
        let mut series = Series::default();
        let zero = b.f32(0.0);
        let mut out = vec![zero; of.orders];
        out[0] = b.f32(constant);
        for term in terms {
            let [x, y] =
                [(term.x, place.axes[0]), (term.y, place.axes[1])].map(
                    |(pulse, axis)| match pulse {
                        Some(pulse) => {
                            let Moments { own, .. } =
                                pulse.moments(b, (&mut *module, &mut series), axis, false);
                            own
                        }
                        None => [b.f32(1.0), zero, zero, zero],
                    },
                );
            let x = x.map(|v| b.scale(v, term.coefficient));
            for (sum, part) in out.iter_mut().zip(joined(b, x, y, place.correlation)) {
                *sum = b.add(*sum, part);
            }
        }
        by_place(b, &mut out, place.axes.map(|axis| axis.sd));
        out
    }
}

/// A pattern with values in [0, 1].
pub(crate) struct Pattern<'a> {
    /// Its unit cell.
    pub(crate) cell: &'a dyn Cell,
    /// The numbers that shape it.
    pub(crate) parameters: Vec<Value>,
    /// Where edges are ramps, their width along each coordinate.
    pub(crate) ramps: Option<[Value; 2]>,
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
    let sharp = pattern.ramps.is_none();
    if mode == Mode::Point || certain {
        let value = pattern.cell.value(b, &pattern.parameters, [x, y]);
        return finished(lower, value, sharp);
    }
    let spread = Spread::of(b, position);
    let taps = Taps::of(b, spread.covariance).of_periodic(b);
    let constants: Vec<Option<f32>> = (pattern.parameters.iter())
        .map(|&v| b.as_constant(v))
        .collect();
    let mut key = format!("pattern {} {mode:?}", pattern.cell.key());
    for constant in &constants {
        // Writing to a string cannot fail.
        let _ = write!(key, " {constant:?}");
    }
    let of = Wanted {
        orders: orders(mode),
        squared: !sharp && mode.spreads(),
    };
    let moments = of.orders + usize::from(of.squared);
    let tap = lower.function(&key, |module| tap(module, of, pattern, &constants));
    let by_waves = pattern.cell.spectrum(&constants).map(|spectrum| {
        let key = format!("{key} waves");
        lower.function(&key, |module| spectrum.function(module, of, &constants))
    });
    let b = lower.b();
    let (zero, none) = (b.f32(0.0), b.u32(0));
    let live = unknown(&pattern.parameters, &constants);
    let mut count = taps.count;
    let mut wide = vec![zero; moments];
    if let Some(function) = by_waves {
        let mut arguments = vec![x, y];
        arguments.extend(spread.covariance);
        arguments.push(count);
        arguments.extend(live.iter().copied());
        wide = b.call(&function, &arguments);
        let serves = wide[moments];
        count = b.select(serves, none, count);
    }
    let mut captures = vec![x, y];
    captures.extend(taps.captures());
    captures.extend(live);
    let sums = b.fold(&tap, count, &vec![zero; moments + 1], &captures);
    // Of no nodes, everything is 0.
    let (one, least) = (b.f32(1.0), b.f32(1e-30));
    let weights = b.max(sums[0], least);
    let inverse = b.div(one, weights);
    let mut at = |i: usize| {
        if i < moments {
            let near = b.mul(sums[i + 1], inverse);
            b.add(near, wide[i])
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
    let square = of.squared.then(|| at(of.orders));
    let b = lower.b();
    let mean = b.clamp(field.mean, 0.0, 1.0);
    let mut field = Field { mean, ..field };
    if mode.spreads() {
        field.rest = match (square, pattern.ramps) {
            (Some(square), Some(width)) => rest_of_ramps(b, &mut field, &spread, square, width),
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

/// One node of the integral, the body of a fold: weights, then the weighted mean and derivatives,
/// then the mean of the square.
fn tap(
    module: &mut Module,
    of: Wanted,
    pattern: &Pattern<'_>,
    constants: &[Option<f32>],
) -> FunctionRef {
    let doc = "A pattern at one place of the footprint, averaged over what is left of it.";
    let name: String = (pattern.cell.key().chars())
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .collect();
    let mut b = Builder::new(format!("{name}_tap"), doc);
    let index = b.param("index", Type::U32);
    let total = b.param_f32("weights");
    let sums: Vec<Value> = (0..of.orders + usize::from(of.squared))
        .map(|i| b.param_f32(format!("sum_{i}")))
        .collect();
    let place = [b.param_f32("x"), b.param_f32("y")];
    let captures = Taps::NAMES.map(|name| b.param_f32(name));
    let parameters = declared(&mut b, constants);
    let (axes, weight) = Taps::node(&mut b, index, place, captures);
    let [.., correlation] = captures;
    let place = Place { axes, correlation };
    let parts = (pattern.cell).averaged(&mut b, module, &parameters, &place, of);
    let total = b.add(total, weight);
    b.result("weights", total);
    for (i, (&sum, part)) in sums.iter().zip(parts).enumerate() {
        let part = b.mul(weight, part);
        let sum = b.add(sum, part);
        b.result(format!("sum_{i}"), sum);
    }
    b.finish(module)
}
