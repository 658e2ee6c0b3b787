//! The quadrupole kernel: a random second-order kernel at every lattice point.
//!
//! With n a random direction and B = ±(nnᵀ − I/3), in units of the kernel's width:
//! k = uᵀBu − tr(BP) and M = Σ κ E k, κ² = 3/(π^{3/2} a³ det(I + S)).

use super::points::Points;
use super::{PAIRS, WIDTH, place};
use crate::noise::hash::direction;
use crate::noise::window::start;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};

/// κ of the unfiltered noise: √3 π^{−3/4} a^{−3/2}.
pub(super) fn unit() -> f32 {
    3.0f32.sqrt() * std::f32::consts::PI.powf(-0.75) * WIDTH.powf(-1.5)
}

/// A direction, a uniform height and a uniform angle: a unit vector to within 1.1e-3.
pub(super) fn sphere(b: &mut Builder, hash: Value) -> [Value; 3] {
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
    [b.mul(ring, cos), b.mul(ring, sin), height]
}

/// What is random at a lattice point: B = ±(nnᵀ − |n|²I/3).
struct Turn {
    n: [Value; 3],
    /// |n|²/3, which leaves B no trace.
    third: Value,
    /// ±1, without which the noise would not be symmetric.
    sign: Value,
}

fn turn(b: &mut Builder, key: Value) -> Turn {
    let hash = b.scramble(key);
    let n = sphere(b, hash);
    let bit = b.u32(0x1_0000);
    let bit = b.and_u(hash, bit);
    let none = b.u32(0);
    let is_clear = b.eq_u(bit, none);
    let (plus, minus) = (b.f32(1.0), b.f32(-1.0));
    let sign = b.select(is_clear, plus, minus);
    let square = b.dot(&n, &n);
    let third = b.scale(square, 1.0 / 3.0);
    Turn { n, third, sign }
}

/// The filtered kernel without its envelope, and what is summed for its derivatives: 2Bu − k d and
/// 2B − 2(Bu dᵀ + d Buᵀ) + k (d dᵀ − I − S). `p` is P, `t` is I + S, u = Pd.
pub(super) fn kernel(
    b: &mut Builder,
    key: Value,
    (d, u): ([Value; 3], [Value; 3]),
    (p, t): (&[Value], &[Value]),
    parts: usize,
) -> Vec<Value> {
    let Turn { n, third, sign } = turn(b, key);
    // Bu, and k = u·Bu − nᵀPn + |n|² tr P/3.
    let along = b.dot(&n, &u);
    let bu = [0, 1, 2].map(|i| {
        let outer = b.mul(n[i], along);
        let part = b.mul(u[i], third);
        b.sub(outer, part)
    });
    let k = b.dot(&u, &bu);
    let pn = [0, 1, 2].map(|i| {
        let row = [0, 1, 2].map(|j| p[place(i, j)]);
        b.dot(&row, &n)
    });
    let inner = b.dot(&n, &pn);
    let k = b.sub(k, inner);
    let trace = b.add(p[0], p[3]);
    let trace = b.add(trace, p[5]);
    let whole = b.mul(third, trace);
    let k = b.add(k, whole);
    let mut all = vec![k];
    if parts > 1 {
        for i in 0..3 {
            let twice = b.add(bu[i], bu[i]);
            let drop = b.mul(k, d[i]);
            all.push(b.sub(twice, drop));
        }
    }
    if parts > 4 {
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
    all.into_iter().map(|part| b.mul(sign, part)).collect()
}

/// Three unfiltered kernels of a row, the body of a fold over rows: E d·Bd. Offsets are
/// in kernel widths.
fn row(module: &mut Module, tiles: bool) -> FunctionRef {
    let doc = "The unfiltered kernels of one lattice row in space.";
    let mut builder = Builder::new("volume_row", doc);
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let sum = b.param_f32("sum");
    let columns: Vec<[Value; 2]> = (0..3)
        .map(|i| ["d", "e"].map(|name| b.param_f32(format!("{name}_{i}"))))
        .collect();
    let (first, dz, outer) = (b.param_f32("y"), b.param_f32("dz"), b.param_f32("envelope"));
    let points = Points::declare(b, tiles);
    let number = b.float_u(index);
    let points = points.stepped(b, 1, number);
    let number = b.scale(number, 1.0 / WIDTH);
    let dy = b.sub(first, number);
    let flat = b.dot(&[dy, dz], &[dy, dz]);
    let square = b.square(dy);
    let exponent = b.scale(square, -0.5);
    let envelope = b.exp(exponent);
    let envelope = b.mul(envelope, outer);
    let mut row = b.f32(0.0);
    for (i, [dx, e]) in columns.into_iter().enumerate() {
        let step = b.f32(i as f32);
        let point = points.stepped(b, 0, step);
        let Turn { n, third, sign } = turn(b, point.key);
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
fn slice(module: &mut Module, tiles: bool) -> FunctionRef {
    let row = row(module, tiles);
    let doc = "The unfiltered kernels of one lattice slice in space.";
    let mut builder = Builder::new("volume_slice", doc);
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let sum = b.param_f32("sum");
    let mut captures: Vec<Value> = (0..6).map(|i| b.param_f32(format!("column_{i}"))).collect();
    let (y, first) = (b.param_f32("y"), b.param_f32("z"));
    let points = Points::declare(b, tiles);
    let number = b.float_u(index);
    let points = points.stepped(b, 2, number);
    let number = b.scale(number, 1.0 / WIDTH);
    let dz = b.sub(first, number);
    let square = b.square(dz);
    let exponent = b.scale(square, -0.5);
    let envelope = b.exp(exponent);
    captures.extend([y, dz, envelope]);
    captures.extend(points.captures());
    let three = b.u32(3);
    let sum = b.fold(&row, three, &[sum], &captures)[0];
    b.result("sum", sum);
    builder.finish(module)
}

/// The unfiltered noise.
pub(super) struct Point {
    /// The body of a fold over slices.
    slice: FunctionRef,
}

impl Point {
    pub(super) fn new(module: &mut Module, tiles: bool) -> Self {
        Self {
            slice: slice(module, tiles),
        }
    }

    /// The nearest 3×3×3 kernels around these fractions of the cell.
    pub(super) fn sum(&self, b: &mut Builder, points: Points, fractions: [Value; 3]) -> Value {
        let three = b.f32(3.0);
        let mut points = points;
        let offsets = [0, 1, 2].map(|axis| {
            let place = start(b, fractions[axis], three);
            points = points.moved(b, axis, place);
            let offset = b.sub(fractions[axis], place);
            b.scale(offset, 1.0 / WIDTH)
        });
        let mut captures = Vec::new();
        for column in 0..3 {
            let d = b.offset(offsets[0], -(column as f32) / WIDTH);
            let square = b.square(d);
            let exponent = b.scale(square, -0.5);
            captures.extend([d, b.exp(exponent)]);
        }
        captures.extend([offsets[1], offsets[2]]);
        captures.extend(points.captures());
        let (zero, three) = (b.f32(0.0), b.u32(3));
        b.fold(&self.slice, three, &[zero], &captures)[0]
    }
}
