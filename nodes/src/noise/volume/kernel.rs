//! The kernels of lattice points in space, summed along columns, rows and slices.

use super::{NAMES, PAIRS, place};
use crate::noise::hash::direction;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};

/// What a step along x, y and z adds to the key of a lattice point.
pub(super) const STEPS: [u32; 3] = [0x9e37_79b1, 0x27d4_eb2f, 0x1656_67b1];

/// What is random at a lattice point: B = ±(nnᵀ − |n|²I/3).
struct Turn {
    /// n, a uniform height and a uniform angle: a unit vector to within 1.1e-3.
    n: [Value; 3],
    /// |n|²/3, which leaves B no trace.
    third: Value,
    /// ±1, without which the noise would not be symmetric.
    sign: Value,
}

fn turn(b: &mut Builder, key: Value) -> Turn {
    let hash = b.scramble(key);
    let [cos, sin] = direction(b, hash);
    // The angle comes from the leading bits, the height from the others.
    let mask = b.u32(0xffff);
    let low = b.and_u(hash, mask);
    let low = b.float_u(low);
    let height = b.scale(low, 2.0 / 65_536.0);
    let height = b.offset(height, 0.5 / 32_768.0 - 1.0);
    let square = b.square(height);
    let one = b.f32(1.0);
    let rest = b.sub(one, square);
    let ring = b.sqrt(rest);
    let bit = b.u32(0x1_0000);
    let bit = b.and_u(hash, bit);
    let none = b.u32(0);
    let is_clear = b.eq_u(bit, none);
    let (plus, minus) = (b.f32(1.0), b.f32(-1.0));
    let sign = b.select(is_clear, plus, minus);
    let n = [b.mul(ring, cos), b.mul(ring, sin), height];
    let square = b.dot(&n, &n);
    let third = b.scale(square, 1.0 / 3.0);
    Turn { n, third, sign }
}

/// The key of the lattice point `offset` (a real) steps along an axis.
pub(super) fn stepped(b: &mut Builder, key: Value, axis: usize, offset: Value) -> Value {
    let offset = b.trunc_i(offset);
    let offset = b.cast_u(offset);
    let step = b.u32(STEPS[axis]);
    let walked = b.mul_u(offset, step);
    b.add_u(key, walked)
}

/// Three unfiltered kernels of a row, the body of a fold over rows: E d·Bd. Offsets are
/// in kernel widths, `width` to a cell.
pub(super) fn point_row(module: &mut Module, width: f32) -> FunctionRef {
    let doc = "The unfiltered kernels of one lattice row in space.";
    let mut builder = Builder::new("volume_row", doc);
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let sum = b.param_f32("sum");
    let columns: Vec<[Value; 2]> = (0..3)
        .map(|i| ["d", "e"].map(|name| b.param_f32(format!("{name}_{i}"))))
        .collect();
    let (first, dz, outer) = (b.param_f32("y"), b.param_f32("dz"), b.param_f32("envelope"));
    let key = b.param("key", Type::U32);
    let number = b.float_u(index);
    let key = stepped(b, key, 1, number);
    let number = b.scale(number, 1.0 / width);
    let dy = b.sub(first, number);
    let flat = b.dot(&[dy, dz], &[dy, dz]);
    let square = b.square(dy);
    let exponent = b.scale(square, -0.5);
    let envelope = b.exp(exponent);
    let envelope = b.mul(envelope, outer);
    let mut row = b.f32(0.0);
    for (i, [dx, e]) in columns.into_iter().enumerate() {
        let step = b.u32(STEPS[0].wrapping_mul(i as u32));
        let key = b.add_u(key, step);
        let Turn { n, third, sign } = turn(b, key);
        let along = b.dot(&n, &[dx, dy, dz]);
        let k = b.square(along);
        let square = b.square(dx);
        let whole = b.add(square, flat);
        let whole = b.mul(whole, third);
        let k = b.sub(k, whole);
        let part = b.mul(e, k);
        let part = b.mul(sign, part);
        row = b.add(row, part);
    }
    let row = b.mul(row, envelope);
    let sum = b.add(sum, row);
    b.result("sum", sum);
    builder.finish(module)
}

/// One lattice slice of unfiltered kernels, the body of a fold over slices.
pub(super) fn point_slice(module: &mut Module, width: f32) -> FunctionRef {
    let row = point_row(module, width);
    let doc = "The unfiltered kernels of one lattice slice in space.";
    let mut builder = Builder::new("volume_slice", doc);
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let sum = b.param_f32("sum");
    let columns: Vec<Value> = (0..6).map(|i| b.param_f32(format!("column_{i}"))).collect();
    let (y, first) = (b.param_f32("y"), b.param_f32("z"));
    let key = b.param("key", Type::U32);
    let number = b.float_u(index);
    let key = stepped(b, key, 2, number);
    let number = b.scale(number, 1.0 / width);
    let dz = b.sub(first, number);
    let square = b.square(dz);
    let exponent = b.scale(square, -0.5);
    let envelope = b.exp(exponent);
    let mut captures = columns;
    captures.extend([y, dz, envelope, key]);
    let three = b.u32(3);
    let sum = b.fold(&row, three, &[sum], &captures)[0];
    b.result("sum", sum);
    builder.finish(module)
}

/// What every kernel of an octave needs of the footprint: P, tr P, I + S.
pub(super) const SHAPE: usize = 13;

fn shape(b: &mut Builder) -> Vec<Value> {
    let names = PAIRS.map(|[i, j]| format!("{i}{j}"));
    let mut all: Vec<Value> = (names.iter())
        .map(|name| b.param_f32(format!("p_{name}")))
        .collect();
    all.push(b.param_f32("trace"));
    all.extend(names.iter().map(|name| b.param_f32(format!("t_{name}"))));
    assert_eq!(all.len(), SHAPE, "numbers of a shape");
    all
}

fn sums(b: &mut Builder, parts: usize) -> Vec<Value> {
    NAMES[..parts]
        .iter()
        .map(|name| b.param_f32(format!("sum_{name}")))
        .collect()
}

/// The filtered kernel of one lattice point, the body of a fold over columns. Gradients and
/// Hessians are summed in d and B alone: P is applied once, to the sums.
fn kernel(module: &mut Module, parts: usize, width: f32) -> FunctionRef {
    let doc = "The filtered kernel of one lattice point in space.";
    let mut builder = Builder::new("volume_kernel", doc);
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let sums = sums(b, parts);
    let (first, dy, dz) = (b.param_f32("x"), b.param_f32("dy"), b.param_f32("dz"));
    let key = b.param("key", Type::U32);
    let shape = shape(b);
    let (p, trace, t) = (&shape[..6], shape[6], &shape[7..]);
    let number = b.float_u(index);
    let key = stepped(b, key, 0, number);
    let number = b.scale(number, 1.0 / width);
    let d = [b.sub(first, number), dy, dz];
    let Turn { n, third, sign } = turn(b, key);
    let row = |i: usize| [0, 1, 2].map(|j| p[place(i, j)]);
    let u = [0, 1, 2].map(|i| b.dot(&row(i), &d));
    let distance = b.dot(&d, &u);
    let exponent = b.scale(distance, -0.5);
    let least = b.f32(-80.0);
    let exponent = b.max(exponent, least);
    let envelope = b.exp(exponent);
    let envelope = b.mul(sign, envelope);
    // Bu, and k = u·Bu − nᵀPn + |n|² tr P/3.
    let along = b.dot(&n, &u);
    let bu = [0, 1, 2].map(|i| {
        let outer = b.mul(n[i], along);
        let part = b.mul(u[i], third);
        b.sub(outer, part)
    });
    let k = b.dot(&u, &bu);
    let pn = [0, 1, 2].map(|i| b.dot(&row(i), &n));
    let inner = b.dot(&n, &pn);
    let k = b.sub(k, inner);
    let whole = b.mul(third, trace);
    let k = b.add(k, whole);
    let mut all = vec![k];
    if parts > 1 {
        // 2Bu − k d.
        for i in 0..3 {
            let twice = b.add(bu[i], bu[i]);
            let drop = b.mul(k, d[i]);
            all.push(b.sub(twice, drop));
        }
    }
    if parts > 4 {
        // 2B − 2(Bu dᵀ + d Buᵀ) + k (d dᵀ − I − S).
        for (at, [i, j]) in PAIRS.into_iter().enumerate() {
            let turn = b.mul(n[i], n[j]);
            let turn = if i == j { b.sub(turn, third) } else { turn };
            let outer = b.dot(&[bu[i], d[i]], &[d[j], bu[j]]);
            let part = b.sub(turn, outer);
            let part = b.add(part, part);
            let square = b.mul(d[i], d[j]);
            let square = b.sub(square, t[at]);
            let bent = b.mul(k, square);
            all.push(b.add(part, bent));
        }
    }
    for ((name, sum), part) in NAMES.into_iter().zip(sums).zip(all) {
        let part = b.mul(envelope, part);
        let sum = b.add(sum, part);
        b.result(name, sum);
    }
    builder.finish(module)
}

/// The place (relative to the cell, a real) that `count` lattice points around `x` start at.
pub(super) fn start(b: &mut Builder, x: Value, count: Value) -> Value {
    let half = b.scale(count, -0.5);
    let start = b.add(x, half);
    let start = b.floor(start);
    b.offset(start, 1.0)
}

/// The window of a fold: how many (a real and a u32).
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub(super) count: Value,
    pub(super) turns: Value,
}

impl Window {
    fn declare(b: &mut Builder, name: &str) -> Self {
        Self {
            count: b.param_f32(name),
            turns: b.param(format!("{name}_turns"), Type::U32),
        }
    }

    pub(super) fn captures(self) -> [Value; 2] {
        [self.count, self.turns]
    }
}

/// One lattice row of filtered kernels, the body of a fold over rows.
fn row(module: &mut Module, parts: usize, width: f32) -> FunctionRef {
    let kernel = kernel(module, parts, width);
    let doc = "The filtered kernels of one lattice row in space.";
    let mut builder = Builder::new("volume_row", doc);
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let sums = sums(b, parts);
    let columns = Window::declare(b, "columns");
    // The row's largest envelope lies where d_x = lean_y d_y + lean_z d_z.
    let (lean_y, lean_z) = (b.param_f32("lean_y"), b.param_f32("lean_z"));
    let (x, first, dz) = (b.param_f32("x"), b.param_f32("y"), b.param_f32("dz"));
    let key = b.param("key", Type::U32);
    let shape = shape(b);
    let number = b.float_u(index);
    let key = stepped(b, key, 1, number);
    let number = b.scale(number, 1.0 / width);
    let dy = b.sub(first, number);
    let lean = b.dot(&[lean_y, lean_z], &[dy, dz]);
    let lean = b.scale(lean, width);
    let centre = b.sub(x, lean);
    let start = start(b, centre, columns.count);
    let key = stepped(b, key, 0, start);
    let dx = b.sub(x, start);
    let dx = b.scale(dx, 1.0 / width);
    let mut captures = vec![dx, dy, dz, key];
    captures.extend(shape);
    let sums = b.fold(&kernel, columns.turns, &sums, &captures);
    for (name, sum) in NAMES.into_iter().zip(sums) {
        b.result(name, sum);
    }
    builder.finish(module)
}

/// One lattice slice of filtered kernels, the body of a fold over slices.
pub(super) fn slice(module: &mut Module, parts: usize, width: f32) -> FunctionRef {
    let row = row(module, parts, width);
    let doc = "The filtered kernels of one lattice slice in space.";
    let mut builder = Builder::new("volume_slice", doc);
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let sums = sums(b, parts);
    let rows = Window::declare(b, "rows");
    let columns = Window::declare(b, "columns");
    // The slice's largest envelope lies where d_y = shear d_z.
    let shear = b.param_f32("shear");
    let (lean_y, lean_z) = (b.param_f32("lean_y"), b.param_f32("lean_z"));
    let (x, y, first) = (b.param_f32("x"), b.param_f32("y"), b.param_f32("z"));
    let key = b.param("key", Type::U32);
    let shape = shape(b);
    let number = b.float_u(index);
    let key = stepped(b, key, 2, number);
    let number = b.scale(number, 1.0 / width);
    let dz = b.sub(first, number);
    let lean = b.mul(shear, dz);
    let lean = b.scale(lean, width);
    let centre = b.sub(y, lean);
    let start = start(b, centre, rows.count);
    let key = stepped(b, key, 1, start);
    let dy = b.sub(y, start);
    let dy = b.scale(dy, 1.0 / width);
    let mut captures = columns.captures().to_vec();
    captures.extend([lean_y, lean_z, x, dy, dz, key]);
    captures.extend(shape);
    let sums = b.fold(&row, rows.turns, &sums, &captures);
    for (name, sum) in NAMES.into_iter().zip(sums) {
        b.result(name, sum);
    }
    builder.finish(module)
}
