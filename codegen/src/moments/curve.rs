//! Any function that is smooth between known places, by quadrature at positive weights.
//!
//! What is integrated is the difference from a line through the middle of the Gaussian, so that
//! constants and slopes are exact and a footprint of 0 gives the value; derivatives act on the
//! density (Stein), and the distortion is a sum of squares. Without places where the function
//! bends, nine equidistant standard scores, whose error falls faster than any power for an analytic
//! function; with them, ten-point Gauss–Legendre on each piece, and closed forms where the function
//! is constant.

use super::{Gaussian, Moments, Normal, Transfer, normal::probability};
use crate::ir::Float;

/// A function of one number by its values.
pub struct Curve<'b, F> {
    /// The function.
    pub function: F,
    /// Where it is not smooth, sorted.
    pub kinks: Vec<Float<'b>>,
    /// The constant that it is before the first kink and after the last one, where it is one.
    pub flat: [Option<Float<'b>>; 2],
    /// Its range.
    pub range: [f32; 2],
}

/// How far in σ a Gaussian reaches.
const REACH: f32 = 4.75;

/// Ten-point Gauss–Legendre on [0, 1].
pub(super) const TEN: [(f32, f32); 10] = [
    (0.013_046_736, 0.033_335_67),
    (0.067_468_32, 0.074_725_67),
    (0.160_295_22, 0.109_543_18),
    (0.283_302_3, 0.134_633_36),
    (0.425_562_83, 0.147_762_11),
    (0.574_437_17, 0.147_762_11),
    (0.716_697_7, 0.134_633_36),
    (0.839_704_78, 0.109_543_18),
    (0.932_531_68, 0.074_725_67),
    (0.986_953_26, 0.033_335_67),
];

/// Equidistant standard scores, so far apart before their variance is made 1, with Gaussian weights of
/// unit sum and variance.
pub(super) fn scores<const N: usize>(step: f64) -> [(f32, f32); N] {
    let middle = (N - 1) as f64 / 2.0;
    let scores: [f64; N] = std::array::from_fn(|i| (i as f64 - middle) * step);
    let weights = scores.map(|z| (-0.5 * z * z).exp());
    let total: f64 = weights.iter().sum();
    let parts = scores.iter().zip(&weights);
    let variance: f64 = parts.map(|(z, w)| z * z * w / total).sum();
    std::array::from_fn(|i| {
        let score = scores[i] / variance.sqrt();
        (score as f32, (weights[i] / total) as f32)
    })
}

/// A node of the quadrature: z, its weight, and the function there.
struct Node<'b> {
    z: Float<'b>,
    weight: Float<'b>,
    value: Float<'b>,
}

/// A piece on which the function is constant: ∫ zᵏφ over it for k = 0…4, and the function.
struct Flat<'b> {
    moments: [Float<'b>; 5],
    value: Float<'b>,
}

impl<'b, F: Fn(Float<'b>) -> Float<'b>> Curve<'b, F> {
    /// A function that is smooth everywhere.
    pub fn smooth(function: F, range: [f32; 2]) -> Self {
        Self {
            function,
            kinks: Vec::new(),
            flat: [None; 2],
            range,
        }
    }

    fn node(&self, x: &Gaussian<'b>, z: Float<'b>, weight: Float<'b>) -> Node<'b> {
        let value = (self.function)(x.mean + x.sd * z);
        Node { z, weight, value }
    }

    /// The pieces between the kinks.
    fn pieces(&self, x: &Gaussian<'b>) -> (Vec<Node<'b>>, Vec<Flat<'b>>) {
        let number = |z: f32| x.mean.literal(z);
        if self.kinks.is_empty() {
            let nodes = scores::<9>(1.1).map(|(z, weight)| self.node(x, number(z), number(weight)));
            return (nodes.into(), Vec::new());
        }
        // Standard scores of edges are −z: the first edge is the leftmost.
        let mut edges = vec![Normal::of(number(12.0))];
        edges.extend((self.kinks.iter()).map(|&kink| Normal::at(x.mean - kink, x.inverse_sd)));
        edges.push(Normal::of(number(-12.0)));
        let (mut nodes, mut flats) = (Vec::new(), Vec::new());
        for (i, ends) in edges.windows(2).enumerate() {
            let flat = match i {
                0 => self.flat[0],
                _ if i == self.kinks.len() => self.flat[1],
                _ => None,
            };
            match flat {
                Some(value) => {
                    let moments = truncated(&ends[0], &ends[1]);
                    flats.push(Flat { moments, value });
                }
                None => nodes.extend(self.curved(x, &ends[0], &ends[1])),
            }
        }
        (nodes, flats)
    }

    /// The nodes of one piece, whose weights sum to its probability.
    fn curved(&self, x: &Gaussian<'b>, from: &Normal<'b>, to: &Normal<'b>) -> [Node<'b>; 10] {
        let [start, end] = [from, to].map(|edge| (-edge.z).clamp(-REACH, REACH));
        let width = end - start;
        let rows = TEN.map(|(node, weight)| {
            let z = start + width * node;
            (z, (z.square() * -0.5).exp() * weight)
        });
        let total = width.builder().sum(rows.map(|(_, weight)| weight));
        let share = probability(from, to) / total;
        rows.map(|(z, weight)| self.node(x, z, weight * share))
    }
}

/// ∫ zᵏφ for k = 0…4 between two edges.
fn truncated<'b>(from: &Normal<'b>, to: &Normal<'b>) -> [Float<'b>; 5] {
    let (mut left, mut right) = (from.density, to.density);
    let mut out = [probability(from, to); 5];
    out[1] = left - right;
    for k in 2..5 {
        (left, right) = (-from.z * left, -to.z * right);
        out[k] = out[k - 2] * (k - 1) as f32 + (left - right);
    }
    out
}

impl<'b, F: Fn(Float<'b>) -> Float<'b>> Transfer<'b> for Curve<'b, F> {
    fn value(&self, x: Float<'b>) -> Float<'b> {
        (self.function)(x)
    }

    fn is_steep(&self) -> bool {
        true
    }

    fn moments(&self, x: &Gaussian<'b>) -> Moments<'b> {
        let (nodes, flats) = self.pieces(x);
        // The line c + dz through the middle, and the secant over ±σ.
        let c = self.value(x.mean);
        let d = (self.value(x.mean + x.sd) - self.value(x.mean - x.sd)) * 0.5;

        // ∫ (T − c − dz) Heₙ φ.
        let mut sums = [c.literal(0.0); 4];
        let mut add = |terms: [Float<'b>; 4]| {
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum += term;
            }
        };
        for &Node { z, weight, value } in &nodes {
            let beyond = weight * (value - (c + d * z));
            let z2 = z.square();
            add([
                beyond,
                beyond * z,
                beyond * (z2 + -1.0),
                beyond * ((z2 + -3.0) * z),
            ]);
        }
        for flat in &flats {
            let k = flat.value - c;
            let [i0, i1, i2, i3, i4] = flat.moments;
            add([
                k * i0 - d * i1,
                k * i1 - d * i2,
                k * (i2 - i0) - d * (i3 - i1),
                k * (i3 - i1 * 3.0) - d * (i4 - i2 * 3.0),
            ]);
        }
        let [mean, first, second, third] = sums;
        let (mean, first) = (mean + c, first + d);

        // ∫ (T − mean − first z)² φ.
        let curved = nodes.iter().map(|&Node { z, weight, value }| {
            let residual = value - (mean + first * z);
            weight * residual.square()
        });
        let flat = flats.iter().map(|flat| {
            let k = flat.value - mean;
            let [i0, i1, i2, ..] = flat.moments;
            (k.square() * i0 + k * first * -2.0 * i1 + first.square() * i2).max(0.0)
        });
        let distortion = c.builder().sum(curved.chain(flat));

        let (inverse, inverse2) = (x.inverse_sd, x.inverse_sd.square());
        let mean = match self.range {
            [low, high] if low.is_finite() && high.is_finite() => mean.clamp(low, high),
            _ => mean,
        };
        let derivatives = [
            mean,
            first * inverse,
            second * inverse2,
            third * (inverse * inverse2),
        ];
        Moments::of(derivatives, distortion)
    }

    fn range(&self, _: [f32; 2]) -> [f32; 2] {
        self.range
    }
}
