//! The noise over any footprint: the window's fit is a polynomial times a Gaussian, and so is its
//! product with the footprint. In sums over kernels M is applied once, at the end.

use super::fit::{Shape, Weight};
use super::grid::Grid;
use super::{Kind, NAMES};
use crate::noise::hash::corner;
use crate::noise::sum::{derivatives, parts};
use crate::noise::window::{count, start};
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::Mode;

/// What every kernel of an octave needs of the footprint, in units of the fit's width.
const CAPTURES: [&str; 9] = [
    "m_xx", "m_xy", "m_yy", "c_xx", "c_xy", "c_yy", "t_xx", "t_xy", "t_yy",
];

/// A symmetric matrix by its entries 11, 12, 22.
fn symmetric([xx, xy, yy]: [Value; 3]) -> [[Value; 2]; 2] {
    [[xx, xy], [xy, yy]]
}

/// The shape of a footprint, and 1/det T. S and det S are in units of the fit's width.
pub(super) fn shape(
    b: &mut Builder,
    [s_xx, s_xy, s_yy]: [Value; 3],
    determinant: Value,
) -> (Shape<2>, Value) {
    let (t_xx, t_yy) = (b.offset(s_xx, 1.0), b.offset(s_yy, 1.0));
    // det T = 1 + tr S + det S, all positive.
    let trace = b.add(s_xx, s_yy);
    let whole = b.add(trace, determinant);
    let whole = b.offset(whole, 1.0);
    let one = b.f32(1.0);
    let inverse = b.div(one, whole);
    // C = (S + det S I)/det T.
    let [c_xx, c_yy] = [s_xx, s_yy].map(|s| {
        let s = b.add(s, determinant);
        b.mul(s, inverse)
    });
    let c_xy = b.mul(s_xy, inverse);
    let shape = Shape {
        inverse: symmetric([b.mul(t_yy, inverse), b.neg(c_xy), b.mul(t_xx, inverse)]),
        covariance: symmetric([c_xx, c_xy, c_yy]),
        total: symmetric([t_xx, s_xy, t_yy]),
    };
    (shape, inverse)
}

/// The captures for a shape.
pub(super) fn captures(shape: &Shape<2>) -> Vec<Value> {
    [shape.inverse, shape.covariance, shape.total]
        .iter()
        .flat_map(|[[xx, xy], [_, yy]]| [*xx, *xy, *yy])
        .collect()
}

fn declare(b: &mut Builder) -> Shape<2> {
    let [inverse, covariance, total] = [0, 3, 6].map(|at| {
        let entries = [0, 1, 2].map(|i| b.param_f32(CAPTURES[at + i]));
        symmetric(entries)
    });
    Shape {
        inverse,
        covariance,
        total,
    }
}

fn sums(b: &mut Builder, mode: Mode) -> Vec<Value> {
    NAMES[..parts(mode)]
        .iter()
        .map(|name| b.param_f32(format!("sum_{name}")))
        .collect()
}

/// The filtered kernel of one lattice point, the body of a fold over columns.
fn kernel(module: &mut Module, kind: Kind, mode: Mode, tiles: bool) -> FunctionRef {
    let doc = "The filtered kernel of one lattice point.";
    let mut b = Builder::new(format!("{}_kernel", kind.name()), doc);
    let fit = kind.fit();
    let index = b.param("index", Type::U32);
    let sums = sums(&mut b, mode);
    let start = b.param_f32("start_x");
    let (x, dy) = (b.param_f32("x"), b.param_f32("dy"));
    let row = b.param("row_word", Type::U32);
    let grid = Grid::declare(&mut b, tiles);
    let shape = declare(&mut b);
    let offset = b.float_u(index);
    let place = b.add(start, offset);
    let dx = b.sub(x, place);
    let column = grid.word(&mut b, 0, place);
    let hash = corner(&mut b, column, row);
    let d = [dx, dy].map(|d| b.scale(d, 1.0 / fit.width));
    let means = shape.inverse.map(|row| b.dot(&row, &d));
    let distance = b.dot(&d, &means);
    let exponent = b.scale(distance, -0.5);
    let least = b.f32(-80.0);
    let exponent = b.max(exponent, least);
    let envelope = b.exp(exponent);
    let weights = kind.weights(&mut b, hash);
    let weight = match (kind, &weights[..]) {
        (Kind::Gradient, &[x, y]) => Weight::Direction([x, y]),
        _ => Weight::Number(weights[0]),
    };
    let parts = fit.kernel(&mut b, weight, (d, means), &shape, derivatives(mode));
    for ((name, sum), part) in NAMES.into_iter().zip(sums).zip(parts) {
        let part = b.mul(envelope, part);
        let sum = b.add(sum, part);
        b.result(name, sum);
    }
    b.finish(module)
}

/// The fewest and the most lattice points of a row, and rows.
pub(super) const COUNTS: [f32; 2] = [2.0, 112.0];

/// One lattice row of filtered kernels, the body of a fold over rows.
pub(super) fn row(module: &mut Module, kind: Kind, mode: Mode, tiles: bool) -> FunctionRef {
    let kernel = kernel(module, kind, mode, tiles);
    let doc = "The filtered kernels of one lattice row.";
    let mut b = Builder::new(format!("{}_row", kind.name()), doc);
    let index = b.param("index", Type::U32);
    let sums = sums(&mut b, mode);
    let first = b.param_f32("start_y");
    let (rows, columns) = (b.param_f32("rows"), b.param_f32("columns"));
    let shear = b.param_f32("shear");
    let grid = Grid::declare(&mut b, tiles);
    let (x, y) = (b.param_f32("x"), b.param_f32("y"));
    let shape = declare(&mut b);
    let offset = b.float_u(index);
    let place = b.add(first, offset);
    let dy = b.sub(y, place);
    let word = grid.word(&mut b, 1, place);
    // The row's largest envelope lies where d_x = (T₁₂/T₂₂) d_y.
    let lean = b.mul(shear, dy);
    let centre = b.sub(x, lean);
    // The kernels that count lie within an ellipse.
    let share = b.div(dy, rows);
    let square = b.square(share);
    let beside = b.scale(square, -4.0);
    let (one, zero) = (b.f32(1.0), b.f32(0.0));
    let left = b.add(one, beside);
    let left = b.max(left, zero);
    let left = b.sqrt(left);
    let columns = b.mul(columns, left);
    let [columns, turns] = count(&mut b, columns, COUNTS);
    let start = start(&mut b, centre, columns);
    let mut captures = vec![start, x, dy, word];
    captures.extend(grid.captures());
    captures.extend(self::captures(&shape));
    let sums = b.fold(&kernel, turns, &sums, &captures);
    for (name, sum) in NAMES.into_iter().zip(sums) {
        b.result(name, sum);
    }
    b.finish(module)
}
