//! The noise over a footprint that is narrow against a cell: polynomials, exact at a point.

use super::grid::{Grid, Tiles};
use super::profile::{DERIVATIVES, joint, profiles};
use super::{Kind, NAMES};
use crate::noise::sum::parts;
use mipless_codegen::ir::{Builder, FunctionRef, Module};
use mipless_codegen::moments::Mode;

/// The four corners' kernels and their derivatives in cells, the body of a fold of at most one
/// turn: the state is replaced. Captures: the grid, the fraction and the footprint's covariance.
pub(super) fn sums(module: &mut Module, kind: Kind, mode: Mode, tiles: Tiles) -> FunctionRef {
    let doc = "The noise over a footprint that is narrow against a cell.";
    let b = &Builder::new(format!("{}_near", kind.name()), doc);
    b.uint_param("index");
    for name in &NAMES[..parts(mode)] {
        b.float_param(format!("state_{name}"));
    }
    let grid = Grid::declare(b, kind, tiles);
    let fractions = b.float_params(["x", "y"]);
    let [xx, xy, yy] = b.float_params(["s_xx", "s_xy", "s_yy"]);
    let powers = [xy, xy.square() * 0.5];
    let axes = [(fractions[0], xx), (fractions[1], yy)].map(|(t, spread)| {
        let left = profiles(kind.window(t), t, false, spread);
        let rest = 1.0 - t;
        [left, profiles(kind.window(rest), rest, true, spread)]
    });
    let mut totals = vec![b.float(0.0); parts(mode)];
    for (corner, hash) in grid.corners().into_iter().enumerate() {
        let (x, y) = (&axes[0][corner % 2], &axes[1][corner / 2]);
        for (weight, &[i, j]) in kind.weights(hash).into_iter().zip(kind.terms()) {
            for (total, along) in totals.iter_mut().zip(DERIVATIVES) {
                *total += weight * joint([&x[i], &y[j]], along, &powers);
            }
        }
    }
    b.results(NAMES, totals);
    b.finish(module)
}
