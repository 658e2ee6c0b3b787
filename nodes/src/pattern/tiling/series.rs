//! All figures of a tiling at once: the Fourier series of the lattice, damped by the footprint.

use super::rows::Size;
use crate::pattern::measure::NAMES;
use crate::pattern::waves::{damping, derivatives, nearest, phase};
use mipless_codegen::ir::{Builder, Float, FunctionRef, Module, Sym2, Uint, Vec2};
use std::f64::consts::PI;

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
    pub(super) fn mean<'b>(&self, b: &'b Builder, size: Size<'b>) -> Float<'b> {
        match size {
            Size::Known(size) => b.float((self.mean * f64::from(size * size)) as f32),
            Size::Live(size) => size.square() * self.mean as f32,
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
        let b = &Builder::new("tiling_harmonic", "One more harmonic of a tiling.");
        let index = b.uint_param("index");
        let state = b.float_params(NAMES);
        let place = Vec2(b.float_params(["x", "y"]));
        let covariance = Sym2(b.float_params(["xx", "xy", "yy"]));
        let size = matches!(self.rows, Rows::OfSize(_)).then(|| b.float_param("size"));
        let first = index * width;
        let [k, l, amplitude] = [0u32, 1, 2].map(|i| b.load(table, first + i));
        let amplitude = match size {
            None => amplitude,
            Some(size) => {
                let other = b.load(table, first + 3);
                live_amplitude([k, l, amplitude, other], size)
            }
        };
        let k = Vec2([k, l]);
        let (_, left) = damping(k, covariance);
        let parts = derivatives(amplitude * left, phase(k, place), k, NAMES.len());
        b.sums(NAMES, state, parts);
        b.finish(module)
    }
}

/// Rows of the table of how many are kept for a standard deviation of 1.
const STEPS: usize = 32;

/// Rows of that table.
const KEPT: usize = 48;

/// Which row a standard deviation reads.
pub(super) fn kept_row(sd: Float<'_>) -> Uint<'_> {
    let size = (sd * STEPS as f32).clamp(0.0, (KEPT - 1) as f32);
    size.to_int().to_uint()
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
fn live_amplitude<'b>([k, l, even, odd]: [Float<'b>; 4], size: Float<'b>) -> Float<'b> {
    // All p are multiples of ½.
    let [[sp, cp], [sq, cq]] = [k + l, k - l].map(|p| {
        let [cosine, sine] = nearest(p * size * 0.5).circle();
        let still = p.abs().lt(0.25);
        let ratio = sine / still.select(1.0, p * PI as f32);
        [still.select(size, ratio), cosine]
    });
    even * (sp * sq) + odd * (cq * sp - cp * sq)
}

/// k, l and a bound of [`of_size`] for any h up to ½.
fn at_most([k, l, even, odd]: [f64; 4]) -> [f64; 3] {
    let [p, q] = [k + l, k - l].map(|p: f64| (1.0 / (PI * p.abs())).min(0.5));
    [k, l, even.abs() * p * q + odd.abs() * (p + q)]
}
