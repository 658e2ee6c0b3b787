//! One independent number of [0, 1) in every cell of a lattice, filtered by a Gaussian footprint.
//!
//! The weight of a cell is the probability of its box. Within a row of cells the other coordinate is
//! taken for Gaussian, with the mean and the variance that it has given the row: for footprints
//! whose axes are the lattice's that is exact, for others what errs is that a truncated normal's
//! shear is not normal.

pub(crate) mod line;
pub(crate) mod space;

use super::field::{Field, Spread};
use super::period::wrapped;
use line::Sums;
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::{Mode, Normal, Signal};

/// The variance of a number of [0, 1).
pub(crate) const VARIANCE: f32 = 1.0 / 12.0;

/// How far a window reaches, in standard deviations; weights are normalised to their sum.
const REACH: f32 = 2.8;

/// The most rows or columns of a window; footprints that need more fade.
const MOST: f32 = 24.0;

/// The number of a cell, in [0, 1), and its hash.
pub(crate) fn number(
    b: &mut Builder,
    column: Value,
    row: Value,
    seed: Value,
    period: i32,
) -> (Value, Value) {
    let column = wrapped(b, column, period);
    let row = wrapped(b, row, period);
    let (column, row) = (b.cast_u(column), b.cast_u(row));
    let factor = b.u32(0x9e37_79b1);
    let row = b.mul_u(row, factor);
    let row = b.add_u(row, seed);
    let hash = b.xor_u(column, row);
    let hash = b.scramble(hash);
    let by = b.u32(8);
    let leading = b.shr_u(hash, by);
    let number = b.float_u(leading);
    (b.scale(number, 1.0 / (1u32 << 24) as f32), hash)
}

/// The scrambled seed of a lattice; `salt` separates kinds of noise.
pub(crate) fn lattice_seed(b: &mut Builder, seed: i32, salt: u32) -> Value {
    let seed = b.u32(seed as u32 ^ salt);
    b.scramble(seed)
}

/// The cell and the fraction of a coordinate.
pub(crate) fn split(b: &mut Builder, axis: &Signal) -> [Value; 2] {
    match axis.cell {
        Some(cell) => [cell, axis.mean],
        None => {
            let whole = b.floor(axis.mean);
            let fraction = b.sub(axis.mean, whole);
            [b.trunc_i(whole), fraction]
        }
    }
}

/// The same of all coordinates, in order.
fn places(b: &mut Builder, position: &[Signal]) -> Vec<Value> {
    position.iter().flat_map(|axis| split(b, axis)).collect()
}

/// Reports a footprint of this standard deviation, in cells.
fn report(lower: &mut Lower<'_>, sd: Value) {
    // The spectrum of a box has half its energy below a third of a cycle per cell.
    let size = lower.b().scale(sd, 1.0 / 3.0);
    lower.source_footprint(size);
}

/// The probability that two independent places of a Gaussian spread along one axis lie in one cell:
/// E[max(1 − |t|, 0)] of their difference t, of standard deviation τ = σ√2.
pub(crate) fn coincidence(b: &mut Builder, variance: Value) -> Value {
    let twice = b.add(variance, variance);
    let raised = b.offset(twice, 1e-12);
    let sd = b.sqrt(raised);
    let one = b.f32(1.0);
    let inverse = b.div(one, sd);
    let n = Normal::at(b, one, inverse);
    let inside = b.offset(n.below, -0.5);
    let inside = b.add(inside, inside);
    // 2τ(φ(0) − φ(1/τ)).
    let density = b.neg(n.density);
    let density = b.offset(density, 0.398_942_3);
    let lost = b.mul(density, sd);
    let lost = b.add(lost, lost);
    let share = b.sub(inside, lost);
    b.clamp(share, 0.0, 1.0)
}

/// The filtered cells at a position; the mean lies around ½.
pub(crate) fn filtered(
    lower: &mut Lower<'_>,
    position: &[Signal],
    seed: i32,
    period: i32,
) -> Field {
    let mode = lower.mode();
    let spread = Spread::of(lower.b(), position);
    let size = lower.b().sqrt(spread.eigenvalues[0]);
    report(lower, size);
    let key = format!("cells {mode:?} {seed} {period}");
    let function = lower.function(&key, |module| build(module, mode, seed, period));
    let b = lower.b();
    let mut arguments = places(b, position);
    if mode.filters() {
        arguments.extend(spread.covariance);
        arguments.extend(spread.eigenvalues);
    }
    let results = b.call(&function, &arguments);
    let zero = b.f32(0.0);
    let at = |i: usize| results.get(i).copied().unwrap_or(zero);
    Field {
        mean: at(0),
        gradient: [at(1), at(2)],
        hessian: [zero; 3],
        rest: at(3),
    }
}

/// The window of a standard deviation.
fn window(b: &mut Builder, mean: Value, sd: Value) -> [Value; 2] {
    let reach = b.scale(sd, REACH);
    around(b, mean, reach)
}

/// A window over `count` = ⌈2r⌉ + 1 cells that starts at ⌊m − r⌋.
fn around(b: &mut Builder, mean: Value, reach: Value) -> [Value; 2] {
    let start = b.sub(mean, reach);
    let start = b.floor(start);
    let minus = b.scale(reach, -2.0);
    let floor = b.floor(minus);
    let count = b.neg(floor);
    let count = b.offset(count, 1.0);
    [start, b.clamp(count, 1.0, MOST)]
}

/// 1, falling to 0 as a footprint of this standard deviation fills the largest window.
fn fading(b: &mut Builder, sd: Value) -> Value {
    let largest = (MOST - 1.0) / (2.0 * REACH);
    let fade = b.scale(sd, -4.0 / largest);
    let fade = b.offset(fade, 4.0);
    b.clamp(fade, 0.0, 1.0)
}

/// How many cells a window has, or none of what has faded, as u32.
fn counted(b: &mut Builder, cells: Value, fade: Value) -> Value {
    let (zero, none) = (b.f32(0.0), b.u32(0));
    let gone = b.le(fade, zero);
    let count = b.trunc_i(cells);
    let count = b.cast_u(count);
    b.select(gone, none, count)
}

/// The cells of one row, the body of a fold over columns.
fn column(module: &mut Module, period: i32) -> FunctionRef {
    let sums = Sums::of(1);
    let mut b = Builder::new("cell_column", "One cell of a row.");
    let index = b.param("index", Type::U32);
    let names = sums.names();
    let state: Vec<Value> = names.iter().map(|name| b.param_f32(name)).collect();
    let start = b.param_f32("start");
    let (mean, inverse) = (b.param_f32("mean"), b.param_f32("inverse_sd"));
    let centre = b.param_f32("centre");
    let cell = b.param("cell_x", Type::I32);
    let row = b.param("row", Type::I32);
    let seed = b.param("seed", Type::U32);
    let offset = b.float_u(index);
    let place = b.add(start, offset);
    let edge = b.offset(place, 1.0);
    let distance = b.sub(edge, mean);
    let whole = b.trunc_i(place);
    let column = b.add_i(cell, whole);
    let (value, _) = number(&mut b, column, row, seed, period);
    let d = b.sub(value, centre);
    let next = sums.after(&mut b, &state, [distance, inverse], &[d]);
    for (name, value) in names.into_iter().zip(next) {
        b.result(name, value);
    }
    b.finish(module)
}

/// A row of cells, or a layer of rows, under a Gaussian.
struct Slice {
    /// Its probability.
    weight: Value,
    /// From the mean to the mean given the slice.
    moved: Value,
    /// The variance given the slice, and its share of the whole.
    within: Value,
    share: Value,
    /// φ at the lower edge less φ at the upper one.
    fall: Value,
}

impl Slice {
    /// Of the cells whose lower edge is at a distance from the mean: a truncated normal.
    fn of(b: &mut Builder, low: Value, [sd, inverse]: [Value; 2]) -> Self {
        let (zero, high) = (b.f32(0.0), b.offset(low, 1.0));
        let (n0, n1) = (Normal::at(b, low, inverse), Normal::at(b, high, inverse));
        let weight = b.sub(n1.below, n0.below);
        let weight = b.max(weight, zero);
        let tiny = b.f32(1e-6);
        let guarded = b.max(weight, tiny);
        let fall = b.sub(n0.density, n1.density);
        let lean = b.div(fall, guarded);
        let moved = b.mul(lean, sd);
        let moved = b.max(moved, low);
        let moved = b.min(moved, high);
        let (left, right) = (b.mul(n0.z, n0.density), b.mul(n1.z, n1.density));
        let change = b.sub(left, right);
        let change = b.div(change, guarded);
        let square = b.square(lean);
        let share = b.sub(change, square);
        let share = b.offset(share, 1.0);
        let share = b.clamp(share, 0.0, 1.0);
        let v = b.square(sd);
        let within = b.mul(share, v);
        let widest = b.f32(VARIANCE);
        let within = b.min(within, widest);
        let share = b.square(inverse);
        Self {
            weight,
            moved,
            within,
            share: b.mul(within, share),
            fall,
        }
    }

    /// The derivative by the mean of a sum over the slice, of which the mean given the slice and the
    /// derivative by what the slice shifts, times by how much, are known: of the weight, and of the
    /// shift, which lags behind by dμ/dm − 1 with dμ/dm = var/σ².
    fn slope(&self, b: &mut Builder, inverse: Value, first: Value, shifted: Value) -> Value {
        let gain = b.mul(self.fall, inverse);
        let direct = b.mul(gain, first);
        let lag = b.offset(self.share, -1.0);
        let lag = b.mul(lag, self.weight);
        let indirect = b.mul(lag, shifted);
        b.add(direct, indirect)
    }
}

/// One row of cells, the body of a fold: sums of the weight, of d, of d², and of both slopes.
fn row(module: &mut Module, period: i32) -> FunctionRef {
    let column = column(module, period);
    let mut b = Builder::new("cell_row", "One row of cells.");
    let index = b.param("index", Type::U32);
    let names = ["weight", "first", "second", "slope_x", "slope_y"];
    let state = names.map(|name| b.param_f32(name));
    let start = b.param_f32("start");
    let (x, y) = (b.param_f32("x"), b.param_f32("y"));
    let centre = b.param_f32("centre");
    let cells = [b.param("cell_x", Type::I32), b.param("cell_y", Type::I32)];
    let seed = b.param("seed", Type::U32);
    let (sd, inverse) = (b.param_f32("sd_y"), b.param_f32("inverse_sd_y"));
    let (shear, across) = (b.param_f32("shear"), b.param_f32("variance_across"));
    let one = b.f32(1.0);
    let offset = b.float_u(index);
    let place = b.add(start, offset);
    let low = b.sub(place, y);
    let slice = Slice::of(&mut b, low, [sd, inverse]);
    // x given the row.
    let shift = b.mul(shear, slice.moved);
    let mean = b.add(x, shift);
    let square = b.square(shear);
    let spread = b.mul(square, slice.within);
    let variance = b.add(across, spread);
    let raised = b.offset(variance, 1e-12);
    let sd_x = b.sqrt(raised);
    let inverse_x = b.div(one, sd_x);
    // The cells that count lie within an ellipse.
    let aside = b.mul(slice.moved, inverse);
    let aside = b.square(aside);
    let aside = b.scale(aside, -1.0 / (REACH * REACH));
    let left = b.add(one, aside);
    let zero = b.f32(0.0);
    let left = b.max(left, zero);
    let left = b.sqrt(left);
    let reach = b.scale(sd_x, REACH);
    let reach = b.mul(reach, left);
    let [first, count] = around(&mut b, mean, reach);
    let distance = b.sub(first, mean);
    let init = Sums::of(1).start(&mut b, distance, inverse_x);
    let whole = b.trunc_i(place);
    let row = b.add_i(cells[1], whole);
    let count = b.trunc_i(count);
    let count = b.cast_u(count);
    let captures = [first, mean, inverse_x, centre, cells[0], row, seed];
    let sums = b.fold(&column, count, &init, &captures);
    let tiny = b.f32(1e-6);
    let total = b.max(sums[2], tiny);
    let scale = b.div(one, total);
    let (m1, m2) = (b.mul(sums[3], scale), b.mul(sums[4], scale));
    let slope = b.mul(sums[5], scale);
    let slope = b.mul(slope, inverse_x);
    let shifted = b.mul(shear, slope);
    let parts = [
        slice.weight,
        b.mul(slice.weight, m1),
        b.mul(slice.weight, m2),
        b.mul(slice.weight, slope),
        slice.slope(&mut b, inverse, m1, shifted),
    ];
    for ((name, sum), part) in names.into_iter().zip(state).zip(parts) {
        let sum = b.add(sum, part);
        b.result(name, sum);
    }
    b.finish(module)
}

/// Sums over the cells of a plane, relative to the number at the centre: means of d and of d², and
/// the slopes of the mean of d.
struct Plane {
    first: Value,
    second: Value,
    slopes: [Value; 2],
}

impl Plane {
    /// Of a Gaussian at a place, from the cells there: its Σ₁₁, Σ₁₂, Σ₂₂ and det Σ, none of which is
    /// a difference.
    fn of(
        b: &mut Builder,
        row: &FunctionRef,
        [x, y]: [Value; 2],
        [s_xx, s_xy, s_yy, determinant]: [Value; 4],
        [centre, cell_x, cell_y, seed, fade]: [Value; 5],
    ) -> Self {
        let (zero, one) = (b.f32(0.0), b.f32(1.0));
        let raised = b.offset(s_yy, 1e-12);
        let sd = b.sqrt(raised);
        let inverse = b.div(one, sd);
        let shear = b.div(s_xy, raised);
        // What x has beyond y: det Σ/Σ₂₂, of what is raised.
        let own = b.scale(s_xx, 1e-12);
        let determinant = b.add(determinant, own);
        let across = b.div(determinant, raised);
        let across = b.min(across, s_xx);
        let [start, rows] = window(b, y, sd);
        let count = counted(b, rows, fade);
        let captures = [
            start, x, y, centre, cell_x, cell_y, seed, sd, inverse, shear, across,
        ];
        let sums = b.fold(row, count, &[zero; 5], &captures);
        let tiny = b.f32(1e-6);
        let total = b.max(sums[0], tiny);
        let scale = b.div(one, total);
        let [first, second, slope_x, slope_y] = [1, 2, 3, 4].map(|i| b.mul(sums[i], scale));
        Self {
            first,
            second,
            slopes: [slope_x, slope_y],
        }
    }
}

/// What the cells of a footprint have in common, by their numbers less the centre's.
struct Filtered<'a> {
    centre: Value,
    /// The means of d and of d².
    first: Value,
    second: Value,
    /// The derivatives of the mean.
    slopes: &'a [Value],
    /// The variance that they give.
    linear: Value,
    /// How much of it has not faded.
    fade: Value,
    /// The probability that two places of the footprint lie in one cell.
    same: Value,
}

impl Filtered<'_> {
    /// The results of a function: the mean, the slopes and what is left of the variance.
    fn results(&self, b: &mut Builder, mode: Mode) {
        let &Self { first, fade, .. } = self;
        let (zero, one) = (b.f32(0.0), b.f32(1.0));
        // M = ½ + fade (v₀ + m₁ − ½).
        let mean = b.add(self.centre, first);
        let mean = b.offset(mean, -0.5);
        let mean = b.mul(mean, fade);
        let mean = b.offset(mean, 0.5);
        let mean = b.clamp(mean, 0.0, 1.0);
        b.result("mean", mean);
        let carries = matches!(mode, Mode::Local | Mode::Quad);
        for (name, &slope) in ["dx", "dy", "dz"].into_iter().zip(self.slopes) {
            let slope = b.mul(slope, fade);
            b.result(name, if carries { slope } else { zero });
        }
        if !mode.spreads() {
            return;
        }
        let whole = b.f32(VARIANCE);
        let rest = if carries {
            let square = b.square(first);
            let variance = b.sub(self.second, square);
            let share = b.square(fade);
            let linear = b.mul(self.linear, share);
            let rest = b.sub(variance, linear);
            let rest = b.max(rest, zero);
            let near = b.mul(rest, fade);
            let kept = b.sub(one, fade);
            let far = b.mul(whole, kept);
            b.add(near, far)
        } else {
            let left = b.mul(self.same, fade);
            let lost = b.sub(one, left);
            b.mul(lost, whole)
        };
        b.result("rest", rest);
    }
}

fn build(module: &mut Module, mode: Mode, seed: i32, period: i32) -> FunctionRef {
    let row = mode.filters().then(|| row(module, period));
    let mut b = Builder::new("cells", "Filtered random cells.");
    let cell_x = b.param("cell_x", Type::I32);
    let x = b.param_f32("x");
    let cell_y = b.param("cell_y", Type::I32);
    let y = b.param_f32("y");
    let seed = lattice_seed(&mut b, seed, 0xbb67_ae85);
    let inner = [x, y].map(|x| b.floor(x));
    let inner = inner.map(|x| b.trunc_i(x));
    let (cx, cy) = (b.add_i(cell_x, inner[0]), b.add_i(cell_y, inner[1]));
    let (centre, _) = number(&mut b, cx, cy, seed, period);
    let Some(row) = row else {
        b.result("mean", centre);
        return b.finish(module);
    };
    let [s_xx, s_xy, s_yy] = ["s_xx", "s_xy", "s_yy"].map(|name| b.param_f32(name));
    let eigenvalues = [b.param_f32("s_major"), b.param_f32("s_minor")];
    let determinant = b.mul(eigenvalues[0], eigenvalues[1]);
    // Windows that would be too large fade.
    let wide = b.max(s_xx, s_yy);
    let wide = b.offset(wide, 1e-12);
    let wide = b.sqrt(wide);
    let fade = fading(&mut b, wide);
    let covariance = [s_xx, s_xy, s_yy, determinant];
    let from = [centre, cell_x, cell_y, seed, fade];
    let plane = Plane::of(&mut b, &row, [x, y], covariance, from);
    let slopes = plane.slopes;
    let left = b.dot(&[s_xx, s_xy], &slopes);
    let right = b.dot(&[s_xy, s_yy], &slopes);
    let shares = eigenvalues.map(|v| coincidence(&mut b, v));
    let filtered = Filtered {
        centre,
        first: plane.first,
        second: plane.second,
        slopes: &slopes,
        linear: b.dot(&slopes, &[left, right]),
        fade,
        same: b.mul(shares[0], shares[1]),
    };
    filtered.results(&mut b, mode);
    b.finish(module)
}
