//! Functions of two coordinates that repeat along both, over a footprint that may be rotated.
//!
//! The unit cell is a sum of products of pulses, one factor a coordinate ([`Terms`]), or the bricks of a
//! wall ([`super::wall`]). What the coordinates share is integrated ([`super::taps`]); the rest is
//! averaged in closed form.

use super::harmonics::{Spectrum, declared, unknown};
use super::pulse::{Axis, Pulse, Series};
use super::taps::{Nodes, Taps, by_place, joined};
use super::wanted::Wanted;
use crate::noise::field::{Field, Spread};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Float, FunctionRef, Module, Sym2, Vec2};
use mipless_codegen::moments::{Mode, Signal};
use std::fmt::Write as _;

/// A coefficient times at most one pulse a coordinate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Term<'b> {
    /// The coefficient.
    pub(crate) coefficient: f32,
    /// The factor of the first coordinate, else 1.
    pub(crate) x: Option<Pulse<'b>>,
    /// The factor of the second coordinate, else 1.
    pub(crate) y: Option<Pulse<'b>>,
}

impl<'b> Term<'b> {
    /// The product of two pulses.
    pub(crate) fn product(x: Pulse<'b>, y: Pulse<'b>) -> Self {
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
    pub(crate) fn value(&self, at: [Float<'b>; 2]) -> Float<'b> {
        let mut product = at[0].literal(self.coefficient);
        for (pulse, x) in [self.x, self.y].into_iter().zip(at) {
            if let Some(pulse) = pulse {
                product *= pulse.value(x);
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
    fn value<'b>(&self, parameters: &[Float<'b>], at: [Float<'b>; 2]) -> Float<'b>;

    /// The mean over two Gaussians and its derivatives (∂x, ∂y, ∂xx, ∂xy, ∂yy) as far as `orders` go;
    /// then, where they are `squared`, the mean of the square.
    fn averaged<'b>(
        &self,
        module: &mut Module,
        parameters: &[Float<'b>],
        place: &Place<'b>,
        of: Wanted,
    ) -> Vec<Float<'b>>;

    /// Its Fourier series, if it has one that is shorter for wide footprints, from the parameters that are
    /// known.
    fn spectrum(&self, parameters: &[Option<f32>]) -> Option<Spectrum<'_>> {
        let _ = parameters;
        None
    }
}

/// Two Gaussians.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place<'b> {
    /// The coordinates.
    pub(crate) axes: [Axis<'b>; 2],
    /// Their correlation, of at most ½.
    pub(crate) correlation: Float<'b>,
}

/// A constant and terms, from parameters.
type Sum<'a> = dyn for<'b> Fn(&'b Builder, &[Float<'b>]) -> (f32, Vec<Term<'b>>) + 'a;

/// A constant and terms whose sum is a function on the unit cell, from parameters.
pub(crate) struct Terms<'a> {
    /// Names the terms.
    pub(crate) key: String,
    /// The constant and the terms.
    pub(crate) of: &'a Sum<'a>,
}

impl Cell for Terms<'_> {
    fn key(&self) -> String {
        self.key.clone()
    }

    fn value<'b>(&self, parameters: &[Float<'b>], at: [Float<'b>; 2]) -> Float<'b> {
        let b = at[0].builder();
        let (constant, terms) = (self.of)(b, parameters);
        (terms.iter()).fold(b.float(constant), |sum, term| sum + term.value(at))
    }

    fn averaged<'b>(
        &self,
        module: &mut Module,
        parameters: &[Float<'b>],
        place: &Place<'b>,
        of: Wanted,
    ) -> Vec<Float<'b>> {
        assert!(!of.squared, "the square of a sum has terms of its own");
        let b = place.correlation.builder();
        let (constant, terms) = (self.of)(b, parameters);
        let mut series = Series::default();
        let mut out = vec![b.float(0.0); of.orders];
        out[0] = b.float(constant);
        for term in terms {
            let [x, y] =
                [(term.x, place.axes[0]), (term.y, place.axes[1])].map(
                    |(pulse, axis)| match pulse {
                        Some(pulse) => pulse.moments((&mut *module, &mut series), axis, false).own,
                        None => [1.0, 0.0, 0.0, 0.0].map(|x| b.float(x)),
                    },
                );
            let x = x.map(|v| v * term.coefficient);
            for (sum, part) in out.iter_mut().zip(joined(x, y, place.correlation)) {
                *sum += part;
            }
        }
        by_place(&mut out, place.axes.map(|axis| axis.sd));
        out
    }
}

/// A pattern with values in [0, 1].
pub(crate) struct Pattern<'a, 'b> {
    /// Its unit cell.
    pub(crate) cell: &'a dyn Cell,
    /// The numbers that shape it.
    pub(crate) parameters: Vec<Float<'b>>,
    /// Where edges are ramps, their width along each coordinate.
    pub(crate) ramps: Option<[Float<'b>; 2]>,
}

/// A coordinate modulo 1.
pub(crate) fn phase<'b>(coordinate: &Signal<'b>) -> Float<'b> {
    coordinate.place().1
}

/// The pattern at a position in unit cells, as a signal.
pub(crate) fn filtered<'b>(
    lower: &mut Lower<'_, 'b>,
    position: &[Signal<'b>; 2],
    pattern: &Pattern<'_, 'b>,
) -> Signal<'b> {
    let mode = lower.mode();
    let [x, y] = [0, 1].map(|i| phase(&position[i]));
    let sharp = pattern.ramps.is_none();
    if mode == Mode::Point || position.iter().all(Signal::is_certain) {
        let value = pattern.cell.value(&pattern.parameters, [x, y]);
        return finished_signal(lower, Signal::certain(value), sharp);
    }

    // The functions that a footprint takes one of.
    let spread = Spread::of(position);
    let taps = Taps::of(spread.covariance).of_periodic();
    let constants: Vec<Option<f32>> = (pattern.parameters.iter())
        .map(|v| v.as_constant())
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
    let tap = lower.function(&key, |module| tap(module, of, pattern.cell, &constants));
    let by_waves = pattern.cell.spectrum(&constants).map(|spectrum| {
        let key = format!("{key} waves");
        lower.function(&key, |module| spectrum.function(module, of, &constants))
    });

    // What each gives: the other one is 0.
    let b = lower.b();
    let live = unknown(&pattern.parameters, &constants);
    let mut count = taps.count;
    let mut wide = vec![b.float(0.0); moments];
    if let Some(function) = by_waves {
        let results = b.call_any(&function, ([x, y], spread.covariance, count, &live));
        let (serves, parts) = results.split_last().expect("whether it serves");
        wide = parts.iter().map(|part| part.float()).collect();
        count = serves.bool().select(0, count);
    }
    let zeros = vec![b.float(0.0); moments + 1];
    let sums = b.fold(&tap, count, zeros, ([x, y], taps.nodes, live));
    // Of no nodes, everything is 0.
    let inverse = 1.0 / sums[0].max(1e-30);
    let at = |i: usize| sums[i + 1] * inverse + wide[i];
    let derivative = |i: usize| if i < of.orders { at(i) } else { b.float(0.0) };
    let mut field = Field {
        mean: at(0).clamp(0.0, 1.0),
        gradient: Vec2([1, 2].map(derivative)),
        hessian: Sym2([3, 4, 5].map(derivative)),
        rest: b.float(0.0),
    };
    if mode.spreads() {
        field.rest = match pattern.ramps {
            Some(width) if of.squared => rest_of_ramps(&mut field, &spread, at(of.orders), width),
            _ => rest_of_two(&mut field, &spread),
        };
    }
    let signal = field.at(lower, position);
    finished_signal(lower, signal, sharp)
}

/// A sharp pattern takes two values, and every pattern bends.
pub(crate) fn finished_signal<'b>(
    lower: &mut Lower<'_, 'b>,
    signal: Signal<'b>,
    sharp: bool,
) -> Signal<'b> {
    lower.algebra.bent = true;
    let binary = (sharp && !signal.is_certain()).then(|| [0.0, 1.0].map(|x| lower.b().float(x)));
    Signal {
        binary,
        ..signal.with_range([0.0, 1.0])
    }
}

/// What the response of a field to the footprint leaves of a variance: Var − |g|² − ½‖H‖², at least 0.
/// A Hessian that claims more than its share, as one of a truncated series may, is made smaller.
pub(crate) fn rest<'b>(
    field: &mut Field<'b>,
    spread: &Spread<'b>,
    variance: Float<'b>,
) -> Float<'b> {
    let (sigma, gradient, hessian) = (spread.covariance, field.gradient, field.hessian);
    let rest = (variance - gradient.dot(sigma.times(gradient))).max(0.0);
    if hessian.iter().all(|h| h.is_zero()) {
        return rest;
    }
    // ½ tr (HΣ)².
    let [[h11, h12, h22], [xx, xy, yy]] = [*hessian, *sigma];
    let [column_x, column_y] = [Vec2([xx, xy]), Vec2([xy, yy])];
    let [row_x, row_y] = [Vec2([h11, h12]), Vec2([h12, h22])];
    let (a, d) = (row_x.dot(column_x), row_y.dot(column_y));
    let (p, q) = (row_x.dot(column_y), row_y.dot(column_x));
    let claimed = (a.square() + d.square()) * 0.5 + p * q;
    let share = (rest / claimed.max(1e-30)).min(1.0);
    field.hessian = hessian * share.sqrt();
    (rest - claimed).max(0.0)
}

/// The same of a pattern that is 0 or 1, whose variance is P(1 − P).
pub(crate) fn rest_of_two<'b>(field: &mut Field<'b>, spread: &Spread<'b>) -> Float<'b> {
    let variance = field.mean * (1.0 - field.mean);
    rest(field, spread, variance)
}

/// The same of a pattern with ramps, from the mean of its square: no more than the ramps' linear
/// response is left while the footprint lies within them.
fn rest_of_ramps<'b>(
    field: &mut Field<'b>,
    spread: &Spread<'b>,
    square: Float<'b>,
    [wide, high]: [Float<'b>; 2],
) -> Float<'b> {
    let variance = square - field.mean.square();
    let rest = rest(field, spread, variance);
    // 1 − (1 − f₁)(1 − f₂) with f = σ²/(σ² + (0.4 w)²).
    let share = |variance: Float<'b>, width: Float<'b>| {
        let square = width.square() * 0.16;
        square / (variance + square + 1e-12)
    };
    let [xx, _, yy] = *spread.covariance;
    rest * (1.0 - share(xx, wide) * share(yy, high))
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
fn tap(module: &mut Module, of: Wanted, cell: &dyn Cell, constants: &[Option<f32>]) -> FunctionRef {
    let doc = "A pattern at one place of the footprint, averaged over what is left of it.";
    let name: String = (cell.key().chars())
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .collect();
    let b = &Builder::new(format!("{name}_tap"), doc);
    let index = b.uint_param("index");
    let total = b.float_param("weights");
    let sums: Vec<Float<'_>> = (0..of.orders + usize::from(of.squared))
        .map(|i| b.float_param(format!("sum_{i}")))
        .collect();
    let place = b.float_params(["x", "y"]);
    let nodes = Nodes::declare(b);
    let parameters = declared(b, constants);
    let (axes, weight) = nodes.at(index, place);
    let place = Place {
        axes,
        correlation: nodes.correlation,
    };
    let parts = cell.averaged(module, &parameters, &place, of);
    b.result("weights", total + weight);
    for (i, (&sum, part)) in sums.iter().zip(parts).enumerate() {
        b.result(format!("sum_{i}"), sum + weight * part);
    }
    b.finish(module)
}
