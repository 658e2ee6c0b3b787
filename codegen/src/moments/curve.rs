//! Any function that is smooth between known places, by quadrature at positive weights.
//!
//! What is integrated is the difference from a line through the middle of the Gaussian, so that
//! constants and slopes are exact and a footprint of 0 gives the value; derivatives act on the
//! density (Stein), and the distortion is a sum of squares. Without places where the function
//! bends, nine equidistant standard scores, whose error falls faster than any power for an analytic
//! function; with them, ten-point Gauss–Legendre on each piece, and closed forms where the function
//! is constant.

use super::{Gaussian, Moments, Normal, Transfer, piecewise::probability};
use crate::ir::{Builder, Value};

/// A function of one number by its values.
pub struct Curve<F> {
    /// The function.
    pub function: F,
    /// Where it is not smooth, sorted.
    pub kinks: Vec<Value>,
    /// The constant that it is before the first kink and after the last one, where it is one.
    pub flat: [Option<Value>; 2],
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

/// Equidistant standard scores with Gaussian weights of unit sum and variance.
fn scores() -> [(f32, f32); 9] {
    let scores: [f64; 9] = std::array::from_fn(|i| (i as f64 - 4.0) * 1.1);
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
struct Node {
    z: Value,
    weight: Value,
    value: Value,
}

/// A piece on which the function is constant: ∫ zᵏφ over it for k = 0…4, and the function.
struct Flat {
    moments: [Value; 5],
    value: Value,
}

impl<F: Fn(&mut Builder, Value) -> Value> Curve<F> {
    /// A function that is smooth everywhere.
    pub fn smooth(function: F, range: [f32; 2]) -> Self {
        Self {
            function,
            kinks: Vec::new(),
            flat: [None; 2],
            range,
        }
    }

    fn node(&self, b: &mut Builder, x: &Gaussian, z: Value, weight: Value) -> Node {
        let deviation = b.mul(x.sd, z);
        let at = b.add(x.mean, deviation);
        let value = (self.function)(b, at);
        Node { z, weight, value }
    }

    /// The pieces between the kinks.
    fn pieces(&self, b: &mut Builder, x: &Gaussian) -> (Vec<Node>, Vec<Flat>) {
        let (mut nodes, mut flats) = (Vec::new(), Vec::new());
        if self.kinks.is_empty() {
            for (score, weight) in scores() {
                let (z, weight) = (b.f32(score), b.f32(weight));
                nodes.push(self.node(b, x, z, weight));
            }
            return (nodes, flats);
        }
        let normals: Vec<Normal> = (self.kinks.iter())
            .map(|&kink| {
                let distance = b.sub(x.mean, kink);
                Normal::at(b, distance, x.inverse_sd)
            })
            .collect();
        let edge = |b: &mut Builder, z: f32| {
            let z = b.f32(z);
            Normal::of(b, z)
        };
        // Standard scores of edges are −z: the first edge is the leftmost.
        let (first, last) = (edge(b, 12.0), edge(b, -12.0));
        let edges: Vec<Normal> = std::iter::once(first)
            .chain(normals)
            .chain([last])
            .collect();
        for (i, ends) in edges.windows(2).enumerate() {
            let flat = match i {
                0 => self.flat[0],
                _ if i + 1 == edges.len() - 1 => self.flat[1],
                _ => None,
            };
            match flat {
                Some(value) => {
                    let moments = truncated(b, &ends[0], &ends[1]);
                    flats.push(Flat { moments, value });
                }
                None => self.curved(b, x, &ends[0], &ends[1], &mut nodes),
            }
        }
        (nodes, flats)
    }

    /// The nodes of one piece, whose weights sum to its probability.
    fn curved(
        &self,
        b: &mut Builder,
        x: &Gaussian,
        from: &Normal,
        to: &Normal,
        nodes: &mut Vec<Node>,
    ) {
        let [start, end] = [from.z, to.z].map(|z| {
            let z = b.neg(z);
            b.clamp(z, -REACH, REACH)
        });
        let width = b.sub(end, start);
        let mut rows = Vec::with_capacity(TEN.len());
        let mut total = b.f32(0.0);
        for (node, weight) in TEN {
            let step = b.scale(width, node);
            let z = b.add(start, step);
            let square = b.square(z);
            let exponent = b.scale(square, -0.5);
            let density = b.exp(exponent);
            let weight = b.scale(density, weight);
            total = b.add(total, weight);
            rows.push((z, weight));
        }
        let p = probability(b, from, to);
        let share = b.div(p, total);
        for (z, weight) in rows {
            let weight = b.mul(weight, share);
            nodes.push(self.node(b, x, z, weight));
        }
    }
}

/// ∫ zᵏφ for k = 0…4 between two edges.
fn truncated(b: &mut Builder, from: &Normal, to: &Normal) -> [Value; 5] {
    let (a, e) = (b.neg(from.z), b.neg(to.z));
    let (mut left, mut right) = (from.density, to.density);
    let zeroth = probability(b, from, to);
    let mut out = [zeroth, b.sub(left, right), zeroth, zeroth, zeroth];
    for k in 2..5 {
        (left, right) = (b.mul(a, left), b.mul(e, right));
        let edge = b.sub(left, right);
        let before = b.scale(out[k - 2], (k - 1) as f32);
        out[k] = b.add(before, edge);
    }
    out
}

impl<F: Fn(&mut Builder, Value) -> Value> Transfer for Curve<F> {
    fn value(&self, b: &mut Builder, x: Value) -> Value {
        (self.function)(b, x)
    }

    fn moments(&self, b: &mut Builder, x: &Gaussian) -> Moments {
        let (nodes, flats) = self.pieces(b, x);
        // The line c + dz through the middle, and the secant over ±σ.
        let c = self.value(b, x.mean);
        let (above, below) = (b.add(x.mean, x.sd), b.sub(x.mean, x.sd));
        let (above, below) = (self.value(b, above), self.value(b, below));
        let d = b.sub(above, below);
        let d = b.scale(d, 0.5);
        let mut sums = [b.f32(0.0); 4];
        for node in &nodes {
            let line = b.mul(d, node.z);
            let line = b.add(c, line);
            let beyond = b.sub(node.value, line);
            let first = b.mul(node.weight, beyond);
            let square = b.square(node.z);
            let (second, third) = (b.offset(square, -1.0), b.offset(square, -3.0));
            let third = b.mul(third, node.z);
            let factors = [b.f32(1.0), node.z, second, third];
            for (sum, factor) in sums.iter_mut().zip(factors) {
                let part = b.mul(first, factor);
                *sum = b.add(*sum, part);
            }
        }
        for flat in &flats {
            // ∫ (k − dz) Heₙ φ.
            let k = b.sub(flat.value, c);
            let [i0, i1, i2, i3, i4] = flat.moments;
            let (i1x3, i2x3) = (b.scale(i1, 3.0), b.scale(i2, 3.0));
            let rows = [
                (i0, i1),
                (i1, i2),
                (b.sub(i2, i0), b.sub(i3, i1)),
                (b.sub(i3, i1x3), b.sub(i4, i2x3)),
            ];
            for (sum, (constant, linear)) in sums.iter_mut().zip(rows) {
                let (rise, fall) = (b.mul(k, constant), b.mul(d, linear));
                let part = b.sub(rise, fall);
                *sum = b.add(*sum, part);
            }
        }
        let [mean, first, second, third] = sums;
        let (mean, first) = (b.add(mean, c), b.add(first, d));
        let mut distortion = b.f32(0.0);
        for node in &nodes {
            let line = b.mul(first, node.z);
            let line = b.add(mean, line);
            let residual = b.sub(node.value, line);
            let square = b.square(residual);
            let part = b.mul(node.weight, square);
            distortion = b.add(distortion, part);
        }
        for flat in &flats {
            // ∫ (k − sz)² φ.
            let k = b.sub(flat.value, mean);
            let [i0, i1, i2, ..] = flat.moments;
            let (k2, s2, cross) = (b.square(k), b.square(first), b.mul(k, first));
            let cross = b.scale(cross, -2.0);
            let part = b.dot(&[k2, cross, s2], &[i0, i1, i2]);
            let zero = b.f32(0.0);
            let part = b.max(part, zero);
            distortion = b.add(distortion, part);
        }
        let (inverse, inverse2) = (x.inverse_sd, b.square(x.inverse_sd));
        let inverse3 = b.mul(inverse, inverse2);
        let [low, high] = self.range;
        let mean = match (low.is_finite(), high.is_finite()) {
            (true, true) => b.clamp(mean, low, high),
            _ => mean,
        };
        Moments {
            mean,
            slope: b.mul(first, inverse),
            curvature: b.mul(second, inverse2),
            third: b.mul(third, inverse3),
            distortion,
        }
    }

    fn range(&self, _: &Builder, _: [f32; 2]) -> [f32; 2] {
        self.range
    }
}
