//! Perlin's gradient noise in space: a random direction g at every lattice point, with the kernel
//! w(d_x) w(d_y) w(d_z) g·d.
//!
//! Footprints narrow against a cell act on the polynomials of w, wider ones on the fit of their
//! product, as in the plane.

use super::points::Points;
use super::quadrupole::sphere;
use super::{NAMES, PAIRS, place};
use crate::noise::perlin::fit::{SPACE, Shape, Weight};
use crate::noise::perlin::point::{between, fade};
use crate::noise::perlin::profile::{averaged, window};
use crate::noise::perlin::{WINDOW_ENERGY, WINDOW_MOMENT};
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};

/// 1 over the standard deviation of the bare sum of kernels, (∫t²w²) (∫w²)² for a unit vector.
pub(super) fn unit() -> f32 {
    1.0 / (WINDOW_ENERGY * WINDOW_MOMENT.sqrt())
}

fn gradient(b: &mut Builder, key: Value) -> [Value; 3] {
    let hash = b.scramble(key);
    sphere(b, hash)
}

/// The unfiltered noise: eight corners.
pub(super) fn point(b: &mut Builder, points: Points, fractions: [Value; 3]) -> Value {
    let ends = [b.f32(0.0), b.f32(1.0)];
    let offsets = fractions.map(|t| [t, b.offset(t, -1.0)]);
    let shares = fractions.map(|t| fade(b, t));
    let mut slices = Vec::new();
    for z in 0..2 {
        let slice = points.stepped(b, 2, ends[z]);
        let mut rows = Vec::new();
        for y in 0..2 {
            let row = slice.stepped(b, 1, ends[y]);
            let corners = [0, 1].map(|x| {
                let corner = row.stepped(b, 0, ends[x]);
                let g = gradient(b, corner.key);
                b.dot(&g, &[offsets[0][x], offsets[1][y], offsets[2][z]])
            });
            rows.push(between(b, shares[0], corners));
        }
        slices.push(between(b, shares[1], [rows[0], rows[1]]));
    }
    between(b, shares[2], [slices[0], slices[1]])
}

/// The filtered kernel, see [`crate::noise::perlin::fit::Fit::kernel`]. `p` is P, `t` is I + S.
pub(super) fn kernel(
    b: &mut Builder,
    key: Value,
    (d, means): ([Value; 3], [Value; 3]),
    (p, t): (&[Value], &[Value]),
    parts: usize,
) -> Vec<Value> {
    let g = gradient(b, key);
    let full = |entries: &[Value]| [0, 1, 2].map(|i| [0, 1, 2].map(|j| entries[place(i, j)]));
    let inverse = full(p);
    // C = S (I + S)⁻¹ = I − P.
    let mut covariance = inverse;
    for (i, row) in covariance.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            let unit = b.f32(if i == j { 1.0 } else { 0.0 });
            *entry = b.sub(unit, *entry);
        }
    }
    let shape = Shape {
        inverse,
        covariance,
        total: full(t),
    };
    let order = match parts {
        1 => 0,
        4 => 1,
        _ => 2,
    };
    SPACE.kernel(b, Weight::Direction(g), (d, means), &shape, order)
}

/// w at a corner along one axis and its derivatives, averaged.
fn profile(b: &mut Builder, fraction: Value, end: Value, c: Value) -> (Value, Vec<Value>) {
    let t = b.sub(fraction, end);
    let magnitude = b.abs(t);
    let mut w = window(b, magnitude);
    // 1 at the near corner, −1 at the far one, where t is negative.
    let sign = b.scale(end, -2.0);
    let sign = b.offset(sign, 1.0);
    for odd in [1, 3, 5] {
        w[odd] = b.mul(w[odd], sign);
    }
    (t, averaged(b, &w, c))
}

/// The kernel of one corner of the cell over a footprint that is narrow against it, with its
/// derivatives in cells: the body of a fold over eight corners. Captures: the points, the fractions
/// and the footprint's covariance. E[W] is f(x) f(y) f(z), averaged along each axis, with the
/// covariances c_ij ∂_i∂_j in the first order.
pub(super) fn corner(module: &mut Module, parts: usize, tiles: bool) -> FunctionRef {
    let doc = "A corner of the noise over a footprint that is narrow against a cell.";
    let mut builder = Builder::new("volume_corner", doc);
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let sums: Vec<Value> = NAMES[..parts]
        .iter()
        .map(|name| b.param_f32(format!("sum_{name}")))
        .collect();
    let points = Points::declare(b, tiles);
    let fractions = ["x", "y", "z"].map(|name| b.param_f32(name));
    let c = PAIRS.map(|[i, j]| b.param_f32(format!("c_{i}{j}")));
    let mut point = points;
    let mut t = [index; 3];
    let axes = [0, 1, 2].map(|axis| {
        let by = b.u32(axis as u32);
        let bit = b.shr_u(index, by);
        let mask = b.u32(1);
        let bit = b.and_u(bit, mask);
        let end = b.float_u(bit);
        point = point.stepped(b, axis, end);
        let variance = c[place(axis, axis)];
        let (offset, profile) = profile(b, fractions[axis], end, variance);
        t[axis] = offset;
        profile
    });
    let g = gradient(b, point.key);
    // A derivative of E[W].
    let of = |b: &mut Builder, along: &[usize]| {
        let mut orders = [0; 3];
        for &axis in along {
            orders[axis] += 1;
        }
        let product = |b: &mut Builder, orders: [usize; 3]| {
            let factors = [0, 1, 2].map(|axis| axes[axis].get(orders[axis]).copied());
            let [Some(x), Some(y), Some(z)] = factors else {
                return b.f32(0.0);
            };
            let plane = b.mul(x, y);
            b.mul(plane, z)
        };
        let mut sum = product(b, orders);
        for [i, j] in PAIRS.into_iter().filter(|[i, j]| i != j) {
            let mut more = orders;
            more[i] += 1;
            more[j] += 1;
            let product = product(b, more);
            let part = b.mul(c[place(i, j)], product);
            sum = b.add(sum, part);
        }
        sum
    };
    // E[g·X W(X)] = (g·t) E[W] + (Cg)·∇E[W].
    let along = b.dot(&g, &t);
    let turned = [0, 1, 2].map(|i| {
        let row = [0, 1, 2].map(|j| c[place(i, j)]);
        b.dot(&row, &g)
    });
    let whole = of(b, &[]);
    let slopes = [0, 1, 2].map(|i| of(b, &[i]));
    let lean = b.dot(&turned, &slopes);
    let own = b.mul(along, whole);
    let mut all = vec![b.add(own, lean)];
    if parts > 1 {
        for i in 0..3 {
            let bends = [0, 1, 2].map(|j| of(b, &[i, j]));
            let lean = b.dot(&turned, &bends);
            let own = b.dot(&[g[i], along], &[whole, slopes[i]]);
            all.push(b.add(own, lean));
        }
    }
    if parts > 4 {
        for [i, j] in PAIRS {
            let thirds = [0, 1, 2].map(|k| of(b, &[i, j, k]));
            let lean = b.dot(&turned, &thirds);
            let bend = of(b, &[i, j]);
            let own = b.dot(&[g[i], g[j], along], &[slopes[j], slopes[i], bend]);
            all.push(b.add(own, lean));
        }
    }
    for ((name, sum), part) in NAMES.into_iter().zip(sums).zip(all) {
        let sum = b.add(sum, part);
        b.result(name, sum);
    }
    builder.finish(module)
}
