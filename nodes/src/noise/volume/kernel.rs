//! The filtered kernels of lattice points in space, summed along columns, rows and slices.

use super::points::Points;
use super::{Kind, NAMES, PAIRS, place, quadrupole, quintic};
use crate::noise::window::{count, start};
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};

/// What every kernel of an octave needs of the footprint: P and I + S.
fn shape(b: &mut Builder) -> Vec<Value> {
    ["p", "t"]
        .iter()
        .flat_map(|name| PAIRS.map(|[i, j]| format!("{name}_{i}{j}")))
        .map(|name| b.param_f32(name))
        .collect()
}

fn sums(b: &mut Builder, parts: usize) -> Vec<Value> {
    NAMES[..parts]
        .iter()
        .map(|name| b.param_f32(format!("sum_{name}")))
        .collect()
}

/// The filtered kernel of one lattice point, the body of a fold over columns. Gradients and
/// Hessians are summed in d alone: P is applied once, to the sums.
fn kernel(module: &mut Module, kind: Kind, parts: usize, tiles: bool) -> FunctionRef {
    let doc = "The filtered kernel of one lattice point in space.";
    let mut builder = Builder::new("volume_kernel", doc);
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let sums = sums(b, parts);
    let (first, dy, dz) = (b.param_f32("x"), b.param_f32("dy"), b.param_f32("dz"));
    let points = Points::declare(b, tiles);
    let shape = shape(b);
    let (p, t) = shape.split_at(PAIRS.len());
    let number = b.float_u(index);
    let point = points.stepped(b, 0, number);
    let number = b.scale(number, 1.0 / kind.width());
    let d = [b.sub(first, number), dy, dz];
    let u = [0, 1, 2].map(|i| {
        let row = [0, 1, 2].map(|j| p[place(i, j)]);
        b.dot(&row, &d)
    });
    let distance = b.dot(&d, &u);
    let exponent = b.scale(distance, -0.5);
    let least = b.f32(-80.0);
    let exponent = b.max(exponent, least);
    let envelope = b.exp(exponent);
    let kernel = match kind {
        Kind::Quadrupole => quadrupole::kernel,
        Kind::Quintic => quintic::kernel,
    };
    let all = kernel(b, point.key, (d, u), (p, t), parts);
    for ((name, sum), part) in NAMES.into_iter().zip(sums).zip(all) {
        let part = b.mul(envelope, part);
        let sum = b.add(sum, part);
        b.result(name, sum);
    }
    builder.finish(module)
}

/// The fewest and the most lattice points of a row, rows of a slice, and slices.
pub(super) const COUNTS: [f32; 2] = [2.0, 48.0];

/// How many lattice points of a line are summed, a real and a u32: those within an ellipsoid, of which
/// `left` is the square of the share that other axes leave, and `needed` the extent along the line.
pub(super) fn window(b: &mut Builder, needed: Value, left: Option<Value>) -> [Value; 2] {
    let needed = match left {
        None => needed,
        Some(left) => {
            let zero = b.f32(0.0);
            let left = b.max(left, zero);
            let share = b.sqrt(left);
            let within = b.mul(needed, share);
            // Of what is close to a point all is summed, as of the point itself.
            let three = b.f32(3.0);
            let least = b.min(needed, three);
            b.max(within, least)
        }
    };
    count(b, needed, COUNTS)
}

/// What is left of 1 at an offset (in units of the kernel's width) from the middle of an axis whose
/// extent is `needed`.
fn beside(b: &mut Builder, left: Value, offset: Value, (needed, width): (Value, f32)) -> Value {
    let share = b.div(offset, needed);
    let share = b.scale(share, 2.0 * width);
    let square = b.square(share);
    b.sub(left, square)
}

/// One lattice row of filtered kernels, the body of a fold over rows.
fn row(module: &mut Module, kind: Kind, parts: usize, tiles: bool) -> FunctionRef {
    let (kernel, width) = (kernel(module, kind, parts, tiles), kind.width());
    let doc = "The filtered kernels of one lattice row in space.";
    let mut builder = Builder::new("volume_row", doc);
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let sums = sums(b, parts);
    let [rows, columns] = ["rows", "columns"].map(|name| b.param_f32(name));
    // The row's largest envelope lies where d_x = lean_y d_y + lean_z d_z.
    let (lean_y, lean_z) = (b.param_f32("lean_y"), b.param_f32("lean_z"));
    let (x, first, dz) = (b.param_f32("x"), b.param_f32("y"), b.param_f32("dz"));
    let (middle, left) = (b.param_f32("middle"), b.param_f32("left"));
    let points = Points::declare(b, tiles);
    let shape = shape(b);
    let number = b.float_u(index);
    let points = points.stepped(b, 1, number);
    let number = b.scale(number, 1.0 / width);
    let dy = b.sub(first, number);
    let lean = b.dot(&[lean_y, lean_z], &[dy, dz]);
    let lean = b.scale(lean, width);
    let centre = b.sub(x, lean);
    let beyond = b.sub(dy, middle);
    let left = beside(b, left, beyond, (rows, width));
    let [columns, turns] = window(b, columns, Some(left));
    let start = start(b, centre, columns);
    let points = points.moved(b, 0, start);
    let dx = b.sub(x, start);
    let dx = b.scale(dx, 1.0 / width);
    let mut captures = vec![dx, dy, dz];
    captures.extend(points.captures());
    captures.extend(shape);
    let sums = b.fold(&kernel, turns, &sums, &captures);
    for (name, sum) in NAMES.into_iter().zip(sums) {
        b.result(name, sum);
    }
    builder.finish(module)
}

/// One lattice slice of filtered kernels, the body of a fold over slices.
pub(super) fn slice(module: &mut Module, kind: Kind, parts: usize, tiles: bool) -> FunctionRef {
    let (row, width) = (row(module, kind, parts, tiles), kind.width());
    let doc = "The filtered kernels of one lattice slice in space.";
    let mut builder = Builder::new("volume_slice", doc);
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let sums = sums(b, parts);
    let extents = ["slices", "rows", "columns"].map(|name| b.param_f32(name));
    let [slices, rows, columns] = extents;
    // The slice's largest envelope lies where d_y = shear d_z.
    let shear = b.param_f32("shear");
    let (lean_y, lean_z) = (b.param_f32("lean_y"), b.param_f32("lean_z"));
    let (x, y, first) = (b.param_f32("x"), b.param_f32("y"), b.param_f32("z"));
    let points = Points::declare(b, tiles);
    let shape = shape(b);
    let number = b.float_u(index);
    let points = points.stepped(b, 2, number);
    let number = b.scale(number, 1.0 / width);
    let dz = b.sub(first, number);
    let middle = b.mul(shear, dz);
    let lean = b.scale(middle, width);
    let centre = b.sub(y, lean);
    let one = b.f32(1.0);
    let left = beside(b, one, dz, (slices, width));
    let [count, turns] = window(b, rows, Some(left));
    let start = start(b, centre, count);
    let points = points.moved(b, 1, start);
    let dy = b.sub(y, start);
    let dy = b.scale(dy, 1.0 / width);
    let mut captures = vec![rows, columns, lean_y, lean_z, x, dy, dz, middle, left];
    captures.extend(points.captures());
    captures.extend(shape);
    let sums = b.fold(&row, turns, &sums, &captures);
    for (name, sum) in NAMES.into_iter().zip(sums) {
        b.result(name, sum);
    }
    builder.finish(module)
}
