//! The sums of kernels: impulses of a row of cells, rows of a window.

use super::{Gabor, form};
use crate::noise::cell::passed::{Passed, passed};
use crate::noise::cell::place::window_start;
use crate::noise::cell::{hash, row_word};
use crate::noise::hash::{direction, signed};
use mipless_codegen::ir::{Builder, Float, FunctionRef, Int, Module, Sym2, Uint, Vec2, dot};
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

    /// The state of a fold.
    fn declared_sums(self, b: &Builder) -> Vec<Float<'_>> {
        let names = (0..self.sums()).map(|i| format!("sum_{i}"));
        names.map(|name| b.float_param(name)).collect()
    }

    /// What kernels share, as parameters.
    fn declared_shape(self, b: &Builder) -> Shape<'_> {
        let orientation = Vec2(b.float_params(["cosine", "sine"]));
        let names = [["p_xx", "p_xy", "p_yy"], ["c_xx", "c_xy", "c_yy"]];
        let widened =
            (self.filtered).then(|| names.map(|m| Sym2(m.map(|name| b.float_param(name)))));
        (orientation, widened)
    }
}

/// What kernels share: the orientation, and where they are filtered P and C.
type Shape<'b> = (Vec2<'b>, Option<[Sym2<'b>; 2]>);

/// The direction of an impulse's wave.
fn wave<'b>(anisotropy: f32, hash: Uint<'b>, orientation: Vec2<'b>) -> Vec2<'b> {
    if anisotropy >= 1.0 {
        return orientation;
    }
    let hash = (hash ^ 0x9e37_79b9).scramble();
    if anisotropy <= 0.0 {
        return Vec2(direction(hash));
    }
    let half = 0.5 * PI * (1.0 - anisotropy);
    let angle = signed(hash) * (half / (1u32 << 31) as f32);
    let (sin, cos) = (angle.sin(), angle.cos());
    Vec2([[cos, -sin], [sin, cos]].map(|row| dot(*orientation, row)))
}

passed! {
    /// What the impulses of a row have in common.
    struct Row {
        start_x: Float,
        x: Float,
        dy: Float,
        cell_x: Int,
        row_hash: Uint,
    }
}

/// The kernel of one cell's impulse, the body of a fold over columns.
fn impulse(module: &mut Module, kernel: Kernel) -> FunctionRef {
    let gabor = kernel.gabor;
    let b = &Builder::new("gabor_impulse", "The kernel of the impulse of one cell.");
    let index = b.uint_param("index");
    let sums = kernel.declared_sums(b);
    let row = Row::declare(b);
    let (orientation, widened) = kernel.declared_shape(b);
    let place = row.start_x + index.to_float();
    let hash = hash(row.cell_x + place.to_int(), row.row_hash, gabor.cells());

    // Eleven bits a coordinate, ten of the phase.
    let field = |shift: u32, bits: u32| ((hash >> shift) & ((1 << bits) - 1)).to_float();
    let [jx, jy] = [0, 11].map(|shift| field(shift, 11) * (1.0 / 2048.0));
    let d = Vec2([row.x - place - jx, row.dy - jy]);
    let phase = field(22, 10) * (TAU / 1024.0);
    let w = wave(gabor.anisotropy, hash, orientation);

    // The envelope and the wave there.
    let (area, turn) = (gabor.alpha().powi(2), gabor.turn());
    let (exponent, turns) = match widened {
        Some([p, c]) => {
            let u = p.times(d);
            let lost = form(w, c) * (turn * turn);
            ((d.dot(u) + lost) * -0.5, w.dot(u) * (area * turn))
        }
        None => (d.norm2() * (-0.5 / area), w.dot(d) * turn),
    };
    let envelope = exponent.max(-80.0).exp();
    let angle = turns + phase;
    let [cos, sin] = [angle.cos(), angle.sin()].map(|wave| envelope * wave);

    // Each part and what its derivatives are made of, with α² w.
    let w = w * (area * turn);
    let waves = [[cos, sin], [sin, -cos]];
    let mut parts = Vec::new();
    for wave in &waves[..if kernel.complex { 2 } else { 1 }] {
        parts.push(wave[0]);
        if kernel.orders > 1 {
            parts.extend([0, 1].map(|i| dot([d[i], w[i]], *wave)));
        }
        if kernel.orders > 3 {
            parts.extend([(0, 0), (0, 1), (1, 1)].map(|(i, j)| {
                let even = d[i] * d[j] - w[i] * w[j];
                dot([even, d[i] * w[j] + d[j] * w[i]], *wave)
            }));
        }
    }
    for (i, (sum, part)) in sums.into_iter().zip(parts).enumerate() {
        b.result(format!("sum_{i}"), sum + part);
    }
    b.finish(module)
}

passed! {
    /// What the rows of impulses have in common.
    pub(super) struct Rows {
        start_y: Float,
        columns: Float,
        column_count: Uint,
        shear: Float,
        cell_x: Int,
        cell_y: Int,
        x: Float,
        y: Float,
        seed: Uint,
    }
}

/// One row of impulses, the body of a fold over rows.
pub(super) fn row(module: &mut Module, kernel: Kernel) -> FunctionRef {
    let impulse = impulse(module, kernel);
    let b = &Builder::new("gabor_row", "The kernels of the impulses of one row.");
    let index = b.uint_param("index");
    let sums = kernel.declared_sums(b);
    let rows = Rows::declare(b);
    let shape = kernel.declared_shape(b);
    let place = rows.start_y + index.to_float();
    let dy = rows.y - place;
    // The row's largest envelope lies where d_x = (T₁₂/T₂₂) d_y, taken at the middle of its cells.
    let centre = rows.x - rows.shear * (dy + -0.5);
    let number = rows.cell_y + place.to_int();
    let row = Row {
        start_x: window_start(centre, rows.columns),
        x: rows.x,
        dy,
        cell_x: rows.cell_x,
        row_hash: row_word(number, rows.seed, kernel.gabor.cells()),
    };
    let sums = b.fold(&impulse, rows.column_count, sums, (row, shape));
    for (i, sum) in sums.into_iter().enumerate() {
        b.result(format!("sum_{i}"), sum);
    }
    b.finish(module)
}
