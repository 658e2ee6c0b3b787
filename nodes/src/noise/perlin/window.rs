//! The noise over any footprint: the window's fit is a polynomial times a Gaussian, and so is its
//! product with the footprint. In sums over kernels M is applied once, at the end.

use super::fit::{Shape, Weight};
use super::grid::{Grid, Tiles};
use super::{Kind, NAMES};
use crate::noise::sum::{derivatives, parts};
use crate::noise::window::{count, start};
use mipless_codegen::ir::{Builder, Float, FunctionRef, Module, Scalars, Sym2, dot};
use mipless_codegen::moments::Mode;

/// What every kernel of an octave needs of the footprint, in units of the fit's width.
const CAPTURES: [[&str; 3]; 3] = [
    ["m_xx", "m_xy", "m_yy"],
    ["c_xx", "c_xy", "c_yy"],
    ["t_xx", "t_xy", "t_yy"],
];

/// A symmetric matrix of all four entries.
fn symmetric([xx, xy, yy]: [Float<'_>; 3]) -> [[Float<'_>; 2]; 2] {
    [[xx, xy], [xy, yy]]
}

/// The shape of a footprint, and 1/det T. S and det S are in units of the fit's width.
pub(super) fn shape<'b>(s: Sym2<'b>, determinant: Float<'b>) -> (Shape<'b, 2>, Float<'b>) {
    let Sym2([s_xx, s_xy, s_yy]) = s;
    let (t_xx, t_yy) = (s_xx + 1.0, s_yy + 1.0);
    // det T = 1 + tr S + det S, all positive.
    let inverse = 1.0 / (s_xx + s_yy + determinant + 1.0);
    // C = (S + det S I)/det T.
    let [c_xx, c_yy] = [s_xx, s_yy].map(|s| (s + determinant) * inverse);
    let c_xy = s_xy * inverse;
    let shape = Shape {
        inverse: symmetric([t_yy * inverse, -c_xy, t_xx * inverse]),
        covariance: symmetric([c_xx, c_xy, c_yy]),
        total: symmetric([t_xx, s_xy, t_yy]),
    };
    (shape, inverse)
}

/// The captures for a shape.
pub(super) fn captures<'b>(shape: &Shape<'b, 2>) -> impl Scalars<'b> + use<'b> {
    [shape.inverse, shape.covariance, shape.total].map(|[[xx, xy], [_, yy]]| [xx, xy, yy])
}

fn declare(b: &Builder) -> Shape<'_, 2> {
    let [inverse, covariance, total] =
        CAPTURES.map(|names| symmetric(names.map(|name| b.float_param(name))));
    Shape {
        inverse,
        covariance,
        total,
    }
}

fn sums(b: &Builder, mode: Mode) -> Vec<Float<'_>> {
    NAMES[..parts(mode)]
        .iter()
        .map(|name| b.float_param(format!("sum_{name}")))
        .collect()
}

/// The filtered kernel of one lattice point, the body of a fold over columns.
fn kernel(module: &mut Module, kind: Kind, mode: Mode, tiles: Tiles) -> FunctionRef {
    let doc = "The filtered kernel of one lattice point.";
    let b = &Builder::new(format!("{}_kernel", kind.name()), doc);
    let fit = kind.fit();
    let index = b.uint_param("index");
    let sums = sums(b, mode);
    let [start, x, dy] = b.float_params(["start_x", "x", "dy"]);
    let row = b.uint_param("row_word");
    let grid = Grid::declare(b, kind, tiles);
    let shape = declare(b);
    let place = start + index.to_float();
    let hash = grid.corner(grid.word(0, place), row);
    let d = [x - place, dy].map(|d| d * (1.0 / fit.width));
    let means = shape.inverse.map(|row| dot(row, d));
    let envelope = (dot(d, means) * -0.5).max(-80.0).exp();
    let weights = kind.weights(hash);
    let weight = match (kind, &weights[..]) {
        (Kind::Gradient | Kind::Materialx(_), &[x, y]) => Weight::Direction([x, y]),
        _ => Weight::Number(weights[0]),
    };
    let parts = fit.kernel(weight, (d, means), &shape, derivatives(mode));
    b.sums(NAMES, sums, parts.into_iter().map(|part| envelope * part));
    b.finish(module)
}

/// The fewest and the most lattice points of a row, and rows.
pub(super) const COUNTS: [f32; 2] = [2.0, 112.0];

/// One lattice row of filtered kernels, the body of a fold over rows.
pub(super) fn row(module: &mut Module, kind: Kind, mode: Mode, tiles: Tiles) -> FunctionRef {
    let kernel = kernel(module, kind, mode, tiles);
    let doc = "The filtered kernels of one lattice row.";
    let b = &Builder::new(format!("{}_row", kind.name()), doc);
    let index = b.uint_param("index");
    let sums = sums(b, mode);
    let [first, rows, columns, shear] = b.float_params(["start_y", "rows", "columns", "shear"]);
    let grid = Grid::declare(b, kind, tiles);
    let [x, y] = b.float_params(["x", "y"]);
    let shape = declare(b);
    let place = first + index.to_float();
    let dy = y - place;
    let word = grid.word(1, place);
    // The row's largest envelope lies where d_x = (T₁₂/T₂₂) d_y.
    let centre = x - shear * dy;
    // The kernels that count lie within an ellipse.
    let left = (1.0 + (dy / rows).square() * -4.0).max(0.0).sqrt();
    let (columns, turns) = count(columns * left, COUNTS);
    let start = start(centre, columns);
    let captures = ([start, x, dy], word, grid, captures(&shape));
    b.results(NAMES, b.fold(&kernel, turns, sums, captures));
    b.finish(module)
}
