//! Lattice noise with the quadrupole kernel: a random second-order kernel at every lattice point,
//! filtered exactly by any Gaussian footprint (RULES, lattice noise).
//!
//! With T = a²I + Σ, d the offset to the lattice point, u = T⁻¹d, E = e^{−d·u/2}, θ a random angle
//! and B = [[cos θ, sin θ], [sin θ, −cos θ]]: k = uᵀBu − tr(BT⁻¹), M = Σ κ E k with
//! κ = a³/(√π √det T). The unfiltered noise has variance 1 (over random lattices).

mod energy;

use super::field::{Field, Spread};
use super::hash::direction;
use energy::energies;
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::{Mode, Signal};

/// a: the width of the kernel, in cells.
const WIDTH: f32 = 0.3854;

/// The wavelength of the dominant detail, in cells: the spectrum k⁵ e^{−a²k²} has its peak at
/// k = √2.5/a.
pub(super) const WAVELENGTH: f32 = std::f32::consts::TAU * WIDTH / 1.581_138_8;

/// Below this share of its amplitude an octave has faded, above the other it has not begun to.
const FADE: [f32; 2] = [0.0286, 0.061];

/// A kernel is dropped where its envelope is this small against the unfiltered noise.
const NEGLIGIBLE_LN: f32 = 9.66; // −2 ln 0.008

/// The most lattice rows or columns that are summed; footprints that need more fade.
const MOST: f32 = 24.0;

/// What a sum of octaves is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Octaves {
    /// How many, at least 1.
    pub(crate) count: u32,
    /// By how much of its amplitude one more is there, below 1.
    pub(crate) part: f32,
    /// By how much the frequency grows.
    pub(crate) lacunarity: f32,
    /// By how much the amplitude falls.
    pub(crate) diminish: f32,
    /// Selects the lattice.
    pub(crate) seed: i32,
}

impl Octaves {
    /// The standard deviation of the sum.
    pub(crate) fn sd(self) -> f32 {
        let whole: f32 = (0..self.count as i32)
            .map(|k| self.diminish.powi(2 * k))
            .sum();
        let part = self.part * self.diminish.powi(self.count as i32);
        (whole + part * part).sqrt()
    }

    /// The sum over octaves of a noise of variance 1; `octave` is the body of the fold over them.
    pub(super) fn sum(
        self,
        lower: &mut Lower<'_>,
        octave: &FunctionRef,
        position: &[Signal],
        spread: &Spread,
    ) -> Field {
        let mode = lower.mode();
        let b = lower.b();
        let mut init = vec![b.f32(0.0); orders(mode) + usize::from(mode.spreads())];
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
            init.push(cell);
            init.push(fraction);
        }
        let seed = b.u32(self.seed as u32);
        let seed = b.scramble(seed);
        init.extend([b.f32(1.0), b.f32(1.0), seed]);
        let mut captures = Vec::new();
        if mode != Mode::Point {
            captures.extend(spread.covariance);
            captures.extend(spread.eigenvalues);
        }
        let count = b.u32(self.count);
        let mut sums = b.fold(octave, count, &init, &captures);
        if self.part > 0.0 {
            // The state is that of the next octave; its amplitude comes before the seed.
            let amplitude = sums.len() - 2;
            sums[amplitude] = b.scale(sums[amplitude], self.part);
            let once = b.u32(1);
            sums = b.fold(octave, once, &sums, &captures);
        }
        let zero = b.f32(0.0);
        let at = |i: usize| if i < orders(mode) { sums[i] } else { zero };
        Field {
            mean: at(0),
            gradient: [at(1), at(2)],
            hessian: [at(3), at(4), at(5)],
            rest: if mode.spreads() {
                sums[orders(mode)]
            } else {
                zero
            },
        }
    }
}

/// Which derivatives a mode needs.
pub(super) fn orders(mode: Mode) -> usize {
    match mode {
        Mode::Point | Mode::Naive | Mode::Ensemble => 1,
        Mode::Local => 3,
        Mode::Quad => 6,
    }
}

/// The filtered sum of octaves at a position in cells of the first octave; unit variance of the
/// first octave.
pub(crate) fn filtered(lower: &mut Lower<'_>, position: &[Signal], octaves: Octaves) -> Field {
    let mode = lower.mode();
    let spread = Spread::of(lower.b(), position);
    let key = format!(
        "lattice {mode:?} {} {}",
        octaves.lacunarity, octaves.diminish
    );
    let octave = match mode {
        Mode::Point => lower.function(&key, |module| point_octave(module, octaves)),
        _ => lower.function(&key, |module| filtered_octave(module, mode, octaves)),
    };
    octaves.sum(lower, &octave, position, &spread)
}

/// The part of an octave's state that goes from octave to octave: position, frequency, amplitude
/// and seed.
pub(super) struct Octave {
    pub(super) cells: [Value; 2],
    pub(super) fractions: [Value; 2],
    pub(super) scale: Value,
    pub(super) amplitude: Value,
    pub(super) seed: Value,
}

impl Octave {
    pub(super) fn declare(b: &mut Builder) -> Self {
        let cell_x = b.param("cell_x", Type::I32);
        let x = b.param_f32("x");
        let cell_y = b.param("cell_y", Type::I32);
        let y = b.param_f32("y");
        Self {
            cells: [cell_x, cell_y],
            fractions: [x, y],
            scale: b.param_f32("scale"),
            amplitude: b.param_f32("amplitude"),
            seed: b.param("seed", Type::U32),
        }
    }

    /// The state of the next octave, as results.
    pub(super) fn advance(&self, b: &mut Builder, octaves: Octaves) {
        let lacunarity = b.f32(octaves.lacunarity);
        // Octaves must not share lattice points, where the variance of all is largest.
        let shift = 0.381_966 / octaves.lacunarity;
        for (i, name) in ["x", "y"].iter().enumerate() {
            let shifted = b.offset(self.fractions[i], shift);
            let start = Signal::certain(b, shifted);
            let start = Signal {
                cell: Some(self.cells[i]),
                ..start
            };
            let next = start.scale(b, lacunarity);
            b.result(
                format!("cell_{name}"),
                next.cell.expect("a position keeps its cell"),
            );
            b.result(*name, next.mean);
        }
        let scale = b.scale(self.scale, octaves.lacunarity);
        let amplitude = b.scale(self.amplitude, octaves.diminish);
        let step = b.u32(0x9e37_79b9);
        let seed = b.add_u(self.seed, step);
        b.result("scale", scale);
        b.result("amplitude", amplitude);
        b.result("seed", seed);
    }
}

/// The lattice coordinate that a window of `count` (a float) points around `x` starts at.
pub(super) fn window(b: &mut Builder, x: Value, count: Value) -> Value {
    let half = b.scale(count, -0.5);
    let start = b.add(x, half);
    let start = b.floor(start);
    b.offset(start, 1.0)
}

/// The hash of a lattice row.
pub(super) fn row_hash(b: &mut Builder, cell: Value, row: Value, seed: Value) -> Value {
    let row = b.trunc_i(row);
    let row = b.add_i(cell, row);
    let row = b.cast_u(row);
    let factor = b.u32(0x9e37_79b1);
    let row = b.mul_u(row, factor);
    b.add_u(row, seed)
}

/// The random angle of a lattice point, as cosine and sine.
fn angle(b: &mut Builder, cell: Value, column: Value, row_hash: Value) -> [Value; 2] {
    let column = b.trunc_i(column);
    let column = b.add_i(cell, column);
    let column = b.cast_u(column);
    let hash = b.xor_u(column, row_hash);
    let hash = b.scramble(hash);
    direction(b, hash)
}

/// One octave of the unfiltered noise, the body of a fold: the nearest 3×3 kernels.
fn point_octave(module: &mut Module, octaves: Octaves) -> FunctionRef {
    let row = {
        let mut b = Builder::new("lattice_row", "The unfiltered kernels of one lattice row.");
        let index = b.param("index", Type::U32);
        let sum = b.param_f32("sum");
        let start_x = b.param_f32("start_x");
        let start_y = b.param_f32("start_y");
        let cells = [b.param("cell_x", Type::I32), b.param("cell_y", Type::I32)];
        let (x, y) = (b.param_f32("x"), b.param_f32("y"));
        let seed = b.param("seed", Type::U32);
        let offset = b.float_u(index);
        let place = b.add(start_y, offset);
        let dy = b.sub(y, place);
        let y2 = b.square(dy);
        let hash = row_hash(&mut b, cells[1], place, seed);
        let mut row = b.f32(0.0);
        for column in 0..3 {
            let place = b.offset(start_x, column as f32);
            let dx = b.sub(x, place);
            let [c, s] = angle(&mut b, cells[0], place, hash);
            // E dᵀBd = E (c (x² − y²) + 2 s x y); the row's share of E comes last.
            let x2 = b.square(dx);
            let difference = b.sub(x2, y2);
            let product = b.mul(dx, dy);
            let product = b.add(product, product);
            let k = b.dot(&[c, s], &[difference, product]);
            let exponent = b.scale(x2, -0.5 / (WIDTH * WIDTH));
            let envelope = b.exp(exponent);
            let part = b.mul(envelope, k);
            row = b.add(row, part);
        }
        let exponent = b.scale(y2, -0.5 / (WIDTH * WIDTH));
        let envelope = b.exp(exponent);
        let row = b.mul(envelope, row);
        let sum = b.add(sum, row);
        b.result("sum", sum);
        b.finish(module)
    };
    let mut b = Builder::new("lattice_octave", "One more octave of the unfiltered noise.");
    b.param("index", Type::U32);
    let sum = b.param_f32("mean");
    let state = Octave::declare(&mut b);
    let [x, y] = state.fractions;
    let three = b.f32(3.0);
    let (start_x, start_y) = (window(&mut b, x, three), window(&mut b, y, three));
    let (zero, rows) = (b.f32(0.0), b.u32(3));
    let captures = [
        start_x,
        start_y,
        state.cells[0],
        state.cells[1],
        x,
        y,
        state.seed,
    ];
    let rows = b.fold(&row, rows, &[zero], &captures)[0];
    // c = 1/(√π a³).
    let unit = 1.0 / (std::f32::consts::PI.sqrt() * WIDTH.powi(3));
    let amplitude = b.scale(state.amplitude, unit);
    let part = b.mul(rows, amplitude);
    let sum = b.add(sum, part);
    b.result("mean", sum);
    state.advance(&mut b, octaves);
    b.finish(module)
}

/// The filtered kernel at one lattice point, the body of a fold over columns. Gradients and
/// Hessians are summed in d and B alone: T⁻¹ is applied once, to the sums.
fn kernel(module: &mut Module, mode: Mode) -> FunctionRef {
    let orders = orders(mode);
    let mut b = Builder::new(
        "lattice_kernel",
        "The filtered kernel of one lattice point.",
    );
    let index = b.param("index", Type::U32);
    let sums: Vec<Value> = (0..orders)
        .map(|i| b.param_f32(format!("sum_{i}")))
        .collect();
    let start = b.param_f32("start_x");
    let (x, dy) = (b.param_f32("x"), b.param_f32("dy"));
    let cell = b.param("cell_x", Type::I32);
    let hash = b.param("row_hash", Type::U32);
    let p = [
        b.param_f32("p_xx"),
        b.param_f32("p_xy"),
        b.param_f32("p_yy"),
    ];
    let t = [
        b.param_f32("t_xx"),
        b.param_f32("t_xy"),
        b.param_f32("t_yy"),
    ];
    let offset = b.float_u(index);
    let place = b.add(start, offset);
    let dx = b.sub(x, place);
    let [c, s] = angle(&mut b, cell, place, hash);
    let ux = b.dot(&[p[0], p[1]], &[dx, dy]);
    let uy = b.dot(&[p[1], p[2]], &[dx, dy]);
    let q = b.dot(&[dx, dy], &[ux, uy]);
    let exponent = b.scale(q, -0.5);
    let least = b.f32(-80.0);
    let exponent = b.max(exponent, least);
    let envelope = b.exp(exponent);
    // Bu, and k = u·Bu − tr(BT⁻¹).
    let bx = b.dot(&[c, s], &[ux, uy]);
    let (sx, cy) = (b.mul(s, ux), b.mul(c, uy));
    let by = b.sub(sx, cy);
    let k = b.dot(&[ux, uy], &[bx, by]);
    let difference = b.sub(p[0], p[2]);
    let twice = b.add(p[1], p[1]);
    let trace = b.dot(&[c, s], &[difference, twice]);
    let k = b.sub(k, trace);
    let mut parts = vec![k];
    if orders > 1 {
        // 2Bu − k d.
        for (bu, d) in [(bx, dx), (by, dy)] {
            let twice = b.add(bu, bu);
            let drop = b.mul(k, d);
            parts.push(b.sub(twice, drop));
        }
    }
    if orders > 3 {
        // 2B − 2(Bu dᵀ + d Buᵀ) + k (d dᵀ − T).
        let (two_c, two_s) = (b.add(c, c), b.add(s, s));
        let minus = b.neg(two_c);
        for (turn, [p, q], [r, w], t) in [
            (two_c, [bx, bx], [dx, dx], t[0]),
            (two_s, [bx, by], [dy, dx], t[1]),
            (minus, [by, by], [dy, dy], t[2]),
        ] {
            let outer = b.dot(&[p, q], &[r, w]);
            let outer = b.add(outer, outer);
            let square = b.mul(r, w);
            let square = b.sub(square, t);
            let bent = b.mul(k, square);
            let part = b.sub(turn, outer);
            parts.push(b.add(part, bent));
        }
    }
    for (i, (sum, part)) in sums.into_iter().zip(parts).enumerate() {
        let part = b.mul(envelope, part);
        let sum = b.add(sum, part);
        b.result(format!("sum_{i}"), sum);
    }
    b.finish(module)
}

/// One lattice row of filtered kernels, the body of a fold over rows.
fn row(module: &mut Module, mode: Mode) -> FunctionRef {
    let kernel = kernel(module, mode);
    let mut b = Builder::new("lattice_row", "The filtered kernels of one lattice row.");
    let index = b.param("index", Type::U32);
    let sums: Vec<Value> = (0..orders(mode))
        .map(|i| b.param_f32(format!("sum_{i}")))
        .collect();
    let start = b.param_f32("start_y");
    let (columns, count) = (b.param_f32("columns"), b.param("column_count", Type::U32));
    let shear = b.param_f32("shear");
    let cells = [b.param("cell_x", Type::I32), b.param("cell_y", Type::I32)];
    let (x, y) = (b.param_f32("x"), b.param_f32("y"));
    let seed = b.param("seed", Type::U32);
    let p = [
        b.param_f32("p_xx"),
        b.param_f32("p_xy"),
        b.param_f32("p_yy"),
    ];
    let t = [
        b.param_f32("t_xx"),
        b.param_f32("t_xy"),
        b.param_f32("t_yy"),
    ];
    let offset = b.float_u(index);
    let place = b.add(start, offset);
    let dy = b.sub(y, place);
    let hash = row_hash(&mut b, cells[1], place, seed);
    // The row's largest envelope lies where d_x = (T₁₂/T₂₂) d_y.
    let lean = b.mul(shear, dy);
    let centre = b.sub(x, lean);
    let start = window(&mut b, centre, columns);
    let captures = [
        start, x, dy, cells[0], hash, p[0], p[1], p[2], t[0], t[1], t[2],
    ];
    let sums = b.fold(&kernel, count, &sums, &captures);
    for (i, sum) in sums.into_iter().enumerate() {
        b.result(format!("sum_{i}"), sum);
    }
    b.finish(module)
}

/// One octave of the filtered noise, the body of a fold.
fn filtered_octave(module: &mut Module, mode: Mode, octaves: Octaves) -> FunctionRef {
    let row = row(module, mode);
    let orders = orders(mode);
    let mut b = Builder::new("lattice_octave", "One more octave of the filtered noise.");
    b.param("index", Type::U32);
    let names = ["mean", "dx", "dy", "dxx", "dxy", "dyy"];
    let sums: Vec<Value> = names[..orders]
        .iter()
        .map(|name| b.param_f32(*name))
        .collect();
    let rest = mode.spreads().then(|| b.param_f32("rest"));
    let state = Octave::declare(&mut b);
    let covariance = [
        b.param_f32("s_xx"),
        b.param_f32("s_xy"),
        b.param_f32("s_yy"),
    ];
    let eigenvalues = [b.param_f32("s_major"), b.param_f32("s_minor")];

    // The footprint in cells of this octave, T = a²I + Σ and P = T⁻¹.
    let area = b.square(state.scale);
    let widest = b.f32(1e6);
    let area = b.min(area, widest);
    let [s_xx, t_xy, s_yy] = covariance.map(|s| b.mul(s, area));
    let (t_xx, t_yy) = (b.offset(s_xx, WIDTH * WIDTH), b.offset(s_yy, WIDTH * WIDTH));
    let y = eigenvalues.map(|s| {
        let s = b.mul(s, area);
        b.scale(s, 1.0 / (WIDTH * WIDTH))
    });
    let factors = y.map(|y| b.offset(y, 1.0));
    let determinant = b.mul(factors[0], factors[1]);
    let determinant = b.scale(determinant, WIDTH.powi(4));
    let one = b.f32(1.0);
    let inverse = b.div(one, determinant);
    let p_xx = b.mul(t_yy, inverse);
    let p_yy = b.mul(t_xx, inverse);
    let p_xy = b.mul(t_xy, inverse);
    let p_xy = b.neg(p_xy);

    // What is left of the octave, and how far its kernels reach: R² = ln F + 9.66 in units of T.
    let [f, v1, v2] = energies(&mut b, y);
    let tiny = b.f32(1e-12);
    let guarded = b.max(f, tiny);
    let reach = b.ln(guarded);
    let reach = b.offset(reach, NEGLIGIBLE_LN);
    let reach = b.max(reach, one);
    let reach = b.sqrt(reach);
    let reach = b.add(reach, reach);
    let rows = b.sqrt(t_yy);
    let rows = b.mul(rows, reach);
    let ratio = b.div(determinant, t_yy);
    let columns = b.sqrt(ratio);
    let columns = b.mul(columns, reach);
    let needed = b.max(rows, columns);
    let count = |b: &mut Builder, needed: Value| {
        // ⌈needed⌉ between 3 and the most.
        let minus = b.neg(needed);
        let floor = b.floor(minus);
        let up = b.neg(floor);
        b.clamp(up, 3.0, MOST)
    };
    let (rows, columns) = (count(&mut b, rows), count(&mut b, columns));

    // The octave fades to nothing before it is dropped.
    let amplitude = b.sqrt(guarded);
    let ramp = |b: &mut Builder, x: Value, low: f32, high: f32| {
        let x = b.offset(x, -low);
        let x = b.scale(x, 1.0 / (high - low));
        b.clamp(x, 0.0, 1.0)
    };
    let by_amplitude = ramp(&mut b, amplitude, FADE[0], FADE[1]);
    let by_reach = ramp(&mut b, needed, MOST, MOST * 0.8);
    let fade = b.mul(by_amplitude, by_reach);
    let zero = b.f32(0.0);
    let gone = b.le(fade, zero);
    let (none, row_count) = (b.u32(0), b.trunc_i(rows));
    let row_count = b.cast_u(row_count);
    let row_count = b.select(gone, none, row_count);
    let column_count = b.trunc_i(columns);
    let column_count = b.cast_u(column_count);
    let start_y = window(&mut b, state.fractions[1], rows);
    let shear = b.div(t_xy, t_yy);
    let captures = [
        start_y,
        columns,
        column_count,
        shear,
        state.cells[0],
        state.cells[1],
        state.fractions[0],
        state.fractions[1],
        state.seed,
        p_xx,
        p_xy,
        p_yy,
        t_xx,
        t_xy,
        t_yy,
    ];
    let kernels = b.fold(&row, row_count, &vec![zero; orders], &captures);

    // κ = a³/(√π √det T), and T⁻¹ on the sums.
    let root = b.sqrt(inverse);
    let kappa = b.scale(root, WIDTH.powi(3) / std::f32::consts::PI.sqrt());
    let faded = b.mul(kappa, fade);
    let weight = b.mul(faded, state.amplitude);
    let part = b.mul(weight, kernels[0]);
    let mut totals = vec![b.add(sums[0], part)];
    if orders > 1 {
        let weight = b.mul(weight, state.scale);
        let parts = [
            b.dot(&[p_xx, p_xy], &kernels[1..3]),
            b.dot(&[p_xy, p_yy], &kernels[1..3]),
        ];
        for (sum, part) in sums[1..3].iter().zip(parts) {
            let part = b.mul(weight, part);
            totals.push(b.add(*sum, part));
        }
    }
    if orders > 3 {
        let weight = b.mul(weight, area);
        let [h11, h12, h22] = [kernels[3], kernels[4], kernels[5]];
        let rows = [[p_xx, p_xy], [p_xy, p_yy]];
        for (sum, (i, j)) in sums[3..].iter().zip([(0, 0), (0, 1), (1, 1)]) {
            let left = b.dot(&[h11, h12], &rows[j]);
            let right = b.dot(&[h12, h22], &rows[j]);
            let bent = b.dot(&rows[i], &[left, right]);
            let part = b.mul(weight, bent);
            totals.push(b.add(*sum, part));
        }
    }
    for (name, total) in names.iter().zip(totals) {
        b.result(*name, total);
    }

    if let Some(rest) = rest {
        // What the filter removed, V = 1 − F, less what the mode carries of it, plus what fading
        // drops. V − V₁ is at least V₂; below 4e-7 it is rounding.
        let lost = b.sub(one, f);
        let square = b.square(fade);
        let kept = b.sub(one, fade);
        let dropped = b.square(kept);
        let dropped = b.mul(dropped, f);
        let uncarried = b.sub(one, square);
        let left = match mode {
            Mode::Ensemble => {
                let lost = b.max(lost, zero);
                b.add(lost, dropped)
            }
            Mode::Local => {
                let left = b.sub(lost, v1);
                let left = b.offset(left, -4e-7);
                let left = b.max(left, v2);
                let left = b.max(left, zero);
                let back = b.mul(uncarried, v1);
                let left = b.add(left, back);
                b.add(left, dropped)
            }
            _ => {
                let carried = b.add(v1, v2);
                let left = b.sub(lost, carried);
                let left = b.offset(left, -4e-7);
                let left = b.max(left, zero);
                let back = b.mul(uncarried, carried);
                let left = b.add(left, back);
                b.add(left, dropped)
            }
        };
        let power = b.square(state.amplitude);
        let part = b.mul(power, left);
        let rest = b.add(rest, part);
        b.result("rest", rest);
    }
    state.advance(&mut b, octaves);
    b.finish(module)
}
