//! Patterns that repeat along two coordinates as Fourier series.
//!
//! A Gaussian footprint damps a wave of the frequency k by e^{−2π²kᵀΣk}, whatever its direction: what is
//! left lies within an ellipse of frequencies, kᵀΣk ≤ s, of the area πs/√det Σ, and is summed row by row.

use super::wanted::{Wanted, names};
use super::waves::{damping, derivatives, phase};
use mipless_codegen::ir::{Builder, Float, FunctionRef, Module, Numbers, Sym2, Vec2};

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
    fn along<'b>(
        &self,
        axis: usize,
        frequency: Float<'b>,
        parameters: &[Float<'b>],
    ) -> Vec<[Float<'b>; 2]>;
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
    fn along<'b>(
        &self,
        axis: usize,
        frequency: Float<'b>,
        parameters: &[Float<'b>],
    ) -> Vec<[Float<'b>; 2]> {
        match self.amplitudes {
            Amplitudes::Known => Vec::new(),
            Amplitudes::Products(factors) => factors.along(axis, frequency, parameters),
        }
    }

    /// The amplitudes of the function and of its square, from the numbers of a frequency.
    fn amplitudes<'b>(
        &self,
        numbers: &[Float<'b>],
        x: &[[Float<'b>; 2]],
        y: &[[Float<'b>; 2]],
    ) -> [Float<'b>; 2] {
        match self.amplitudes {
            Amplitudes::Known => [numbers[0], numbers[1]],
            Amplitudes::Products(_) => [0, 1].map(|part| {
                let factors = x.iter().zip(y).map(|(x, y)| x[part] * y[part]);
                let terms = numbers
                    .iter()
                    .zip(factors)
                    .map(|(&number, product)| number * product);
                numbers[0].builder().sum(terms)
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
        let b = &Builder::new("pattern_waves", "A pattern by its waves.");
        let place = b.float_params(["x", "y"]);
        let [xx, xy, yy] = b.float_params(["xx", "xy", "yy"]);
        let nodes = b.uint_param("nodes");
        let parameters = declared(b, known);
        let [dx, dy] = [0, 1].map(|i| place[i] + -self.middle[i]);
        let [lean, tall] = [self.shear.lean, self.shear.tall].map(|v| v as f32);
        let (x, y) = (dx + dy * lean, dy * tall);

        // Σ of (x + lean · y, tall · y).
        let vx = xx + xy * (2.0 * lean) + yy * (lean * lean);
        let cross = (xy + yy * lean) * tall;
        let vy = yy * (tall * tall);
        let area = (vx * vy - cross.square()).max(1e-20);

        // The ellipse reaches √(s Σ⁻¹₁₁) along k, and √(s Σ⁻¹₂₂) along l.
        let inverse = FARTHEST / area;
        let [highest, other] = [vy, vx].map(|v| (v * inverse).sqrt());
        let limit = (HIGHEST + 1) as f32;
        let within = highest.lt(limit) & other.lt(limit);
        // Half of the ellipse holds (π/2) · s/√det Σ waves.
        let waves = match self.amplitudes {
            Amplitudes::Known => WAVES_A_NODE,
            Amplitudes::Products(_) => WAVES_A_NODE * LIVE,
        };
        let worth = nodes.to_float() * (waves / (0.5 * std::f32::consts::PI * FARTHEST));
        let few = (worth * area.sqrt()).gt(1.0);
        let serves = within & few;
        let count = serves.select(highest.floor() + 1.0, 0.0).to_int().to_uint();

        // The waves, of which the other half is the same.
        let inverse = 1.0 / (vy + 1e-20);
        let ellipse = [inverse, cross * inverse, area * inverse];
        let live = unknown(&parameters, known);
        let names = names(of);
        let start = vec![b.float(0.0); names.len()];
        let captures = ([x, y, vx, cross, vy], ellipse, live);
        let sums = b.fold(&row, count, start, captures);
        let mut parts: Vec<Float<'_>> = sums.into_iter().map(|sum| sum + sum).collect();
        let numbers: Vec<Float<'_>> = self.still.iter().map(|&x| b.float(x)).collect();
        let [still_x, still_y] = [0, 1].map(|axis| self.along(axis, b.float(0.0), &parameters));
        let [mean, square] = self.amplitudes(&numbers, &still_x, &still_y);
        for (still, at) in [(mean, Some(0)), (square, of.squared.then_some(of.orders))] {
            if let Some(at) = at {
                parts[at] = serves.select(parts[at] + still, 0.0);
            }
        }
        // ∂x is ∂x′, ∂y is lean · ∂x′ + tall · ∂y′.
        if of.orders > 1 {
            parts[2] = sheared([parts[1], parts[2]], [lean, tall]);
        }
        if of.orders > 3 {
            let [xx, xy, yy] = [parts[3], parts[4], parts[5]];
            parts[4] = sheared([xx, xy], [lean, tall]);
            let across = sheared([xy, yy], [lean, tall]);
            parts[5] = sheared([parts[4], across], [lean, tall]);
        }
        b.results(names.iter().copied(), parts);
        b.result("serves", serves);
        b.finish(module)
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
        let b = &Builder::new("pattern_row", "The waves of one more frequency along x.");
        let index = b.uint_param("index");
        let state: Vec<Float<'_>> = names.iter().map(|name| b.float_param(*name)).collect();
        let place = b.float_params(["x", "y"]);
        let covariance = b.float_params(["xx", "xy", "yy"]);
        let [inverse, slope, left] = b.float_params(["inverse", "slope", "left"]);
        let parameters = declared(b, known);
        let k = index.to_float();

        // kᵀΣk = left · k² + yy (l + slope · k)².
        let rest = (FARTHEST - left * k.square()).max(0.0);
        let half = (rest * inverse).sqrt();
        let middle = slope * k;
        let first = -(half + middle).floor();
        let last = (half - middle).floor();
        let first = index.equals(0).select(1.0, first);
        let first = first.max(-(HIGHEST as f32));
        let last = last.min(HIGHEST as f32);
        let count = (last - first + 1.0).clamp(0.0, (2 * HIGHEST + 1) as f32);
        let factors = self.along(0, k, &parameters);
        let live = unknown(&parameters, known);
        let captures = (k, first, place, covariance, factors, live);
        let sums = b.fold(&wave, count.to_int().to_uint(), state, captures);
        b.results(names.iter().copied(), sums);
        b.finish(module)
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
        let b = &Builder::new("pattern_wave", "One more wave of a pattern.");
        let index = b.uint_param("index");
        let state: Vec<Float<'_>> = names.iter().map(|name| b.float_param(*name)).collect();
        let [k, first] = b.float_params(["k", "first"]);
        let place = Vec2(b.float_params(["x", "y"]));
        let covariance = Sym2(b.float_params(["xx", "xy", "yy"]));
        let products = match self.amplitudes {
            Amplitudes::Known => 0,
            Amplitudes::Products(factors) => factors.products(),
        };
        let x_factors: Vec<[Float<'_>; 2]> = (0..products)
            .map(|i| [2 * i, 2 * i + 1].map(|i| b.float_param(format!("factor_{i}"))))
            .collect();
        let parameters = declared(b, known);
        let l = first + index.to_float();

        // The row and the place in it.
        let entry = k * (2 * HIGHEST + 1) as f32 + (l + HIGHEST as f32);
        let entry = (entry * self.still.len() as f32).to_int().to_uint();
        let numbers: Vec<Float<'_>> = (0..self.still.len() as u32)
            .map(|i| b.load(table, entry + i))
            .collect();
        // The frequency along y in the coordinates of the cell.
        let frequency = k * self.shear.lean as f32 + l * self.shear.tall as f32;
        let y_factors = self.along(1, frequency, &parameters);
        let [amplitude, amplitude_of_square] = self.amplitudes(&numbers, &x_factors, &y_factors);

        let k = Vec2([k, l]);
        let (form, left) = damping(k, covariance);
        // Waves come and go where their weight is 0.
        let share = ((FARTHEST - form) * (1.0 / (FADING * FARTHEST))).clamp(0.0, 1.0);
        let damping = left * share;
        let turned = phase(k, place).map(|part| damping * part);
        let mut parts = derivatives(amplitude, turned, k, of.orders);
        parts.extend(of.squared.then(|| amplitude_of_square * turned[0]));
        b.sums(names.iter().copied(), state, parts);
        b.finish(module)
    }
}

/// The derivative along y of the cell, from those along the coordinates of the shear.
fn sheared<'b>([x, y]: [Float<'b>; 2], [lean, tall]: [f32; 2]) -> Float<'b> {
    x * lean + y * tall
}

/// Parameters: constants, and what is not known as parameters of a function.
pub(super) fn declared<'b>(b: &'b Builder, known: &[Option<f32>]) -> Vec<Float<'b>> {
    (known.iter().enumerate())
        .map(|(i, known)| match known {
            Some(x) => b.float(*x),
            None => b.float_param(format!("parameter_{i}")),
        })
        .collect()
}

/// Those of the values that are not known.
pub(super) fn unknown<'b>(values: &[Float<'b>], known: &[Option<f32>]) -> Vec<Float<'b>> {
    (values.iter().zip(known))
        .filter(|(_, known)| known.is_none())
        .map(|(&value, _)| value)
        .collect()
}
