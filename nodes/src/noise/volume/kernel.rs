//! The filtered kernels of lattice points in space, summed along columns, rows and slices.

use super::points::Points;
use super::symmetric::Shape;
use super::{Kind, NAMES, quadrupole, quintic};
use crate::noise::window::{count, start};
use mipless_codegen::ir::{Builder, Float, FunctionRef, Module, Uint, dot};

fn sums(b: &Builder, parts: usize) -> Vec<Float<'_>> {
    NAMES[..parts]
        .iter()
        .map(|name| b.float_param(format!("sum_{name}")))
        .collect()
}

fn results<'b>(b: &'b Builder, sums: Vec<Float<'b>>) {
    b.results(NAMES, sums);
}

/// The filtered kernel of one lattice point, the body of a fold over columns. Gradients and
/// Hessians are summed in d alone: P is applied once, to the sums.
fn kernel(module: &mut Module, kind: Kind, parts: usize, tiles: bool) -> FunctionRef {
    let doc = "The filtered kernel of one lattice point in space.";
    let b = &Builder::new("volume_kernel", doc);
    let index = b.uint_param("index");
    let sums = sums(b, parts);
    let [first, dy, dz] = b.float_params(["x", "dy", "dz"]);
    let points = Points::declare(b, kind, tiles);
    let shape = Shape::declare(b);
    let number = index.to_float();
    let point = points.stepped(0, number);
    let d = [first - number * (1.0 / kind.width()), dy, dz];
    let u = shape.inverse.times(d);
    let envelope = (dot(d, u) * -0.5).max(-80.0).exp();
    let all = match kind {
        Kind::Quadrupole => quadrupole::kernel(point.key, (d, u), &shape, parts),
        Kind::Quintic | Kind::Materialx(_) => {
            quintic::kernel(quintic::gradient(point, kind), (d, u), &shape, parts)
        }
    };
    let sums = sums
        .into_iter()
        .zip(all)
        .map(|(sum, part)| sum + envelope * part);
    results(b, sums.collect());
    b.finish(module)
}

/// The fewest and the most lattice points of a row, rows of a slice, and slices.
pub(super) const COUNTS: [f32; 2] = [2.0, 48.0];

/// How many lattice points of a line are summed, as a real and as an integer: those within an ellipsoid,
/// of which `left` is the square of the share that other axes leave, and `needed` the extent along the
/// line.
pub(super) fn window<'b>(needed: Float<'b>, left: Option<Float<'b>>) -> (Float<'b>, Uint<'b>) {
    let needed = match left {
        None => needed,
        // Of what is close to a point all is summed, as of the point itself.
        Some(left) => (needed * left.max(0.0).sqrt()).max(needed.min(3.0)),
    };
    count(needed, COUNTS)
}

/// What is left of 1 at an offset (in units of the kernel's width) from the middle of an axis whose
/// extent is `needed`.
fn beside<'b>(left: Float<'b>, offset: Float<'b>, (needed, width): (Float<'b>, f32)) -> Float<'b> {
    left - (offset / needed * (2.0 * width)).square()
}

/// One lattice row of filtered kernels, the body of a fold over rows.
fn row(module: &mut Module, kind: Kind, parts: usize, tiles: bool) -> FunctionRef {
    let (kernel, width) = (kernel(module, kind, parts, tiles), kind.width());
    let doc = "The filtered kernels of one lattice row in space.";
    let b = &Builder::new("volume_row", doc);
    let index = b.uint_param("index");
    let sums = sums(b, parts);
    let [rows, columns] = b.float_params(["rows", "columns"]);
    let leans = b.float_params(["lean_y", "lean_z"]);
    let [x, first, dz] = b.float_params(["x", "y", "dz"]);
    let [middle, left] = b.float_params(["middle", "left"]);
    let points = Points::declare(b, kind, tiles);
    let shape = Shape::declare(b);
    let number = index.to_float();
    let points = points.stepped(1, number);
    let dy = first - number * (1.0 / width);
    // The row's largest envelope lies where d_x = lean_y d_y + lean_z d_z.
    let centre = x - dot(leans, [dy, dz]) * width;
    let left = beside(left, dy - middle, (rows, width));
    let (columns, turns) = window(columns, Some(left));
    let start = start(centre, columns);
    let points = points.moved(0, start);
    let dx = (x - start) * (1.0 / width);
    let sums = b.fold(&kernel, turns, sums, ([dx, dy, dz], points, shape));
    results(b, sums);
    b.finish(module)
}

/// One lattice slice of filtered kernels, the body of a fold over slices.
pub(super) fn slice(module: &mut Module, kind: Kind, parts: usize, tiles: bool) -> FunctionRef {
    let (row, width) = (row(module, kind, parts, tiles), kind.width());
    let doc = "The filtered kernels of one lattice slice in space.";
    let b = &Builder::new("volume_slice", doc);
    let index = b.uint_param("index");
    let sums = sums(b, parts);
    let [slices, rows, columns] = b.float_params(["slices", "rows", "columns"]);
    let [shear, lean_y, lean_z] = b.float_params(["shear", "lean_y", "lean_z"]);
    let [x, y, first] = b.float_params(["x", "y", "z"]);
    let points = Points::declare(b, kind, tiles);
    let shape = Shape::declare(b);
    let number = index.to_float();
    let points = points.stepped(2, number);
    let dz = first - number * (1.0 / width);
    // The slice's largest envelope lies where d_y = shear d_z.
    let middle = shear * dz;
    let centre = y - middle * width;
    let left = beside(b.float(1.0), dz, (slices, width));
    let (count, turns) = window(rows, Some(left));
    let start = start(centre, count);
    let points = points.moved(1, start);
    let dy = (y - start) * (1.0 / width);
    let place = [rows, columns, lean_y, lean_z, x, dy, dz, middle, left];
    let sums = b.fold(&row, turns, sums, (place, points, shape));
    results(b, sums);
    b.finish(module)
}
