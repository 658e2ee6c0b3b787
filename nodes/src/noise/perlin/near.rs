//! The noise over a footprint that is narrow against a cell: polynomials, exact at a point.

use super::grid::Grid;
use super::profile::{DERIVATIVES, joint, quintic};
use super::{Kind, NAMES};
use crate::noise::sum::parts;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::Mode;

/// The four corners' kernels and their derivatives in cells, the body of a fold of at most one
/// turn: the state is replaced. Captures: the grid, the fraction and the footprint's covariance.
pub(super) fn sums(module: &mut Module, kind: Kind, mode: Mode, tiles: bool) -> FunctionRef {
    let doc = "The noise over a footprint that is narrow against a cell.";
    let mut b = Builder::new(format!("{}_near", kind.name()), doc);
    b.param("index", Type::U32);
    for name in &NAMES[..parts(mode)] {
        b.param_f32(format!("state_{name}"));
    }
    let grid = Grid::declare(&mut b, tiles);
    let fractions = [b.param_f32("x"), b.param_f32("y")];
    let xx = b.param_f32("s_xx");
    let xy = b.param_f32("s_xy");
    let yy = b.param_f32("s_yy");
    let half = b.square(xy);
    let powers = [xy, b.scale(half, 0.5)];
    let mut axes = Vec::new();
    for (t, spread) in fractions.into_iter().zip([xx, yy]) {
        let one = b.f32(1.0);
        let back = b.sub(one, t);
        axes.push([
            quintic(&mut b, t, false, spread),
            quintic(&mut b, back, true, spread),
        ]);
    }
    let hashes = grid.corners(&mut b);
    let mut totals: Vec<Value> = vec![b.f32(0.0); parts(mode)];
    for (corner, hash) in hashes.into_iter().enumerate() {
        let (x, y) = (&axes[0][corner % 2], &axes[1][corner / 2]);
        let weights = kind.weights(&mut b, hash);
        for (weight, &[i, j]) in weights.into_iter().zip(kind.terms()) {
            for (total, along) in totals.iter_mut().zip(DERIVATIVES) {
                let kernel = joint(&mut b, [&x[i], &y[j]], along, &powers);
                let part = b.mul(weight, kernel);
                *total = b.add(*total, part);
            }
        }
    }
    for (name, total) in NAMES.into_iter().zip(totals) {
        b.result(name, total);
    }
    b.finish(module)
}
