//! Sparse convolution with Gabor kernels, filtered exactly by any Gaussian footprint.
//!
//! One impulse lies at a random place of every lattice cell. Its kernel is
//! k(d) = e^{−d·d/2α²} cos(w·d + φ), of a random phase φ and a direction of w around `orientation`;
//! lengths are in cells. A Gabor kernel convolved with N(0, Σ) is a Gabor kernel: with
//! T = α²I + Σ, P = T⁻¹, C = α²ΣP and w′ = α²Pw
//!
//! ```text
//! k̄(d) = α²/√det T · e^{−½dᵀPd − ½wᵀCw} cos(w′·d + φ)
//! ```
//!
//! so mean, gradient and Hessian of the sum are exact. Over random impulses the sum has variance 1;
//! what the filter removes beyond the derivatives is the ensemble's (the impulses' own would be
//! better by less than a tenth: MATH §8), but for what the value says of the Hessian.

mod energy;
mod impulse;

use super::bend::localized;
use super::field::{Field, Spread};
use super::window::count;
use energy::energies;
use impulse::{Kernel, row};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::{Mode, Signal};
use std::f32::consts::{PI, TAU};

/// The radius of a kernel, in standard deviations of its envelope: e^{−4.5} of the amplitude is left
/// there, and e^{−9} of the energy beyond.
const RADIUS: f32 = 3.0;

/// The most rows or columns of cells that are summed; footprints that need more fade.
const MOST: f32 = 40.0;

/// Below this share of its amplitude the noise has faded, above the other it has not begun to.
const FADE: [f32; 2] = [0.0286, 0.061];

/// What a Gabor noise is; lengths in wavelengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gabor {
    /// The bandwidth at half the amplitude, in octaves.
    pub(crate) bandwidth: f32,
    /// 1 for one direction, 0 for all.
    pub(crate) anisotropy: f32,
    /// How many impulses a kernel reaches.
    pub(crate) impulses: f32,
    /// After how many wavelengths the noise repeats; 0 for never.
    pub(crate) period: i32,
    /// Selects the impulses.
    pub(crate) seed: i32,
}

impl Gabor {
    /// The standard deviation of the envelope, in wavelengths. In frequency the kernel's amplitude
    /// is a Gaussian of standard deviation 1/(2πa) around 1, which is at half its height √(2 ln 2) of
    /// them away: at (2^b − 1)/(2^b + 1).
    pub(crate) fn width(self) -> f32 {
        let ratio = self.bandwidth.exp2();
        let half = (ratio - 1.0) / (ratio + 1.0);
        (2.0 * std::f32::consts::LN_2).sqrt() / (TAU * half)
    }

    /// How many cells a period has; 0 for none.
    pub(crate) fn cells(self) -> i32 {
        if self.period <= 0 {
            return 0;
        }
        ((self.period as f32 / self.density_cell()).round() as i32).max(1)
    }

    /// The side of a cell for as many impulses as are asked for.
    fn density_cell(self) -> f32 {
        RADIUS * self.width() * (PI / self.impulses).sqrt()
    }

    /// The side of a cell, in wavelengths: a period has a whole number of them.
    pub(crate) fn cell(self) -> f32 {
        match self.cells() {
            0 => self.density_cell(),
            cells => self.period as f32 / cells as f32,
        }
    }

    /// α: the width of the envelope in cells.
    fn alpha(self) -> f32 {
        self.width() / self.cell()
    }

    /// |w|, in radians per cell.
    fn turn(self) -> f32 {
        TAU * self.cell()
    }
}

/// Which derivatives a mode needs.
fn orders(mode: Mode) -> usize {
    match mode {
        Mode::Point | Mode::Naive | Mode::Ensemble => 1,
        Mode::Local => 3,
        Mode::Quad => 6,
    }
}

/// The filtered noise at a position in cells, of unit variance: its real part, and where `complex`
/// the imaginary part too, in which sines stand for cosines. `orientation` is a unit vector.
pub(crate) fn filtered(
    lower: &mut Lower<'_>,
    position: &[Signal],
    gabor: Gabor,
    orientation: [Value; 2],
    complex: bool,
) -> Vec<Field> {
    let mode = lower.mode();
    let spread = Spread::of(lower.b(), position);
    let size = lower.b().sqrt(spread.eigenvalues[0]);
    let size = lower.b().scale(size, gabor.cell());
    lower.source_footprint(size);
    let key = format!("gabor {mode:?} {complex} {gabor:?}");
    let function = lower.function(&key, |module| build(module, mode, gabor, complex));
    let b = lower.b();
    let mut arguments = Vec::new();
    for axis in position {
        // The lattice needs a cell and a fraction, whatever the position carries.
        let (cell, fraction) = match axis.cell {
            Some(cell) => (cell, axis.mean),
            None => {
                let whole = b.floor(axis.mean);
                let fraction = b.sub(axis.mean, whole);
                (b.trunc_i(whole), fraction)
            }
        };
        arguments.extend([cell, fraction]);
    }
    arguments.extend(orientation);
    if mode.filters() {
        arguments.extend(spread.covariance);
        arguments.extend(spread.eigenvalues);
    }
    let results = b.call(&function, &arguments);
    let zero = b.f32(0.0);
    let orders = orders(mode);
    let parts = if complex { 2 } else { 1 };
    let rest = |part: usize| results.get(parts * orders + part).copied().unwrap_or(zero);
    (0..parts)
        .map(|part| {
            let at = |i: usize| {
                if i < orders {
                    results[part * orders + i]
                } else {
                    zero
                }
            };
            Field {
                mean: at(0),
                gradient: [at(1), at(2)],
                hessian: [at(3), at(4), at(5)],
                rest: rest(part),
            }
        })
        .collect()
}

/// How many rows and columns an unfiltered kernel needs: its diameter, and half a cell on average
/// for the place of an impulse within its cell.
fn least(gabor: Gabor) -> f32 {
    (2.0 * RADIUS * gabor.alpha() + 0.5).ceil().min(MOST)
}

/// The sums over all impulses, as a function of the module.
fn build(module: &mut Module, mode: Mode, gabor: Gabor, complex: bool) -> FunctionRef {
    let kernel = Kernel {
        orders: orders(mode),
        complex,
        filtered: mode.filters(),
        gabor,
    };
    let row = row(module, kernel);
    let mut b = Builder::new("gabor", "A sum of filtered Gabor kernels.");
    let cell_x = b.param("cell_x", Type::I32);
    let x = b.param_f32("x");
    let cell_y = b.param("cell_y", Type::I32);
    let y = b.param_f32("y");
    let orientation = [b.param_f32("cosine"), b.param_f32("sine")];
    let seed = b.u32(gabor.seed as u32 ^ 0x6a09_e667);
    let seed = b.scramble(seed);
    let alpha = gabor.alpha();
    // The kernels' variance is πα²/2 a cell.
    let unit = (2.0 / (PI * alpha * alpha)).sqrt();
    if !mode.filters() {
        let side = b.f32(least(gabor));
        let whole = b.u32(least(gabor) as u32);
        let zero = b.f32(0.0);
        let start = impulse::window(&mut b, y, side);
        let mut captures = vec![start, side, whole, zero, cell_x, cell_y, x, y, seed];
        captures.extend(orientation);
        let init = vec![zero; kernel.sums()];
        let sums = b.fold(&row, whole, &init, &captures);
        for (i, sum) in sums.into_iter().enumerate() {
            let sum = b.scale(sum, unit);
            b.result(format!("part_{i}"), sum);
        }
        return b.finish(module);
    }
    let [s_xx, s_xy, s_yy] = ["s_xx", "s_xy", "s_yy"].map(|name| b.param_f32(name));
    let eigenvalues = [b.param_f32("s_major"), b.param_f32("s_minor")];
    let (one, zero) = (b.f32(1.0), b.f32(0.0));
    let area = alpha * alpha;

    // T = α²I + Σ, P = T⁻¹, and what the waves lose: C = α²ΣP = α²I − α⁴P.
    let (t_xx, t_yy) = (b.offset(s_xx, area), b.offset(s_yy, area));
    let shares = eigenvalues.map(|s| {
        let y = b.scale(s, 1.0 / area);
        b.offset(y, 1.0)
    });
    let product = b.mul(shares[0], shares[1]);
    let determinant = b.scale(product, area * area);
    let inverse = b.div(one, determinant);
    let (p_xx, p_yy) = (b.mul(t_yy, inverse), b.mul(t_xx, inverse));
    let p_xy = b.mul(s_xy, inverse);
    let p_xy = b.neg(p_xy);
    let p = [p_xx, p_xy, p_yy];
    // ΣP without the difference: (Σ + det Σ/α² I)/(α² (1 + y₁)(1 + y₂)).
    let both = b.mul(eigenvalues[0], eigenvalues[1]);
    let both = b.scale(both, 1.0 / area);
    let scale = b.scale(inverse, area * area);
    let c = [s_xx, s_xy, s_yy].map(|s| b.mul(s, scale));
    let diagonal = b.mul(both, scale);
    let c = [b.add(c[0], diagonal), c[1], b.add(c[2], diagonal)];

    // What is left of the noise, and how far its kernels reach: R² = R₀² + ln F in units of T.
    let root = b.sqrt(inverse);
    let share = b.scale(root, area);
    let ([f, v1, v2], slopes) = energies(&mut b, gabor, orientation, c, p, share);
    let tiny = b.f32(1e-12);
    let guarded = b.max(f, tiny);
    let reach = b.ln(guarded);
    let reach = b.offset(reach, RADIUS * RADIUS);
    let reach = b.max(reach, one);
    let reach = b.sqrt(reach);
    let reach = b.add(reach, reach);
    let rows = b.sqrt(t_yy);
    let rows = b.mul(rows, reach);
    let rows = b.offset(rows, 0.49);
    let ratio = b.div(determinant, t_yy);
    let columns = b.sqrt(ratio);
    let columns = b.mul(columns, reach);
    let shear = b.div(s_xy, t_yy);
    let lean = b.abs(shear);
    let columns = b.add(columns, lean);
    let columns = b.offset(columns, 0.49);
    let needed = b.max(rows, columns);
    // Where nothing is filtered the window is that of the point function.
    let calm = least(gabor);
    let near = b.f32(0.05 * area);
    let still = b.lt(eigenvalues[0], near);
    let lowest = b.f32(calm);
    let (full_rows, full_columns) = (b.max(rows, lowest), b.max(columns, lowest));
    let rows = b.select(still, full_rows, rows);
    let columns = b.select(still, full_columns, columns);
    let [[rows, row_count], [columns, column_count]] =
        [rows, columns].map(|needed| count(&mut b, needed, [1.0, MOST]));

    // It fades to nothing before it is dropped.
    let amplitude = b.sqrt(guarded);
    let ramp = |b: &mut Builder, x: Value, low: f32, high: f32| {
        let x = b.offset(x, -low);
        let x = b.scale(x, 1.0 / (high - low));
        b.clamp(x, 0.0, 1.0)
    };
    let by_amplitude = ramp(&mut b, amplitude, FADE[0], FADE[1]);
    let by_reach = ramp(&mut b, needed, MOST, MOST * 0.8);
    let fade = b.mul(by_amplitude, by_reach);
    let gone = b.le(fade, zero);
    let none = b.u32(0);
    let row_count = b.select(gone, none, row_count);
    let start = impulse::window(&mut b, y, rows);
    let mut captures = vec![
        start,
        columns,
        column_count,
        shear,
        cell_x,
        cell_y,
        x,
        y,
        seed,
    ];
    captures.extend(orientation);
    captures.extend(p);
    captures.extend(c);
    let init = vec![zero; kernel.sums()];
    let sums = b.fold(&row, row_count, &init, &captures);

    // α²/√det T, and P on the sums: ∇ = −P G, Hess = P S P − P M.
    let weight = b.scale(share, unit);
    let weight = b.mul(weight, fade);
    let rows = [[p_xx, p_xy], [p_xy, p_yy]];
    for (k, part) in sums.chunks(kernel.orders).enumerate() {
        let part: Vec<Value> = part.iter().map(|&sum| b.mul(sum, weight)).collect();
        let mut results = vec![part[0]];
        if kernel.orders > 1 {
            for row in &rows {
                let gradient = b.dot(row, &part[1..3]);
                results.push(b.neg(gradient));
            }
        }
        if kernel.orders > 3 {
            let [s11, s12, s22] = [part[3], part[4], part[5]];
            for (i, j) in [(0, 0), (0, 1), (1, 1)] {
                let left = b.dot(&[s11, s12], &rows[j]);
                let right = b.dot(&[s12, s22], &rows[j]);
                let bent = b.dot(&rows[i], &[left, right]);
                let own = b.mul(rows[i][j], part[0]);
                results.push(b.sub(bent, own));
            }
        }
        for (i, result) in results.into_iter().enumerate() {
            b.result(format!("part_{k}_{i}"), result);
        }
    }
    if mode.spreads() {
        let rest = remainder(&mut b, mode, [f, v1, v2], fade);
        let s = [s_xx, s_xy, s_yy];
        for part in 0..kernel.sums() / kernel.orders {
            let mut rest = rest;
            if mode == Mode::Local {
                let mean = b.mul(sums[part * kernel.orders], weight);
                rest = localized(&mut b, rest, mean, f, slopes, s);
            }
            b.result(format!("rest_{part}"), rest);
        }
    }
    b.finish(module)
}

/// What the filter removed, V = 1 − F, less what the mode carries of it, plus what fading drops.
/// V − V₁ is at least V₂; below 4e-7 it is rounding.
fn remainder(b: &mut Builder, mode: Mode, [f, v1, v2]: [Value; 3], fade: Value) -> Value {
    let (one, zero) = (b.f32(1.0), b.f32(0.0));
    let lost = b.sub(one, f);
    let carried = match mode {
        Mode::Local => v1,
        Mode::Quad => b.add(v1, v2),
        _ => zero,
    };
    let left = b.sub(lost, carried);
    let left = b.offset(left, -4e-7);
    let least = if mode == Mode::Local { v2 } else { zero };
    let left = b.max(left, least);
    let left = b.max(left, zero);
    let kept = b.sub(one, fade);
    let dropped = b.square(kept);
    let dropped = b.mul(dropped, f);
    let square = b.square(fade);
    let uncarried = b.sub(one, square);
    let back = b.mul(uncarried, carried);
    let left = b.add(left, back);
    b.add(left, dropped)
}
