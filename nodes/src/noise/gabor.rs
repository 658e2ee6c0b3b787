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
mod steep;

use super::bend::localized;
use super::cell::lattice_seed;
use super::cell::place::{called, declared, declared_spread, field, window_start};
use super::field::{Field, Spread};
use super::remainder::{remainder, share};
use super::window::count;
use energy::energies;
use impulse::{Kernel, Rows, row};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Float, FunctionRef, Module, Sym2, Vec2, dot};
use mipless_codegen::moments::{Mode, Signal};
use std::f32::consts::{PI, TAU};

pub(crate) use steep::steepness;

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
pub(crate) fn filtered<'b>(
    lower: &mut Lower<'_, 'b>,
    position: &[Signal<'b>],
    gabor: Gabor,
    orientation: Vec2<'b>,
    complex: bool,
) -> Vec<Field<'b>> {
    let mode = lower.mode();
    let spread = Spread::of(position);
    lower.source_footprint(spread.eigenvalues[0].sqrt() * gabor.cell());
    let key = format!("gabor {mode:?} {complex} {gabor:?}");
    let function = lower.function(&key, |module| build(module, mode, gabor, complex));
    let results = called(lower, &function, (position, &spread), orientation);
    let parts = if complex { 2 } else { 1 };
    let (fields, rests) = results.split_at(parts * orders(mode));
    (fields.chunks(orders(mode)).enumerate())
        .map(|(part, numbers)| field(numbers, rests.get(part).copied()))
        .collect()
}

/// How many rows and columns an unfiltered kernel needs: its diameter, and half a cell on average
/// for the place of an impulse within its cell.
fn least(gabor: Gabor) -> f32 {
    (2.0 * RADIUS * gabor.alpha() + 0.5).ceil().min(MOST)
}

/// wᵀMw.
fn form<'b>(w: Vec2<'b>, m: Sym2<'b>) -> Float<'b> {
    let [xx, xy, yy] = *w.outer();
    dot([xx, xy + xy, yy], *m)
}

/// PMP.
fn congruent<'b>(p: Sym2<'b>, m: Sym2<'b>) -> Sym2<'b> {
    let rows = [Vec2([p[0], p[1]]), Vec2([p[1], p[2]])];
    Sym2([(0, 0), (0, 1), (1, 1)].map(|(i, j)| rows[i].dot(m.times(rows[j]))))
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
    let b = &Builder::new("gabor", "A sum of filtered Gabor kernels.");
    let ([cell_x, cell_y], [x, y]) = declared(b);
    let orientation = Vec2(b.float_params(["cosine", "sine"]));
    let seed = lattice_seed(b, gabor.seed, 0x6a09_e667);
    let before = vec![b.float(0.0); kernel.sums()];
    let alpha = gabor.alpha();
    // The kernels' variance is πα²/2 a cell.
    let unit = (2.0 / (PI * alpha * alpha)).sqrt();
    if !mode.filters() {
        let (side, count) = (b.float(least(gabor)), b.uint(least(gabor) as u32));
        let rows = Rows {
            start_y: window_start(y, side),
            columns: side,
            column_count: count,
            shear: b.float(0.0),
            cell_x,
            cell_y,
            x,
            y,
            seed,
        };
        let sums = b.fold(&row, count, before, (rows, orientation));
        for (i, sum) in sums.into_iter().enumerate() {
            b.result(format!("part_{i}"), sum * unit);
        }
        return b.finish(module);
    }
    let Spread {
        covariance: s,
        eigenvalues: [s_major, s_minor],
    } = declared_spread(b);
    let area = alpha * alpha;

    // T = α²I + Σ, P = T⁻¹, and what the waves lose: C = α²ΣP = α²I − α⁴P.
    let (t_xx, t_yy) = (s[0] + area, s[2] + area);
    let [more, less] = [s_major, s_minor].map(|s| s * (1.0 / area) + 1.0);
    let determinant = more * less * (area * area);
    let inverse = 1.0 / determinant;
    let p = Sym2([t_yy * inverse, -(s[1] * inverse), t_xx * inverse]);
    // ΣP without the difference: (Σ + det Σ/α² I)/(α² (1 + y₁)(1 + y₂)).
    let scale = inverse * (area * area);
    let diagonal = s_major * s_minor * (1.0 / area) * scale;
    let [c_xx, c_xy, c_yy] = *(s * scale);
    let c = Sym2([c_xx + diagonal, c_xy, c_yy + diagonal]);

    // What is left of the noise, and how far its kernels reach: R² = R₀² + ln F in units of T.
    let strength = inverse.sqrt() * area;
    let ([f, v1, v2], slopes) = energies(gabor, orientation, c, p, strength);
    let guarded = f.max(1e-12);
    let radius = (guarded.ln() + RADIUS * RADIUS).max(1.0).sqrt();
    let diameter = radius + radius;
    let shear = s[1] / t_yy;
    let rows = t_yy.sqrt() * diameter + 0.49;
    let columns = (determinant / t_yy).sqrt() * diameter + shear.abs() + 0.49;
    let needed = rows.max(columns);
    // Where nothing is filtered the window is that of the point function.
    let still = s_major.lt(0.05 * area);
    let [(rows, row_count), (columns, column_count)] = [rows, columns].map(|needed| {
        let needed = still.select(needed.max(least(gabor)), needed);
        count(needed, [1.0, MOST])
    });

    // It fades to nothing before it is dropped.
    let by_amplitude = share(guarded.sqrt(), FADE[0], FADE[1]);
    let fade = by_amplitude * share(needed, MOST, MOST * 0.8);
    let row_count = fade.le(0.0).select(0u32, row_count);
    let rows = Rows {
        start_y: window_start(y, rows),
        columns,
        column_count,
        shear,
        cell_x,
        cell_y,
        x,
        y,
        seed,
    };
    let sums = b.fold(&row, row_count, before, (rows, (orientation, p, c)));

    // α²/√det T, and P on the sums: ∇ = −P G, Hess = P S P − P M.
    let weight = strength * unit * fade;
    for (k, part) in sums.chunks(kernel.orders).enumerate() {
        let part: Vec<Float<'_>> = part.iter().map(|&sum| sum * weight).collect();
        let mut results = vec![part[0]];
        if let [_, gx, gy, ..] = part[..] {
            results.extend(-p.times(Vec2([gx, gy])));
        }
        if let [_, _, _, xx, xy, yy] = part[..] {
            results.extend(congruent(p, Sym2([xx, xy, yy])) - p * part[0]);
        }
        for (i, result) in results.into_iter().enumerate() {
            b.result(format!("part_{k}_{i}"), result);
        }
    }
    if !mode.spreads() {
        return b.finish(module);
    }
    let rest = match mode {
        // A second order that carries nothing: roundings are taken off here too.
        Mode::Ensemble => {
            let none = b.float(0.0);
            remainder(Mode::Quad, [f, none, none], fade)
        }
        _ => remainder(mode, [f, v1, v2], fade),
    };
    for (part, sums) in sums.chunks(kernel.orders).enumerate() {
        let rest = match mode {
            Mode::Local => localized(rest, sums[0] * weight, f, slopes, s),
            _ => rest,
        };
        b.result(format!("rest_{part}"), rest);
    }
    b.finish(module)
}
