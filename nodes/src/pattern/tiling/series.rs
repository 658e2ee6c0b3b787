//! All figures of a tiling at once: the Fourier series of the lattice, damped by the footprint.

use super::rows::Size;
use crate::pattern::harmonics::nearest;
use crate::pattern::measure::NAMES;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use std::f64::consts::{PI, TAU};

/// What a series leaves out of 1 by each harmonic that is damped away.
const NEGLIGIBLE: f64 = 5e-5;

/// Half of the harmonics of a tiling, the lowest first, and its mean.
pub(crate) struct Harmonics {
    /// The share of the plane that figures of size 1 cover.
    mean: f64,
    rows: Rows,
}

/// The numbers of each harmonic.
enum Rows {
    /// k, l and the amplitude.
    Known(Vec<[f64; 3]>),
    /// k, l and two coefficients of [`of_size`].
    OfSize(Vec<[f64; 4]>),
}

/// Sorted by their frequencies.
fn lowest_first<const N: usize>(mut rows: Vec<[f64; N]>) -> Vec<[f64; N]> {
    rows.sort_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1])));
    rows
}

impl Harmonics {
    /// (k, l, amplitude) of figures of the size that the tiling has.
    pub(super) fn known(mean: f64, rows: Vec<[f64; 3]>) -> Self {
        let rows = Rows::Known(lowest_first(rows));
        Self { mean, rows }
    }

    /// (k, l, A, B) of [`of_size`].
    pub(super) fn of_size(mean: f64, rows: Vec<[f64; 4]>) -> Self {
        let rows = Rows::OfSize(lowest_first(rows));
        Self { mean, rows }
    }

    /// The share of the plane that figures of a size cover.
    pub(super) fn mean(&self, b: &mut Builder, size: Size) -> Value {
        match size {
            Size::Known(size) => b.f32((self.mean * f64::from(size * size)) as f32),
            Size::Live(size) => {
                let square = b.square(size);
                b.scale(square, self.mean as f32)
            }
        }
    }

    /// Rows of [`KEPT`] numbers: how many of the lowest harmonics a footprint of at least i/32 cells
    /// leaves. The others are damped to less than 5e-5 of 1.
    pub(super) fn kept(&self) -> Vec<f32> {
        // Frequencies and the most that an amplitude can be.
        let rows: Vec<[f64; 3]> = match &self.rows {
            Rows::Known(rows) => rows.clone(),
            Rows::OfSize(rows) => rows.iter().map(|&row| at_most(row)).collect(),
        };
        let count = |i: usize| {
            let variance = (i as f64 / STEPS as f64).powi(2);
            let left = |row: &[f64; 3]| {
                let damping = (-2.0 * PI * PI * variance * row[0].hypot(row[1]).powi(2)).exp();
                row[2].abs() * damping > NEGLIGIBLE
            };
            rows.iter().rposition(left).map_or(0, |last| last + 1) as f32
        };
        (0..KEPT).map(count).collect()
    }

    /// One more harmonic, the body of a fold. Captures: the place, the covariance, and the size, if the
    /// amplitudes depend on it.
    pub(super) fn function(&self, module: &mut Module) -> FunctionRef {
        let (numbers, width): (Vec<f32>, u32) = match &self.rows {
            Rows::Known(rows) => (rows.iter().flatten().map(|&x| x as f32).collect(), 3),
            Rows::OfSize(rows) => (rows.iter().flatten().map(|&x| x as f32).collect(), 4),
        };
        let table = module.table("harmonics", numbers);
        let mut b = Builder::new("tiling_harmonic", "One more harmonic of a tiling.");
        let index = b.param("index", Type::U32);
        let state = NAMES.map(|name| b.param_f32(name));
        let place = [b.param_f32("x"), b.param_f32("y")];
        let [xx, xy, yy] = ["xx", "xy", "yy"].map(|name| b.param_f32(name));
        let size = matches!(self.rows, Rows::OfSize(_)).then(|| b.param_f32("size"));
        let stride = b.u32(width);
        let first = b.mul_u(index, stride);
        let load = |b: &mut Builder, i: u32| {
            let shift = b.u32(i);
            let at = b.add_u(first, shift);
            b.load(table, at)
        };
        let [k, l, amplitude] = [0, 1, 2].map(|i| load(&mut b, i));
        let amplitude = match size {
            None => amplitude,
            Some(size) => {
                let other = load(&mut b, 3);
                live_amplitude(&mut b, [k, l, amplitude, other], size)
            }
        };
        let (px, py) = (b.dot(&[xx, xy], &[k, l]), b.dot(&[xy, yy], &[k, l]));
        let form = b.dot(&[k, l], &[px, py]);
        let exponent = b.scale(form, (-2.0 * PI * PI) as f32);
        let exponent = b.clamp(exponent, -80.0, 0.0);
        let damping = b.exp(exponent);
        let amplitude = b.mul(amplitude, damping);
        let turns = b.dot(&[k, l], &place);
        let turns = nearest(&mut b, turns);
        let [cosine, sine] = b.circle(turns);
        let value = b.mul(amplitude, cosine);
        let slope = b.mul(amplitude, sine);
        let slope = b.scale(slope, -TAU as f32);
        let bend = b.scale(value, (-TAU * TAU) as f32);
        let (kk, kl, ll) = (b.square(k), b.mul(k, l), b.square(l));
        let parts = [
            value,
            b.mul(slope, k),
            b.mul(slope, l),
            b.mul(bend, kk),
            b.mul(bend, kl),
            b.mul(bend, ll),
        ];
        for ((name, sum), part) in NAMES.into_iter().zip(state).zip(parts) {
            let sum = b.add(sum, part);
            b.result(name, sum);
        }
        b.finish(module)
    }
}

/// Rows of the table of how many are kept for a standard deviation of 1.
const STEPS: usize = 32;

/// Rows of that table.
const KEPT: usize = 48;

/// Which row a standard deviation reads.
pub(super) fn kept_row(b: &mut Builder, sd: Value) -> Value {
    let size = b.scale(sd, STEPS as f32);
    let size = b.clamp(size, 0.0, (KEPT - 1) as f32);
    let size = b.trunc_i(size);
    b.cast_u(size)
}

/// An amplitude of figures whose edges all are diagonals, by the half diagonal h:
/// A S(p) S(q) + B (C(q) S(p) − C(p) S(q)) with p = k + l, q = k − l, C(p) = cos πph and
/// S(p) = (sin πph)/πp, which is h at p = 0.
pub(super) fn of_size([k, l, even, odd]: [f64; 4], size: f64) -> f64 {
    let [[sp, cp], [sq, cq]] = [k + l, k - l].map(|p| {
        let (sine, cosine) = (PI * p * size).sin_cos();
        let sine = if p == 0.0 { size } else { sine / (PI * p) };
        [sine, cosine]
    });
    even * sp * sq + odd * (cq * sp - cp * sq)
}

/// The same where the shader runs.
fn live_amplitude(b: &mut Builder, [k, l, even, odd]: [Value; 4], size: Value) -> Value {
    // All p are multiples of ½.
    let (least, one) = (b.f32(0.25), b.f32(1.0));
    let [[sp, cp], [sq, cq]] = [b.add(k, l), b.sub(k, l)].map(|p| {
        let turns = b.mul(p, size);
        let turns = b.scale(turns, 0.5);
        let turns = nearest(b, turns);
        let [cosine, sine] = b.circle(turns);
        let magnitude = b.abs(p);
        let still = b.lt(magnitude, least);
        let angle = b.scale(p, PI as f32);
        let angle = b.select(still, one, angle);
        let ratio = b.div(sine, angle);
        [b.select(still, size, ratio), cosine]
    });
    let (both, left, right) = (b.mul(sp, sq), b.mul(cq, sp), b.mul(cp, sq));
    let across = b.sub(left, right);
    b.dot(&[even, odd], &[both, across])
}

/// k, l and a bound of [`of_size`] for any h up to ½.
fn at_most([k, l, even, odd]: [f64; 4]) -> [f64; 3] {
    let [p, q] = [k + l, k - l].map(|p: f64| (1.0 / (PI * p.abs())).min(0.5));
    [k, l, even.abs() * p * q + odd.abs() * (p + q)]
}
