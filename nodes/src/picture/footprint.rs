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
use mipless_codegen::ir::{Float, Sym2, Uint, Vec2, dot};
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
fn ramp(x: Float<'_>, [from, to]: [f32; 2]) -> Float<'_> {
    ((x + -from) * (1.0 / (to - from))).clamp(0.0, 1.0)
}

/// The distance of probes, in the parts' own σ.
const DISTANCE: f32 = 2.2;
/// Positions spread over more texels than this are spread over it.
const WIDEST: f32 = 1.0e5;

/// A footprint in texels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Footprint<'b> {
    pub(crate) covariance: Sym2<'b>,
    /// How many parts.
    pub(crate) count: Uint<'b>,
    /// What [`part`] needs of it: see there.
    pub(crate) captures: [Float<'b>; 9],
    /// The pixel's axes in pictures, if it has nodes.
    pub(crate) pixel: Option<[Vec2<'b>; 2]>,
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
fn axes(covariance: Sym2<'_>) -> ([Float<'_>; 2], [Float<'_>; 2]) {
    let [xx, xy, yy] = *covariance;
    let (middle, tilt) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let root = (tilt * tilt + xy * xy).sqrt();
    // (tilt + root, xy) or (xy, root − tilt): whichever is longer.
    let upright = tilt.lt(0.0);
    let x = upright.select(xy, root + tilt);
    let y = upright.select(root - tilt, xy);
    let square = x * x + y * y;
    let pointed = square.gt(1e-30);
    let length = pointed.select(square, 1.0).sqrt();
    let direction = [(x, 1.0), (y, 0.0)].map(|(v, none)| pointed.select(v, none) / length);
    ([middle + root, (middle - root).max(0.0)], direction)
}

/// What share of the variance lies between the pixel's nodes, and how many there are a side.
fn nodes<'b>(covariance: Sym2<'b>, [w, h]: [f32; 2], filter: PixelFilter) -> [Float<'b>; 2] {
    let ([more, less], _) = axes(covariance);
    let less = less.max(more * 1e-4) + 1e-20;
    // 1 at a ratio of 1, 0 from 3 on.
    let round = ((more / less).sqrt() * -0.5 + 1.5).clamp(0.0, 1.0);
    let (most, count, apart) = match filter {
        PixelFilter::Box => (8.0 / 9.0, 3.0, round),
        PixelFilter::Gaussian(_) => {
            let pictures = less * (1.0 / (w * h));
            let [rises, falls] = TILES.map(|ends| ramp(pictures, ends));
            (0.5, 2.0, round * ramp(less, TEXELS).max(rises.min(falls)))
        }
    };
    let share = apart * most;
    [share, share.gt(0.0).select(count, 1.0)]
}

impl<'b> Footprint<'b> {
    /// Of a position in pictures of so many texels.
    pub(crate) fn of(
        position: &[Signal<'b>],
        [w, h]: [f32; 2],
        filter: PixelFilter,
        parts: Parts,
    ) -> Self {
        let [x, y] = position else {
            panic!("a position has two coordinates")
        };
        let covariance = Sym2([
            x.variance() * (w * w),
            x.covariance(y).total * (w * h),
            y.variance() * (h * h),
        ]);
        const LIMIT: f32 = WIDEST * WIDEST;
        let factor = LIMIT / covariance[0].max(covariance[2]).max(LIMIT);
        let covariance = covariance * factor;
        // The responses of both coordinates to the pixel, in texels.
        let root = factor.sqrt();
        let (of_x, of_y) = (x.g * w * root, y.g * h * root);

        // What is left of the covariance between the nodes.
        let (zero, one) = (factor.literal(0.0), factor.literal(1.0));
        let [share, side] = if parts.nodes {
            nodes(covariance, [w, h], filter)
        } else {
            [zero, one]
        };
        let own = Sym2([of_x.norm2(), of_x.dot(of_y), of_y.norm2()]);
        let ([more, less], direction) = axes(covariance - own * share);
        let variance = less.max(more * (1.0 / (parts.longest * parts.longest)));
        let beyond = (more - variance).max(0.0);

        // The probes: h on each side of the middle, and ρ.
        let rho = (beyond / (variance + 1e-20)).sqrt() * (7f32.sqrt() / DISTANCE) + 1.0;
        let half = (rho + -1e-3).floor();
        // Σ 1, Σ k², Σ k⁴, Σ k⁶ over −h..=h, with q = h(h + 1); 3h⁴ + 6h³ − 3h + 1 = 3 q² − 3 q + 1.
        let q = half * (half + 1.0);
        let sum0 = half * 2.0 + 1.0;
        let sum2 = q * sum0 * (1.0 / 3.0);
        let sum4 = sum2 * (q * 3.0 + -1.0) * 0.2;
        let sum6 = sum2 * ((q + -1.0) * q * 3.0 + 1.0) * (1.0 / 7.0);
        // The weights (1 − k²/ρ²)², and the variance of what they weigh.
        let inverse = 1.0 / rho.square();
        let weights = [one, inverse * -2.0, inverse.square()];
        let norm = 1.0 / dot(weights, [sum0, sum2, sum4]);
        let second = dot(weights, [sum2, sum4, sum6]) * norm + 1e-20;
        let stretch = half.lt(1.0).select(0.0, (beyond / second).sqrt());
        let [step_x, step_y] = [(0, w), (1, h)].map(|(i, n)| direction[i] * stretch * (1.0 / n));

        // Equal weights at this distance have the share of the variance: 12/(n² − 1).
        let nodes = side.square();
        let node_step = (share / (nodes + -1.0).max(1.0) * 12.0).sqrt();
        let pixel = [0, 1].map(|i| Vec2([of_x[i] * (1.0 / w), of_y[i] * (1.0 / h)]));
        Self {
            covariance,
            count: (sum0 * nodes).to_int().to_uint(),
            captures: [
                variance, step_x, step_y, rho, half, norm, side, node_step, nodes,
            ],
            pixel: parts.nodes.then_some(pixel),
        }
    }
}

/// A part of a footprint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part<'b> {
    /// Where it is, from the middle, in pictures.
    pub(crate) offset: Vec2<'b>,
    /// Its share; all shares are 1.
    pub(crate) weight: Float<'b>,
    /// Its variance in texels.
    pub(crate) variance: Float<'b>,
}

/// The part of this index; `captures` and `pixel` are those of [`Footprint`].
pub(crate) fn part<'b>(
    index: Uint<'b>,
    captures: [Float<'b>; 9],
    pixel: Option<[Vec2<'b>; 2]>,
) -> Part<'b> {
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
    ] = captures;
    let index = index.to_float();
    let divided = |number: Float<'b>, by: Float<'b>| {
        let whole = ((number + 0.5) / by).floor();
        (whole, number - whole * by)
    };
    let (probe, node) = match pixel {
        None => (index, None),
        Some(pixel) => {
            let (probe, node) = divided(index, nodes);
            (probe, Some((node, pixel)))
        }
    };
    let k = probe - half;
    let mut weight = (1.0 - (k / rho).square()).square() * norm;
    let mut offset = Vec2([k * step_x, k * step_y]);
    if let Some((node, [along, across])) = node {
        let (row, column) = divided(node, side);
        let middle = (side + -1.0) * 0.5;
        let [x, y] = [column, row].map(|place| (place - middle) * node_step);
        weight = weight / nodes;
        offset = offset + (along * x + across * y);
    }
    Part {
        offset,
        weight,
        variance,
    }
}
