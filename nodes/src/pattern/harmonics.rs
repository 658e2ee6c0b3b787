//! Patterns that repeat along two coordinates as Fourier series.
//!
//! A Gaussian footprint damps a wave of the frequency k by e^{−2π²kᵀΣk}, whatever its direction: what is
//! left lies within an ellipse of frequencies, kᵀΣk ≤ s, of the area πs/√det Σ, and is summed row by row.

use super::wanted::{Wanted, names};
use mipless_codegen::ir::{Builder, FunctionRef, Module, Numbers, Type, Value};
use std::f64::consts::{PI, TAU};

/// The largest kᵀΣk of a wave that is summed: of others 1.2e-3 is left, of amplitudes below 0.05.
const FARTHEST: f32 = 0.34;

/// Over the last so much of it waves fade.
const FADING: f32 = 0.15;

/// The highest frequency along each coordinate, in cycles per primitive cell.
const HIGHEST: i32 = 28;

/// How many waves cost as much as a node of the integral over what the coordinates share.
const WAVES_A_NODE: f32 = 12.0;

/// The share of these where amplitudes depend on live parameters.
const LIVE: f32 = 0.35;

/// The waves of a function of two coordinates and of its square, both even around a point.
pub(crate) struct Spectrum<'a> {
    /// That point.
    middle: [f32; 2],
    shear: Shear,
    /// By frequency along x, from 0, and along y, from −[`HIGHEST`], in the coordinates of the shear: what
    /// [`Amplitudes`] makes of it. Computed when a shader runs.
    rows: Numbers,
    /// Those of frequency 0.
    still: Vec<f32>,
    amplitudes: Amplitudes<'a>,
}

/// What the numbers of a frequency are.
enum Amplitudes<'a> {
    /// The integral over the unit cell times cos 2π(kx + ly), of the function and of its square.
    Known,
    /// The coefficients of products of factors.
    Products(&'a dyn Factors),
}

/// Amplitudes that depend on live parameters: Σ c · X(k) · Y(l).
pub(crate) trait Factors {
    /// How many products.
    fn products(&self) -> usize;

    /// The factor of a frequency along a coordinate in each product, for the function and its square.
    fn along(
        &self,
        b: &mut Builder,
        axis: usize,
        frequency: Value,
        parameters: &[Value],
    ) -> Vec<[Value; 2]>;
}

/// What makes the unit cell primitive: the waves of a cell that itself repeats at other places than its
/// corners are those of the frequencies (k, `lean` · k + `tall` · l), and those of a unit cell in
/// (x + lean · y, tall · y).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shear {
    pub(crate) lean: i32,
    pub(crate) tall: i32,
}

impl<'a> Spectrum<'a> {
    /// From the coefficients of the function and of its square at a frequency, around the middle.
    pub(crate) fn known(
        middle: [f64; 2],
        shear: Shear,
        coefficients: impl Fn([f64; 2]) -> Vec<f64> + Send + Sync + 'static,
    ) -> Self {
        Self::of(middle, shear, Amplitudes::Known, coefficients)
    }

    /// From factors, and their coefficients at a frequency.
    pub(crate) fn of_factors(
        middle: [f64; 2],
        shear: Shear,
        factors: &'a dyn Factors,
        coefficients: impl Fn([f64; 2]) -> Vec<f64> + Send + Sync + 'static,
    ) -> Self {
        Self::of(middle, shear, Amplitudes::Products(factors), coefficients)
    }

    fn of(
        middle: [f64; 2],
        shear: Shear,
        amplitudes: Amplitudes<'a>,
        coefficients: impl Fn([f64; 2]) -> Vec<f64> + Send + Sync + 'static,
    ) -> Self {
        let at = move |k: i32, l: i32| {
            let frequency = [k, shear.lean * k + shear.tall * l].map(f64::from);
            coefficients(frequency).into_iter().map(|x| x as f32)
        };
        let still: Vec<f32> = at(0, 0).collect();
        let frequencies = (HIGHEST + 1) * (2 * HIGHEST + 1);
        let rows = Numbers::lazy(frequencies as usize * still.len(), move || {
            let all = (0..=HIGHEST).flat_map(|k| (-HIGHEST..=HIGHEST).map(move |l| (k, l)));
            all.flat_map(|(k, l)| at(k, l)).collect()
        });
        Self {
            middle: middle.map(|x| x as f32),
            shear,
            rows,
            still,
            amplitudes,
        }
    }

    /// Factors of a frequency along a coordinate, one after the other; none where amplitudes are known.
    fn along(
        &self,
        b: &mut Builder,
        axis: usize,
        frequency: Value,
        parameters: &[Value],
    ) -> Vec<Value> {
        match self.amplitudes {
            Amplitudes::Known => Vec::new(),
            Amplitudes::Products(factors) => {
                let factors = factors.along(b, axis, frequency, parameters);
                factors.into_iter().flatten().collect()
            }
        }
    }

    /// The amplitudes of the function and of its square, from the numbers of a frequency.
    fn amplitudes(
        &self,
        b: &mut Builder,
        numbers: &[Value],
        x: &[Value],
        y: &[Value],
    ) -> [Value; 2] {
        match self.amplitudes {
            Amplitudes::Known => [numbers[0], numbers[1]],
            Amplitudes::Products(_) => [0, 1].map(|part| {
                let mut sum = b.f32(0.0);
                for (i, &coefficient) in numbers.iter().enumerate() {
                    let product = b.mul(x[2 * i + part], y[2 * i + part]);
                    let product = b.mul(coefficient, product);
                    sum = b.add(sum, product);
                }
                sum
            }),
        }
    }

    /// A function of x, y, Σ, how many nodes the series competes with and the parameters that are not
    /// known: the mean and its derivatives, then the mean of the square, and whether the series serves; it
    /// is all 0 where it does not.
    pub(crate) fn function(
        &self,
        module: &mut Module,
        of: Wanted,
        known: &[Option<f32>],
    ) -> FunctionRef {
        let table = module.table("waves", self.rows.clone());
        let row = self.row(module, table, of, known);
        let mut builder = Builder::new("pattern_waves", "A pattern by its waves.");
        let b = &mut builder;
        let place = ["x", "y"].map(|name| b.param_f32(name));
        let [xx, xy, yy] = ["xx", "xy", "yy"].map(|name| b.param_f32(name));
        let nodes = b.param("nodes", Type::U32);
        let parameters = declared(b, known);
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
        // The ellipse reaches √(s Σ⁻¹₁₁) along k, and √(s Σ⁻¹₂₂) along l.
        let farthest = b.f32(FARTHEST);
        let inverse = b.div(farthest, area);
        let [highest, other] = [vy, vx].map(|v| {
            let square = b.mul(v, inverse);
            b.sqrt(square)
        });
        let limit = b.f32((HIGHEST + 1) as f32);
        let (within, also) = (b.lt(highest, limit), b.lt(other, limit));
        let within = b.and(within, also);
        // Half of the ellipse holds (π/2) · s/√det Σ waves.
        let root = b.sqrt(area);
        let nodes = b.float_u(nodes);
        let waves = match self.amplitudes {
            Amplitudes::Known => WAVES_A_NODE,
            Amplitudes::Products(_) => WAVES_A_NODE * LIVE,
        };
        let worth = b.scale(nodes, waves / (0.5 * std::f32::consts::PI * FARTHEST));
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
        let mut captures = vec![x, y, vx, cross, vy, inverse, slope, left];
        captures.extend(unknown(&parameters, known));
        let names = names(of);
        let state = vec![zero; names.len()];
        let sums = b.fold(&row, count, &state, &captures);
        let mut parts: Vec<Value> = sums.iter().map(|&sum| b.add(sum, sum)).collect();
        let numbers: Vec<Value> = self.still.iter().map(|&x| b.f32(x)).collect();
        let [still_x, still_y] = [0, 1].map(|axis| self.along(b, axis, zero, &parameters));
        let [mean, square] = self.amplitudes(b, &numbers, &still_x, &still_y);
        for (still, at) in [(mean, Some(0)), (square, of.squared.then_some(of.orders))] {
            if let Some(at) = at {
                let whole = b.add(parts[at], still);
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

    /// The waves of one more frequency along x, the body of a fold: of frequency 0, those that rise along y.
    fn row(
        &self,
        module: &mut Module,
        table: u32,
        of: Wanted,
        known: &[Option<f32>],
    ) -> FunctionRef {
        let wave = self.wave(module, table, of, known);
        let names = names(of);
        let mut builder = Builder::new("pattern_row", "The waves of one more frequency along x.");
        let b = &mut builder;
        let index = b.param("index", Type::U32);
        let state: Vec<Value> = names.iter().map(|name| b.param_f32(*name)).collect();
        let [x, y, vx, cross, vy] = ["x", "y", "xx", "xy", "yy"].map(|name| b.param_f32(name));
        let [inverse, slope, left] = ["inverse", "slope", "left"].map(|name| b.param_f32(name));
        let parameters = declared(b, known);
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
        let mut captures = vec![k, first, x, y, vx, cross, vy];
        captures.extend(self.along(b, 0, k, &parameters));
        captures.extend(unknown(&parameters, known));
        let sums = b.fold(&wave, count, &state, &captures);
        for (name, sum) in names.iter().zip(sums) {
            b.result(*name, sum);
        }
        builder.finish(module)
    }

    /// One more wave, the body of a fold.
    fn wave(
        &self,
        module: &mut Module,
        table: u32,
        of: Wanted,
        known: &[Option<f32>],
    ) -> FunctionRef {
        let names = names(of);
        let mut builder = Builder::new("pattern_wave", "One more wave of a pattern.");
        let b = &mut builder;
        let index = b.param("index", Type::U32);
        let state: Vec<Value> = names.iter().map(|name| b.param_f32(*name)).collect();
        let [k, first] = ["k", "first"].map(|name| b.param_f32(name));
        let place = ["x", "y"].map(|name| b.param_f32(name));
        let [xx, xy, yy] = ["xx", "xy", "yy"].map(|name| b.param_f32(name));
        let factors = match self.amplitudes {
            Amplitudes::Known => 0,
            Amplitudes::Products(factors) => 2 * factors.products(),
        };
        let x_factors: Vec<Value> = (0..factors)
            .map(|i| b.param_f32(format!("factor_{i}")))
            .collect();
        let parameters = declared(b, known);
        let step = b.float_u(index);
        let l = b.add(first, step);
        // The row and the place in it.
        let row = b.scale(k, (2 * HIGHEST + 1) as f32);
        let entry = b.offset(l, HIGHEST as f32);
        let entry = b.add(row, entry);
        let entry = b.scale(entry, self.still.len() as f32);
        let entry = b.trunc_i(entry);
        let entry = b.cast_u(entry);
        let numbers: Vec<Value> = (0..self.still.len() as u32)
            .map(|i| {
                let i = b.u32(i);
                let at = b.add_u(entry, i);
                b.load(table, at)
            })
            .collect();
        // The frequency along y in the coordinates of the cell.
        let (side, up) = (
            b.scale(k, self.shear.lean as f32),
            b.scale(l, self.shear.tall as f32),
        );
        let frequency = b.add(side, up);
        let y_factors = self.along(b, 1, frequency, &parameters);
        let [amplitude, amplitude_of_square] = self.amplitudes(b, &numbers, &x_factors, &y_factors);
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
        let turns = nearest(b, turns);
        let [cosine, sine] = b.circle(turns).map(|part| b.mul(damping, part));
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
            parts.push(b.mul(amplitude_of_square, cosine));
        }
        for ((name, sum), part) in names.iter().zip(state).zip(parts) {
            let sum = b.add(sum, part);
            b.result(*name, sum);
        }
        builder.finish(module)
    }
}

fn sheared(b: &mut Builder, [x, y]: [Value; 2], [lean, tall]: [f32; 2]) -> Value {
    let (x, y) = (b.scale(x, lean), b.scale(y, tall));
    b.add(x, y)
}

/// Turns less their whole part, in [−½, ½].
pub(super) fn nearest(b: &mut Builder, turns: Value) -> Value {
    let raised = b.offset(turns, 0.5);
    let whole = b.floor(raised);
    b.sub(turns, whole)
}

/// Parameters: constants, and what is not known as parameters of a function.
pub(super) fn declared(b: &mut Builder, known: &[Option<f32>]) -> Vec<Value> {
    (known.iter().enumerate())
        .map(|(i, known)| match known {
            Some(x) => b.f32(*x),
            None => b.param_f32(format!("parameter_{i}")),
        })
        .collect()
}

/// Those of the values that are not known.
pub(super) fn unknown(values: &[Value], known: &[Option<f32>]) -> Vec<Value> {
    (values.iter().zip(known))
        .filter(|(_, known)| known.is_none())
        .map(|(&value, _)| value)
        .collect()
}
