//! The sums of kernels: impulses of a row of cells, rows of a window.

use super::Gabor;
use crate::noise::hash::direction;
use crate::noise::period::wrapped;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use std::f32::consts::{PI, TAU};

/// What is summed over impulses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kernel {
    /// 1 for the value, 3 with the gradient, 6 with the Hessian.
    pub(super) orders: usize,
    /// Whether the imaginary part is summed too.
    pub(super) complex: bool,
    /// Whether a footprint widens the kernels.
    pub(super) filtered: bool,
    /// The noise.
    pub(super) gabor: Gabor,
}

impl Kernel {
    /// How many numbers.
    pub(super) fn sums(self) -> usize {
        self.orders * if self.complex { 2 } else { 1 }
    }
}

/// The cell that a window of `count` (a float) cells around `x` starts at: cells are taken for their
/// centres.
pub(super) fn window(b: &mut Builder, x: Value, count: Value) -> Value {
    let half = b.scale(count, -0.5);
    let start = b.add(x, half);
    let start = b.offset(start, 0.5);
    b.floor(start)
}

/// The parameters that kernels share: the orientation, P and C.
fn shape(b: &mut Builder, filtered: bool) -> Vec<Value> {
    let names = [
        "cosine", "sine", "p_xx", "p_xy", "p_yy", "c_xx", "c_xy", "c_yy",
    ];
    let count = if filtered { names.len() } else { 2 };
    names[..count]
        .iter()
        .map(|name| b.param_f32(*name))
        .collect()
}

/// The direction of an impulse's wave.
fn wave(b: &mut Builder, anisotropy: f32, hash: Value, orientation: [Value; 2]) -> [Value; 2] {
    if anisotropy >= 1.0 {
        return orientation;
    }
    let mixed = b.u32(0x9e37_79b9);
    let hash = b.xor_u(hash, mixed);
    let hash = b.scramble(hash);
    if anisotropy <= 0.0 {
        return direction(b, hash);
    }
    let signed = b.cast_i(hash);
    let share = b.float_i(signed);
    let half = 0.5 * PI * (1.0 - anisotropy);
    let angle = b.scale(share, half / (1u32 << 31) as f32);
    let (sin, cos) = (b.sin(angle), b.cos(angle));
    let minus = b.neg(sin);
    [
        b.dot(&orientation, &[cos, minus]),
        b.dot(&orientation, &[sin, cos]),
    ]
}

/// The kernel of one cell's impulse, the body of a fold over columns.
fn impulse(module: &mut Module, kernel: Kernel) -> FunctionRef {
    let gabor = kernel.gabor;
    let mut b = Builder::new("gabor_impulse", "The kernel of the impulse of one cell.");
    let index = b.param("index", Type::U32);
    let sums: Vec<Value> = (0..kernel.sums())
        .map(|i| b.param_f32(format!("sum_{i}")))
        .collect();
    let start = b.param_f32("start_x");
    let (x, dy) = (b.param_f32("x"), b.param_f32("dy"));
    let cell = b.param("cell_x", Type::I32);
    let hash = b.param("row_hash", Type::U32);
    let shape = shape(&mut b, kernel.filtered);
    let orientation = [shape[0], shape[1]];
    let offset = b.float_u(index);
    let place = b.add(start, offset);
    let column = b.trunc_i(place);
    let column = b.add_i(cell, column);
    let column = wrapped(&mut b, column, gabor.cells());
    let column = b.cast_u(column);
    let hash = b.xor_u(column, hash);
    let hash = b.scramble(hash);
    // Eleven bits a coordinate, ten of the phase.
    let field = |b: &mut Builder, shift: u32, bits: u32| {
        let by = b.u32(shift);
        let shifted = b.shr_u(hash, by);
        let mask = b.u32((1 << bits) - 1);
        let part = b.and_u(shifted, mask);
        b.float_u(part)
    };
    let (jx, jy, phase) = (
        field(&mut b, 0, 11),
        field(&mut b, 11, 11),
        field(&mut b, 22, 10),
    );
    let (jx, jy) = (b.scale(jx, 1.0 / 2048.0), b.scale(jy, 1.0 / 2048.0));
    let dx = b.sub(x, place);
    let (dx, dy) = (b.sub(dx, jx), b.sub(dy, jy));
    let phase = b.scale(phase, TAU / 1024.0);
    let [wx, wy] = wave(&mut b, gabor.anisotropy, hash, orientation);
    let area = gabor.alpha().powi(2);
    let turn = gabor.turn();
    let (exponent, turns) = if kernel.filtered {
        let (p, c) = (&shape[2..5], &shape[5..8]);
        let ux = b.dot(&[p[0], p[1]], &[dx, dy]);
        let uy = b.dot(&[p[1], p[2]], &[dx, dy]);
        let q = b.dot(&[dx, dy], &[ux, uy]);
        let (xx, xy, yy) = (b.square(wx), b.mul(wx, wy), b.square(wy));
        let xy = b.add(xy, xy);
        let lost = b.dot(&[xx, xy, yy], c);
        let lost = b.scale(lost, turn * turn);
        let exponent = b.add(q, lost);
        let turns = b.dot(&[wx, wy], &[ux, uy]);
        (b.scale(exponent, -0.5), b.scale(turns, area * turn))
    } else {
        let q = b.dot(&[dx, dy], &[dx, dy]);
        let turns = b.dot(&[wx, wy], &[dx, dy]);
        (b.scale(q, -0.5 / area), b.scale(turns, turn))
    };
    let least = b.f32(-80.0);
    let exponent = b.max(exponent, least);
    let envelope = b.exp(exponent);
    let angle = b.add(turns, phase);
    let (cos, sin) = (b.cos(angle), b.sin(angle));
    let (cos, sin) = (b.mul(envelope, cos), b.mul(envelope, sin));
    let minus = b.neg(cos);
    // α² w.
    let w = [b.scale(wx, area * turn), b.scale(wy, area * turn)];
    let parts = if kernel.complex {
        vec![[cos, sin], [sin, minus]]
    } else {
        vec![[cos, sin]]
    };
    let mut all = Vec::new();
    for [even, odd] in parts {
        all.push(even);
        if kernel.orders > 1 {
            for (d, w) in [(dx, w[0]), (dy, w[1])] {
                all.push(b.dot(&[d, w], &[even, odd]));
            }
        }
        if kernel.orders > 3 {
            for ([d, e], [w, v]) in [
                ([dx, dx], [w[0], w[0]]),
                ([dx, dy], [w[0], w[1]]),
                ([dy, dy], [w[1], w[1]]),
            ] {
                let (dd, ww) = (b.mul(d, e), b.mul(w, v));
                let across = b.dot(&[d, e], &[v, w]);
                let square = b.sub(dd, ww);
                all.push(b.dot(&[square, across], &[even, odd]));
            }
        }
    }
    for (i, (sum, part)) in sums.into_iter().zip(all).enumerate() {
        let sum = b.add(sum, part);
        b.result(format!("sum_{i}"), sum);
    }
    b.finish(module)
}

/// One row of impulses, the body of a fold over rows.
pub(super) fn row(module: &mut Module, kernel: Kernel) -> FunctionRef {
    let impulse = impulse(module, kernel);
    let mut b = Builder::new("gabor_row", "The kernels of the impulses of one row.");
    let index = b.param("index", Type::U32);
    let sums: Vec<Value> = (0..kernel.sums())
        .map(|i| b.param_f32(format!("sum_{i}")))
        .collect();
    let start = b.param_f32("start_y");
    let (columns, count) = (b.param_f32("columns"), b.param("column_count", Type::U32));
    let shear = b.param_f32("shear");
    let cells = [b.param("cell_x", Type::I32), b.param("cell_y", Type::I32)];
    let (x, y) = (b.param_f32("x"), b.param_f32("y"));
    let seed = b.param("seed", Type::U32);
    let shape = shape(&mut b, kernel.filtered);
    let offset = b.float_u(index);
    let place = b.add(start, offset);
    let dy = b.sub(y, place);
    let row = b.trunc_i(place);
    let row = b.add_i(cells[1], row);
    let row = wrapped(&mut b, row, kernel.gabor.cells());
    let row = b.cast_u(row);
    let factor = b.u32(0x9e37_79b1);
    let row = b.mul_u(row, factor);
    let hash = b.add_u(row, seed);
    // The row's largest envelope lies where d_x = (T₁₂/T₂₂) d_y, taken at the middle of its cells.
    let middle = b.offset(dy, -0.5);
    let lean = b.mul(shear, middle);
    let centre = b.sub(x, lean);
    let start = window(&mut b, centre, columns);
    let mut captures = vec![start, x, dy, cells[0], hash];
    captures.extend(shape);
    let sums = b.fold(&impulse, count, &sums, &captures);
    for (i, sum) in sums.into_iter().enumerate() {
        b.result(format!("sum_{i}"), sum);
    }
    b.finish(module)
}
