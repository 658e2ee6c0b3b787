//! Patterns that repeat along two coordinates as Fourier series.
//!
//! A Gaussian footprint damps a wave of the frequency k by e^{−2π²kᵀΣk}, whatever its direction: what is
//! left lies within an ellipse of frequencies of the area π/(2√det Σ), and is summed row by row.

use super::separable::Wanted;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use std::f64::consts::{PI, TAU};

/// The largest kᵀΣk of a wave that is summed: of others 1.2e-3 is left, of amplitudes below 0.05.
const FARTHEST: f32 = 0.34;

/// Over the last so much of it waves fade.
const FADING: f32 = 0.15;

/// The highest frequency along each coordinate, in cycles per primitive cell.
const HIGHEST: i32 = 28;

/// How many waves cost as much as a node of the integral over what the coordinates share.
const WAVES_A_NODE: f32 = 12.0;

/// The waves of a function of two coordinates and of its square, both even around a point.
pub(crate) struct Spectrum {
    /// That point.
    middle: [f32; 2],
    shear: Shear,
    /// By frequency along x, from 0, and along y, from −[`HIGHEST`], in the coordinates of the shear: the
    /// integral over the unit cell times cos 2π(kx + ly), of the function and of its square.
    rows: Vec<f32>,
}

/// What makes the unit cell primitive: the waves of a cell that itself repeats at other places than its
/// corners are those of the frequencies (k, `lean` · k + `tall` · l), and those of a unit cell in
/// (x + lean · y, tall · y).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shear {
    pub(crate) lean: i32,
    pub(crate) tall: i32,
}

impl Spectrum {
    /// From the coefficients of the function and of its square at a frequency, around the middle.
    pub(crate) fn of(
        middle: [f64; 2],
        shear: Shear,
        coefficients: impl Fn(f64, f64) -> [f64; 2],
    ) -> Self {
        let mut rows = Vec::new();
        for k in 0..=HIGHEST {
            for l in -HIGHEST..=HIGHEST {
                let both = coefficients(k.into(), (shear.lean * k + shear.tall * l).into());
                rows.extend(both.map(|x| x as f32));
            }
        }
        Self {
            middle: middle.map(|x| x as f32),
            shear,
            rows,
        }
    }

    /// A function of x, y, Σ and how many nodes the series competes with: the mean and its derivatives, then
    /// the mean of the square, and whether the series serves; it is all 0 where it does not.
    pub(crate) fn function(&self, module: &mut Module, of: Wanted) -> FunctionRef {
        let table = module.table("waves", self.rows.clone());
        let row = row(module, table, of);
        let mut builder = Builder::new("pattern_waves", "A pattern by its waves.");
        let b = &mut builder;
        let place = ["x", "y"].map(|name| b.param_f32(name));
        let [xx, xy, yy] = ["xx", "xy", "yy"].map(|name| b.param_f32(name));
        let nodes = b.param("nodes", Type::U32);
        let [dx, dy] = [0, 1].map(|i| b.offset(place[i], -self.middle[i]));
        let Shear { lean, tall } = self.shear;
        let [lean, tall] = [lean, tall].map(|v| v as f32);
        let side = b.scale(dy, lean);
        let (x, y) = (b.add(dx, side), b.scale(dy, tall));
        // Σ of (x + lean · y, tall · y).
        let (once, twice) = (b.scale(xy, 2.0 * lean), b.scale(yy, lean * lean));
        let sum = b.add(xx, once);
        let vx = b.add(sum, twice);
        let across = b.scale(yy, lean);
        let across = b.add(xy, across);
        let cross = b.scale(across, tall);
        let vy = b.scale(yy, tall * tall);
        let (both, square) = (b.mul(vx, vy), b.square(cross));
        let area = b.sub(both, square);
        let least = b.f32(1e-20);
        let area = b.max(area, least);
        // The ellipse reaches √(½ Σ⁻¹₁₁) along k, and √(½ Σ⁻¹₂₂) along l.
        let inverse = {
            let half = b.f32(FARTHEST);
            b.div(half, area)
        };
        let [highest, other] = [vy, vx].map(|v| {
            let square = b.mul(v, inverse);
            b.sqrt(square)
        });
        let limit = b.f32((HIGHEST + 1) as f32);
        let (within, also) = (b.lt(highest, limit), b.lt(other, limit));
        let within = b.and(within, also);
        // Half of the ellipse holds (π/2) · ½/√det Σ waves.
        let root = b.sqrt(area);
        let nodes = b.float_u(nodes);
        let worth = b.scale(
            nodes,
            WAVES_A_NODE / (0.5 * std::f32::consts::PI * FARTHEST),
        );
        let worth = b.mul(worth, root);
        let one = b.f32(1.0);
        let few = b.lt(one, worth);
        let serves = b.and(within, few);
        let last = b.floor(highest);
        let count = b.offset(last, 1.0);
        let zero = b.f32(0.0);
        let count = b.select(serves, count, zero);
        let count = b.trunc_i(count);
        let count = b.cast_u(count);
        let raised = b.offset(vy, 1e-20);
        let inverse = b.div(one, raised);
        let slope = b.mul(cross, inverse);
        let left = b.mul(area, inverse);
        let captures = [x, y, vx, cross, vy, inverse, slope, left];
        let names = names(of);
        let state = vec![zero; names.len()];
        let sums = b.fold(&row, count, &state, &captures);
        let mut parts: Vec<Value> = sums.iter().map(|&sum| b.add(sum, sum)).collect();
        let constant = |i: usize| self.rows[2 * HIGHEST as usize + i];
        for (i, at) in [(0, Some(0)), (1, of.squared.then_some(of.orders))] {
            if let Some(at) = at {
                let whole = b.offset(parts[at], constant(i));
                parts[at] = b.select(serves, whole, zero);
            }
        }
        // ∂x is ∂x′, ∂y is lean · ∂x′ + tall · ∂y′.
        if of.orders > 1 {
            let (dx, dy) = (parts[1], parts[2]);
            parts[2] = sheared(b, [dx, dy], [lean, tall]);
        }
        if of.orders > 3 {
            let [xx, xy, yy] = [parts[3], parts[4], parts[5]];
            let (p, q) = (
                sheared(b, [xx, xy], [lean, tall]),
                sheared(b, [xy, yy], [lean, tall]),
            );
            parts[4] = p;
            parts[5] = sheared(b, [p, q], [lean, tall]);
        }
        for (name, part) in names.iter().zip(parts) {
            b.result(*name, part);
        }
        b.result("serves", serves);
        builder.finish(module)
    }
}

fn sheared(b: &mut Builder, [x, y]: [Value; 2], [lean, tall]: [f32; 2]) -> Value {
    let (x, y) = (b.scale(x, lean), b.scale(y, tall));
    b.add(x, y)
}

/// The waves of one more frequency along x, the body of a fold: of frequency 0, those that rise along y.
fn row(module: &mut Module, table: u32, of: Wanted) -> FunctionRef {
    let wave = wave(module, table, of);
    let names = names(of);
    let mut builder = Builder::new("pattern_row", "The waves of one more frequency along x.");
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let state: Vec<Value> = names.iter().map(|name| b.param_f32(*name)).collect();
    let [x, y, vx, cross, vy] = ["x", "y", "xx", "xy", "yy"].map(|name| b.param_f32(name));
    let [inverse, slope, left] = ["inverse", "slope", "left"].map(|name| b.param_f32(name));
    let k = b.float_u(index);
    // kᵀΣk = left · k² + yy (l + slope · k)².
    let square = b.square(k);
    let used = b.mul(left, square);
    let farthest = b.f32(FARTHEST);
    let rest = b.sub(farthest, used);
    let zero = b.f32(0.0);
    let rest = b.max(rest, zero);
    let rest = b.mul(rest, inverse);
    let half = b.sqrt(rest);
    let middle = b.mul(slope, k);
    let (low, high) = (b.add(half, middle), b.sub(half, middle));
    let (low, last) = (b.floor(low), b.floor(high));
    let first = b.neg(low);
    let (none, start) = (b.u32(0), b.f32(1.0));
    let own = b.eq_u(index, none);
    let first = b.select(own, start, first);
    let limit = b.f32(HIGHEST as f32);
    let (low, last) = (b.f32(-(HIGHEST as f32)), b.min(last, limit));
    let first = b.max(first, low);
    let count = b.sub(last, first);
    let count = b.offset(count, 1.0);
    let count = b.clamp(count, 0.0, (2 * HIGHEST + 1) as f32);
    let count = b.trunc_i(count);
    let count = b.cast_u(count);
    let captures = [k, first, x, y, vx, cross, vy];
    let sums = b.fold(&wave, count, &state, &captures);
    for (name, sum) in names.iter().zip(sums) {
        b.result(*name, sum);
    }
    builder.finish(module)
}

/// One more wave, the body of a fold.
fn wave(module: &mut Module, table: u32, of: Wanted) -> FunctionRef {
    let names = names(of);
    let mut builder = Builder::new("pattern_wave", "One more wave of a pattern.");
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let state: Vec<Value> = names.iter().map(|name| b.param_f32(*name)).collect();
    let [k, first] = ["k", "first"].map(|name| b.param_f32(name));
    let place = ["x", "y"].map(|name| b.param_f32(name));
    let [xx, xy, yy] = ["xx", "xy", "yy"].map(|name| b.param_f32(name));
    let step = b.float_u(index);
    let l = b.add(first, step);
    // The row and the place in it, of pairs.
    let row = b.scale(k, (2 * HIGHEST + 1) as f32);
    let entry = b.offset(l, HIGHEST as f32);
    let entry = b.add(row, entry);
    let entry = b.scale(entry, 2.0);
    let entry = b.trunc_i(entry);
    let entry = b.cast_u(entry);
    let (px, py) = (b.dot(&[xx, xy], &[k, l]), b.dot(&[xy, yy], &[k, l]));
    let form = b.dot(&[k, l], &[px, py]);
    let exponent = b.scale(form, (-2.0 * PI * PI) as f32);
    let exponent = b.clamp(exponent, -80.0, 0.0);
    let damping = b.exp(exponent);
    // Waves come and go where their weight is 0.
    let farthest = b.f32(FARTHEST);
    let left = b.sub(farthest, form);
    let share = b.scale(left, 1.0 / (FADING * FARTHEST));
    let share = b.clamp(share, 0.0, 1.0);
    let damping = b.mul(damping, share);
    let turns = b.dot(&[k, l], &place);
    let raised = b.offset(turns, 0.5);
    let whole = b.floor(raised);
    let turns = b.sub(turns, whole);
    let [cosine, sine] = b.circle(turns).map(|part| b.mul(damping, part));
    let amplitude = b.load(table, entry);
    let value = b.mul(amplitude, cosine);
    let mut parts = vec![value];
    if of.orders > 1 {
        let slope = b.mul(amplitude, sine);
        let slope = b.scale(slope, -TAU as f32);
        parts.extend([b.mul(slope, k), b.mul(slope, l)]);
    }
    if of.orders > 3 {
        let bend = b.scale(value, (-TAU * TAU) as f32);
        let (kk, kl, ll) = (b.square(k), b.mul(k, l), b.square(l));
        parts.extend([kk, kl, ll].map(|v| b.mul(bend, v)));
    }
    if of.squared {
        let one = b.u32(1);
        let next = b.add_u(entry, one);
        let amplitude = b.load(table, next);
        parts.push(b.mul(amplitude, cosine));
    }
    for ((name, sum), part) in names.iter().zip(state).zip(parts) {
        let sum = b.add(sum, part);
        b.result(*name, sum);
    }
    builder.finish(module)
}

/// Names of the moments.
pub(crate) fn names(of: Wanted) -> Vec<&'static str> {
    let all = ["mean", "dx", "dy", "dxx", "dxy", "dyy"];
    let mut names = all[..of.orders].to_vec();
    names.extend(of.squared.then_some("square"));
    names
}
