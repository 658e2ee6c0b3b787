//! The quadrupole kernel: a random second-order kernel at every lattice point.
//!
//! With n a random direction and B = ±(nnᵀ − I/3), in units of the kernel's width:
//! k = uᵀBu − tr(BP) and M = Σ κ E k, κ² = 3/(π^{3/2} a³ det(I + S)).

use super::points::Points;
use super::symmetric::{PAIRS, Shape};
use super::{Kind, WIDTH};
use crate::noise::hash::direction;
use crate::noise::window::start;
use mipless_codegen::ir::{Builder, Float, FunctionRef, Module, Uint, dot};

/// κ of the unfiltered noise: √3 π^{−3/4} a^{−3/2}.
pub(super) fn unit() -> f32 {
    3.0f32.sqrt() * std::f32::consts::PI.powf(-0.75) * WIDTH.powf(-1.5)
}

/// A direction, a uniform height and a uniform angle: a unit vector to within 1.1e-3.
pub(super) fn sphere(hash: Uint<'_>) -> [Float<'_>; 3] {
    let [cos, sin] = direction(hash);
    // The angle comes from the leading bits, the height from the others.
    let height = (hash & 0xffff).to_float() * (2.0 / 65_536.0) + (0.5 / 32_768.0 - 1.0);
    let ring = (1.0 - height.square()).sqrt();
    [ring * cos, ring * sin, height]
}

/// What is random at a lattice point: B = ±(nnᵀ − |n|²I/3).
struct Turn<'b> {
    n: [Float<'b>; 3],
    /// |n|²/3, which leaves B no trace.
    third: Float<'b>,
    /// ±1, without which the noise would not be symmetric.
    sign: Float<'b>,
}

fn turn(key: Uint<'_>) -> Turn<'_> {
    let hash = key.scramble();
    let n = sphere(hash);
    Turn {
        n,
        third: dot(n, n) * (1.0 / 3.0),
        sign: (hash & 0x1_0000).equals(0).select(1.0, -1.0),
    }
}

/// The filtered kernel without its envelope, and what is summed for its derivatives: 2Bu − k d and
/// 2B − 2(Bu dᵀ + d Buᵀ) + k (d dᵀ − I − S), with u = Pd.
pub(super) fn kernel<'b>(
    key: Uint<'b>,
    (d, u): ([Float<'b>; 3], [Float<'b>; 3]),
    shape: &Shape<'b>,
    parts: usize,
) -> Vec<Float<'b>> {
    let Turn { n, third, sign } = turn(key);
    // Bu, and k = u·Bu − nᵀPn + |n|² tr P/3.
    let along = dot(n, u);
    let bu = [0, 1, 2].map(|i| n[i] * along - u[i] * third);
    let p = &shape.inverse;
    let k = dot(u, bu) - dot(n, p.times(n)) + third * p.trace();
    let mut all = vec![k];
    if parts > 1 {
        all.extend((0..3).map(|i| bu[i] + bu[i] - k * d[i]));
    }
    if parts > 4 {
        for (at, [i, j]) in PAIRS.into_iter().enumerate() {
            let turn = n[i] * n[j];
            let turn = if i == j { turn - third } else { turn };
            let part = turn - (bu[i] * d[j] + d[i] * bu[j]);
            let bent = k * (d[i] * d[j] - shape.total[at]);
            all.push(part + part + bent);
        }
    }
    all.into_iter().map(|part| sign * part).collect()
}

/// e^{−x²/2}.
fn envelope(x: Float<'_>) -> Float<'_> {
    (x.square() * -0.5).exp()
}

/// Three unfiltered kernels of a row, the body of a fold over rows: E d·Bd. Offsets are
/// in kernel widths.
fn row(module: &mut Module, tiles: bool) -> FunctionRef {
    let doc = "The unfiltered kernels of one lattice row in space.";
    let b = &Builder::new("volume_row", doc);
    let index = b.uint_param("index");
    let sum = b.float_param("sum");
    let columns = [0, 1, 2].map(|i| ["d", "e"].map(|name| b.float_param(format!("{name}_{i}"))));
    let [first, dz, outer] = b.float_params(["y", "dz", "envelope"]);
    let points = Points::declare(b, Kind::Quadrupole, tiles);
    let number = index.to_float();
    let points = points.stepped(1, number);
    let dy = first - number * (1.0 / WIDTH);
    let flat = dy * dy + dz * dz;
    let kernels = columns.into_iter().enumerate().map(|(i, [dx, e])| {
        let point = points.stepped(0, b.float(i as f32));
        let Turn { n, third, sign } = turn(point.key);
        let k = dot(n, [dx, dy, dz]).square() - (dx.square() + flat) * third;
        sign * (e * k)
    });
    b.result("sum", sum + b.sum(kernels) * (envelope(dy) * outer));
    b.finish(module)
}

/// One lattice slice of unfiltered kernels, the body of a fold over slices.
fn slice(module: &mut Module, tiles: bool) -> FunctionRef {
    let row = row(module, tiles);
    let doc = "The unfiltered kernels of one lattice slice in space.";
    let b = &Builder::new("volume_slice", doc);
    let index = b.uint_param("index");
    let sum = b.float_param("sum");
    let columns = [0, 1, 2, 3, 4, 5].map(|i| b.float_param(format!("column_{i}")));
    let [y, first] = b.float_params(["y", "z"]);
    let points = Points::declare(b, Kind::Quadrupole, tiles);
    let number = index.to_float();
    let points = points.stepped(2, number);
    let dz = first - number * (1.0 / WIDTH);
    let captures = (columns, [y, dz, envelope(dz)], points);
    b.result("sum", b.fold(&row, b.uint(3), sum, captures));
    b.finish(module)
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
    pub(super) fn sum<'b>(&self, points: Points<'b>, fractions: [Float<'b>; 3]) -> Float<'b> {
        let b = points.key.builder();
        let mut points = points;
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let place = start(fractions[axis], b.float(3.0));
            points = points.moved(axis, place);
            (fractions[axis] - place) * (1.0 / WIDTH)
        });
        let columns = [0.0, 1.0, 2.0].map(|column: f32| {
            let d = x + -column / WIDTH;
            [d, envelope(d)]
        });
        let captures = (columns, [y, z], points);
        b.fold(&self.slice, b.uint(3), b.float(0.0), captures)
    }
}
