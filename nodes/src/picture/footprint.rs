//! A footprint as parts that are round: probes along its longer axis, and where the field is not a
//! picture alone, four or nine parts of the pixel.
//!
//! The part (k, j) is a Gaussian of variance v at k steps along the longer axis from node j of the pixel.
//! - Nodes: for a Gaussian filter 2 × 2 with half of the variance, where it is less than a texel or as
//!   large as the tiles; 3 × 3 with 8/9 for a box, whose transform they follow to the second zero.
//!   They meet as the footprint becomes 3 times as long as wide, and are one from there.
//! - Probes: at multiples of d = 2.2 √v with weights (1 − k²/ρ²)², ρ = √7 σ_e/d + 1, stretched so that
//!   their variance is σ_e² = σ₁² − v. A probe is born and dies with a weight of 0, so the result is
//!   continuous in the footprint. Beyond `longest` the shorter axis is taken for longer.

use mipless_codegen::PixelFilter;
use mipless_codegen::ir::{Builder, Type, Value};
use mipless_codegen::moments::Signal;

/// The parts that a footprint has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parts {
    /// How many times longer than wide a footprint is at most.
    pub(crate) longest: f32,
    /// Whether the pixel has nodes.
    pub(crate) nodes: bool,
}

/// Between these variances, in squared texels, the nodes of a Gaussian filter meet: under smaller ones
/// the texels between which is interpolated still show.
const TEXELS: [f32; 2] = [0.8, 0.4];

/// Between the first two, in squared pictures, they part again, and meet between the others: there
/// tiles begin and end within the footprint, and still differ.
const TILES: [[f32; 2]; 2] = [[0.0057, 0.012], [0.0576, 0.0289]];

/// 0 at the first number and beyond, 1 at the second.
fn ramp(b: &mut Builder, x: Value, [from, to]: [f32; 2]) -> Value {
    let x = b.offset(x, -from);
    let x = b.scale(x, 1.0 / (to - from));
    b.clamp(x, 0.0, 1.0)
}

/// The distance of probes, in the parts' own σ.
const DISTANCE: f32 = 2.2;
/// Positions spread over more texels than this are spread over it.
const WIDEST: f32 = 1.0e5;

/// A footprint in texels.
#[derive(Clone, Debug)]
pub(crate) struct Footprint {
    /// Σ₁₁, Σ₁₂, Σ₂₂.
    pub(crate) covariance: [Value; 3],
    /// How many parts.
    pub(crate) count: Value,
    /// What [`part`] needs of it: see there.
    pub(crate) captures: Vec<Value>,
}

/// The names of [`Footprint::captures`].
pub(crate) const CAPTURES: [&str; 9] = [
    "variance",
    "step_x",
    "step_y",
    "rho",
    "half",
    "norm",
    "side",
    "node_step",
    "nodes",
];

/// The eigenvalues of a covariance, the larger first, and the direction of the larger.
fn axes(b: &mut Builder, [xx, xy, yy]: [Value; 3]) -> ([Value; 2], [Value; 2]) {
    let (sum, difference) = (b.add(xx, yy), b.sub(xx, yy));
    let (half, tilt) = (b.scale(sum, 0.5), b.scale(difference, 0.5));
    let square = b.dot(&[tilt, xy], &[tilt, xy]);
    let root = b.sqrt(square);
    let zero = b.f32(0.0);
    let (more, less) = (b.add(half, root), b.sub(half, root));
    let less = b.max(less, zero);
    // (tilt + root, xy) or (xy, root − tilt): whichever is longer.
    let upright = b.lt(tilt, zero);
    let (along, across) = (b.add(root, tilt), b.sub(root, tilt));
    let x = b.select(upright, xy, along);
    let y = b.select(upright, across, xy);
    let length = b.dot(&[x, y], &[x, y]);
    let tiny = b.f32(1e-30);
    let one = b.f32(1.0);
    let pointed = b.lt(tiny, length);
    let length = b.select(pointed, length, one);
    let length = b.sqrt(length);
    let (x, y) = (b.select(pointed, x, one), b.select(pointed, y, zero));
    ([more, less], [b.div(x, length), b.div(y, length)])
}

impl Footprint {
    /// Of a position in pictures of so many texels.
    pub(crate) fn of(
        b: &mut Builder,
        position: &[Signal],
        texels: [f32; 2],
        filter: PixelFilter,
        parts: Parts,
    ) -> (Self, [[Value; 2]; 2]) {
        let [x, y] = position else {
            panic!("a position has two coordinates")
        };
        let [w, h] = texels;
        let covariance = x.covariance(b, y);
        let (vx, vy) = (x.variance(b), y.variance(b));
        let covariance = [
            b.scale(vx, w * w),
            b.scale(covariance.total, w * h),
            b.scale(vy, h * h),
        ];
        let limit = b.f32(WIDEST * WIDEST);
        let largest = b.max(covariance[0], covariance[2]);
        let largest = b.max(largest, limit);
        let factor = b.div(limit, largest);
        let covariance = covariance.map(|c| b.mul(c, factor));
        let root = b.sqrt(factor);
        // The pixel's own axes, in texels.
        let sides = [0, 1].map(|i| {
            [(x.g[i], w), (y.g[i], h)].map(|(g, n)| {
                let g = b.scale(g, n);
                b.mul(g, root)
            })
        });
        let (zero, one) = (b.f32(0.0), b.f32(1.0));
        let (share, side) = if parts.nodes {
            let ([more, less], _) = axes(b, covariance);
            let floor = b.scale(more, 1e-4);
            let less = b.max(less, floor);
            let less = b.offset(less, 1e-20);
            let ratio = b.div(more, less);
            let ratio = b.sqrt(ratio);
            // 1 at a ratio of 1, 0 from 3 on.
            let fade = b.scale(ratio, -0.5);
            let fade = b.offset(fade, 1.5);
            let fade = b.clamp(fade, 0.0, 1.0);
            let (most, count, fade) = match filter {
                PixelFilter::Box => (8.0 / 9.0, 3.0, fade),
                PixelFilter::Gaussian(_) => {
                    let pictures = b.scale(less, 1.0 / (w * h));
                    let texels = ramp(b, less, TEXELS);
                    let rises = ramp(b, pictures, TILES[0]);
                    let falls = ramp(b, pictures, TILES[1]);
                    let middle = b.min(rises, falls);
                    let needed = b.max(texels, middle);
                    (0.5, 2.0, b.mul(fade, needed))
                }
            };
            let (share, count) = (b.scale(fade, most), b.f32(count));
            let split = b.lt(zero, share);
            (share, b.select(split, count, one))
        } else {
            (zero, one)
        };
        let [[ax, ay], [cx, cy]] = sides;
        let taken = [
            b.dot(&[ax, cx], &[ax, cx]),
            b.dot(&[ax, cx], &[ay, cy]),
            b.dot(&[ay, cy], &[ay, cy]),
        ];
        let left = [0, 1, 2].map(|i| {
            let part = b.mul(taken[i], share);
            b.sub(covariance[i], part)
        });
        let ([more, less], direction) = axes(b, left);
        let least = b.scale(more, 1.0 / (parts.longest * parts.longest));
        let variance = b.max(less, least);
        let beyond = b.sub(more, variance);
        let beyond = b.max(beyond, zero);
        let raised = b.offset(variance, 1e-20);
        let ratio = b.div(beyond, raised);
        let ratio = b.sqrt(ratio);
        let rho = b.scale(ratio, 7f32.sqrt() / DISTANCE);
        let rho = b.offset(rho, 1.0);
        let half = b.offset(rho, -1e-3);
        let half = b.floor(half);
        // Σ 1, Σ k², Σ k⁴, Σ k⁶ over −half..=half.
        let two = b.scale(half, 2.0);
        let sum0 = b.offset(two, 1.0);
        let next = b.offset(half, 1.0);
        let sum2 = b.mul(half, next);
        let sum2 = b.mul(sum2, sum0);
        let sum2 = b.scale(sum2, 1.0 / 3.0);
        let square = b.mul(half, next);
        let inner4 = b.scale(square, 3.0);
        let inner4 = b.offset(inner4, -1.0);
        let sum4 = b.mul(sum2, inner4);
        let sum4 = b.scale(sum4, 0.2);
        // 3h⁴ + 6h³ − 3h + 1 = 3 q² − 3 q + 1 with q = h(h + 1).
        let inner6 = b.offset(square, -1.0);
        let inner6 = b.mul(inner6, square);
        let inner6 = b.scale(inner6, 3.0);
        let inner6 = b.offset(inner6, 1.0);
        let sum6 = b.mul(sum2, inner6);
        let sum6 = b.scale(sum6, 1.0 / 7.0);
        let rho2 = b.square(rho);
        let inverse = b.div(one, rho2);
        let inverse2 = b.square(inverse);
        let twice = b.scale(inverse, -2.0);
        let total = b.dot(&[one, twice, inverse2], &[sum0, sum2, sum4]);
        let second = b.dot(&[one, twice, inverse2], &[sum2, sum4, sum6]);
        let norm = b.div(one, total);
        let second = b.mul(second, norm);
        let second = b.offset(second, 1e-20);
        let stretch = b.div(beyond, second);
        let stretch = b.sqrt(stretch);
        let alone = b.lt(half, one);
        let stretch = b.select(alone, zero, stretch);
        let step = [b.mul(direction[0], stretch), b.mul(direction[1], stretch)];
        let step = [b.scale(step[0], 1.0 / w), b.scale(step[1], 1.0 / h)];
        // Equal weights at this distance have the share of the variance: 12/(n² − 1).
        let split = b.square(side);
        let split = b.offset(split, -1.0);
        let split = b.max(split, one);
        let node_step = b.div(share, split);
        let node_step = b.scale(node_step, 12.0);
        let node_step = b.sqrt(node_step);
        let nodes = b.square(side);
        let count = b.mul(sum0, nodes);
        let count = b.trunc_i(count);
        let count = b.cast_u(count);
        let footprint = Self {
            covariance,
            count,
            captures: vec![
                variance, step[0], step[1], rho, half, norm, side, node_step, nodes,
            ],
        };
        let pixel = sides.map(|[x, y]| [b.scale(x, 1.0 / w), b.scale(y, 1.0 / h)]);
        (footprint, pixel)
    }
}

/// A part of a footprint.
pub(crate) struct Part {
    /// Where it is, from the middle, in pictures.
    pub(crate) offset: [Value; 2],
    /// Its share; all shares are 1.
    pub(crate) weight: Value,
    /// Its variance in texels.
    pub(crate) variance: Value,
}

/// The part of this index; `captures` are those of [`Footprint`] and, for nodes, the pixel's axes in
/// pictures.
pub(crate) fn part(
    b: &mut Builder,
    index: Value,
    captures: &[Value],
    pixel: Option<[[Value; 2]; 2]>,
) -> Part {
    let [
        variance,
        step_x,
        step_y,
        rho,
        half,
        norm,
        side,
        node_step,
        nodes,
    ] = captures[..]
    else {
        panic!("the captures of a footprint")
    };
    assert_eq!(b.ty(index), Type::U32, "the index of a part");
    let index = b.float_u(index);
    let (probe, node) = match pixel {
        None => (index, None),
        Some(pixel) => {
            let shifted = b.offset(index, 0.5);
            let probe = b.div(shifted, nodes);
            let probe = b.floor(probe);
            let before = b.mul(probe, nodes);
            let node = b.sub(index, before);
            let shifted = b.offset(node, 0.5);
            let row = b.div(shifted, side);
            let row = b.floor(row);
            let before = b.mul(row, side);
            let column = b.sub(node, before);
            let middle = b.offset(side, -1.0);
            let middle = b.scale(middle, 0.5);
            let place = [column, row].map(|place| {
                let place = b.sub(place, middle);
                b.mul(place, node_step)
            });
            (probe, Some((place, pixel)))
        }
    };
    let k = b.sub(probe, half);
    let relative = b.div(k, rho);
    let relative = b.square(relative);
    let one = b.f32(1.0);
    let weight = b.sub(one, relative);
    let weight = b.square(weight);
    let mut weight = b.mul(weight, norm);
    let mut offset = [b.mul(k, step_x), b.mul(k, step_y)];
    if let Some((place, pixel)) = node {
        weight = b.div(weight, nodes);
        for axis in [0, 1] {
            let own = b.dot(&place, &[pixel[0][axis], pixel[1][axis]]);
            offset[axis] = b.add(offset[axis], own);
        }
    }
    Part {
        offset,
        weight,
        variance,
    }
}
