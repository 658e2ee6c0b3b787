//! Perlin's gradient noise in space: a random direction g at every lattice point, with the kernel
//! w(d_x) w(d_y) w(d_z) g·d.
//!
//! Footprints narrow against a cell act on the polynomials of w, wider ones on the fit of their
//! product, as in the plane.

use super::points::Points;
use super::quadrupole::sphere;
use super::symmetric::{self, PAIRS, Symmetric};
use super::{Kind, NAMES};
use crate::noise::jenkins;
use crate::noise::perlin::fit::{SPACE, Shape, Weight};
use crate::noise::perlin::point::{between, fade};
use crate::noise::perlin::profile::{averaged, window};
use crate::noise::perlin::{WINDOW_ENERGY, WINDOW_MOMENT};
use mipless_codegen::ir::{Builder, Float, FunctionRef, Module, dot};

/// 1 over the standard deviation of the bare sum of kernels, (∫t²w²) (∫w²)² for a unit vector.
pub(super) fn unit() -> f32 {
    1.0 / (WINDOW_ENERGY * WINDOW_MOMENT.sqrt())
}

/// The direction at a lattice point.
pub(super) fn gradient<'b>(point: Points<'b>, kind: Kind) -> [Float<'b>; 3] {
    match kind {
        Kind::Materialx(byte) => jenkins::direction(point.hash() >> (8 * u32::from(byte))),
        _ => sphere(point.key.scramble()),
    }
}

/// The unfiltered noise: eight corners.
pub(super) fn point<'b>(points: Points<'b>, fractions: [Float<'b>; 3], kind: Kind) -> Float<'b> {
    let ends = [0.0, 1.0].map(|end| fractions[0].literal(end));
    let offsets = fractions.map(|t| [t, t + -1.0]);
    let shares = fractions.map(fade);
    let slices = [0, 1].map(|z| {
        let slice = points.stepped(2, ends[z]);
        let rows = [0, 1].map(|y| {
            let row = slice.stepped(1, ends[y]);
            let corners = [0, 1].map(|x| {
                let g = gradient(row.stepped(0, ends[x]), kind);
                dot(g, [offsets[0][x], offsets[1][y], offsets[2][z]])
            });
            between(shares[0], corners)
        });
        between(shares[1], rows)
    });
    between(shares[2], slices)
}

/// The filtered kernel, see [`crate::noise::perlin::fit::Fit::kernel`].
pub(super) fn kernel<'b>(
    g: [Float<'b>; 3],
    (d, means): ([Float<'b>; 3], [Float<'b>; 3]),
    shape: &symmetric::Shape<'b>,
    parts: usize,
) -> Vec<Float<'b>> {
    // C = S (I + S)⁻¹ = I − P.
    let inverse = shape.inverse.rows();
    let covariance = [0, 1, 2].map(|i| {
        [0, 1, 2].map(|j| {
            let unit = if i == j { 1.0 } else { 0.0 };
            unit - inverse[i][j]
        })
    });
    let shape = Shape {
        inverse,
        covariance,
        total: shape.total.rows(),
    };
    let order = match parts {
        1 => 0,
        4 => 1,
        _ => 2,
    };
    SPACE.kernel(Weight::Direction(g), (d, means), &shape, order)
}

/// The offset to a corner along one axis, and w there with its derivatives, averaged.
fn profile<'b>(fraction: Float<'b>, end: Float<'b>, c: Float<'b>) -> (Float<'b>, Vec<Float<'b>>) {
    let t = fraction - end;
    let mut w = window(t.abs());
    // 1 at the near corner, −1 at the far one, where t is negative.
    let sign = end * -2.0 + 1.0;
    for odd in [1, 3, 5] {
        w[odd] *= sign;
    }
    (t, averaged(&w, c))
}

/// E[W] = E[f(x) f(y) f(z)] over a Gaussian, by the averaged profiles along each axis, with the
/// covariances c_ij ∂_i∂_j in the first order.
struct Product<'b> {
    axes: [Vec<Float<'b>>; 3],
    covariance: Symmetric<'b>,
}

impl<'b> Product<'b> {
    /// The derivative along these axes.
    fn derivative(&self, along: &[usize]) -> Float<'b> {
        let mut orders = [0; 3];
        for &axis in along {
            orders[axis] += 1;
        }
        let mut sum = self.uncorrelated(orders);
        for [i, j] in PAIRS.into_iter().filter(|[i, j]| i != j) {
            let mut more = orders;
            more[i] += 1;
            more[j] += 1;
            sum += self.covariance.at(i, j) * self.uncorrelated(more);
        }
        sum
    }

    fn uncorrelated(&self, orders: [usize; 3]) -> Float<'b> {
        let factors = [0, 1, 2].map(|axis| self.axes[axis].get(orders[axis]).copied());
        match factors {
            [Some(x), Some(y), Some(z)] => x * y * z,
            _ => self.covariance[0].literal(0.0),
        }
    }
}

/// The kernel of one corner of the cell over a footprint that is narrow against it, with its
/// derivatives in cells: the body of a fold over eight corners. Captures: the points, the fractions
/// and the footprint's covariance.
pub(super) fn corner(module: &mut Module, kind: Kind, parts: usize, tiles: bool) -> FunctionRef {
    let doc = "A corner of the noise over a footprint that is narrow against a cell.";
    let b = &Builder::new("volume_corner", doc);
    let index = b.uint_param("index");
    let sums: Vec<Float<'_>> = NAMES[..parts]
        .iter()
        .map(|name| b.float_param(format!("sum_{name}")))
        .collect();
    let mut point = Points::declare(b, kind, tiles);
    let fractions = b.float_params(["x", "y", "z"]);
    let covariance = Symmetric(PAIRS.map(|[i, j]| b.float_param(format!("c_{i}{j}"))));
    let [(x, along_x), (y, along_y), (z, along_z)] = [0, 1, 2].map(|axis| {
        let end = ((index >> axis as u32) & 1).to_float();
        point = point.stepped(axis, end);
        profile(fractions[axis], end, covariance.at(axis, axis))
    });
    let product = Product {
        axes: [along_x, along_y, along_z],
        covariance,
    };

    // E[g·X W(X)] = (g·t) E[W] + (Cg)·∇E[W].
    let g = gradient(point, kind);
    let along = dot(g, [x, y, z]);
    let turned = covariance.times(g);
    let whole = product.derivative(&[]);
    let slopes = [0, 1, 2].map(|i| product.derivative(&[i]));
    let mut all = vec![along * whole + dot(turned, slopes)];
    if parts > 1 {
        for i in 0..3 {
            let bends = [0, 1, 2].map(|j| product.derivative(&[i, j]));
            let own = g[i] * whole + along * slopes[i];
            all.push(own + dot(turned, bends));
        }
    }
    if parts > 4 {
        for [i, j] in PAIRS {
            let thirds = [0, 1, 2].map(|k| product.derivative(&[i, j, k]));
            let bend = product.derivative(&[i, j]);
            let own = g[i] * slopes[j] + g[j] * slopes[i] + along * bend;
            all.push(own + dot(turned, thirds));
        }
    }
    b.sums(NAMES, sums, all);
    b.finish(module)
}
