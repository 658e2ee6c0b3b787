//! The virtual split: a map read at four parts of the footprint, from one evaluation of its inputs.
//!
//! The share r of the footprint goes into the nodes (±1, ±1): part k has the mean m + √r g·x_k + r
//! h₁₂ x₁x₂, the gradient g + √r H x_k, and the rest of the footprint and of the second order in its
//! covariance. It holds the skewness that the quadratic model has (MATH §3), for two signals at once.

use super::super::signal::half_contraction;
use super::{Map, Signal};
use crate::ir::{Builder, Value};

/// r = 0.7 min(1, 2h/√(|g|² + h²)), h² = ½‖H‖², where the second order is strong.
const LARGEST: f32 = 0.7;

/// The means of all components; `None` where no second order is carried.
pub(super) fn means(b: &mut Builder, map: &Map, [x, y]: [&Signal; 2]) -> Option<Vec<Value>> {
    if x.h.iter().chain(&y.h).all(|&h| b.is_zero(h)) {
        return None;
    }
    let (p, q) = (share(b, x), share(b, y));
    let r = b.max(p, q);
    let root = b.sqrt(r);
    let one = b.f32(1.0);
    let rest = b.sub(one, r);
    let pairs = [(x, x), (x, y), (y, y)];
    // What no part changes: symbols and remainders, what is left of the second order, and the
    // diagonal of H, which never moves a part's mean.
    let fixed = pairs.map(|(x, y)| {
        let second = half_contraction(b, x.h, y.h);
        let beyond = if std::ptr::eq(x, y) {
            let mut sum = x.private;
            for &(_, c) in &x.shared {
                let square = b.square(c);
                sum = b.add(sum, square);
            }
            sum
        } else {
            let carried = x.covariance(b, y).rest;
            b.sub(carried, second)
        };
        let left = b.square(rest);
        let left = b.mul(second, left);
        let diagonal = b.dot(&[x.h[0], x.h[2]], &[y.h[0], y.h[2]]);
        let taken = b.square(r);
        let taken = b.scale(taken, 0.5);
        let still = b.mul(diagonal, taken);
        let sum = b.add(beyond, left);
        b.add(sum, still)
    });
    let nodes = [[1.0f32, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
    let mut sums: Option<Vec<Value>> = None;
    for [s, t] in nodes {
        let parts = [x, y].map(|signal| {
            let [g1, g2] = signal.g;
            let [h11, h12, h22] = signal.h;
            let (p, q) = (b.scale(g1, s), b.scale(g2, t));
            let along = b.add(p, q);
            let along = b.mul(along, root);
            let across = b.scale(h12, s * t);
            let across = b.mul(across, r);
            let shift = b.add(along, across);
            let mean = b.add(signal.mean, shift);
            let gradient = [(g1, h11, h12), (g2, h12, h22)].map(|(g, p, q)| {
                let (p, q) = (b.scale(p, s), b.scale(q, t));
                let bent = b.add(p, q);
                let bent = b.mul(bent, root);
                b.add(g, bent)
            });
            (mean, gradient)
        });
        let [(m, g), (n, h)] = parts;
        let linear = [(g, g), (g, h), (h, h)].map(|(p, q)| {
            let dot = b.dot(&p, &q);
            b.mul(dot, rest)
        });
        let covariance = [0, 1, 2].map(|i| b.add(linear[i], fixed[i]));
        let part = map.part(b, [m, n], covariance);
        sums = Some(match sums {
            None => part,
            Some(sums) => (sums.iter().zip(&part))
                .map(|(&p, &q)| b.add(p, q))
                .collect(),
        });
    }
    let sums = sums?;
    Some(sums.into_iter().map(|sum| b.scale(sum, 0.25)).collect())
}

/// The share of the footprint that one signal asks to split.
fn share(b: &mut Builder, signal: &Signal) -> Value {
    let second = half_contraction(b, signal.h, signal.h);
    let linear = signal.linear_variance(b);
    let whole = b.add(linear, second);
    let whole = b.offset(whole, 1e-20);
    let ratio = b.div(second, whole);
    let ratio = b.sqrt(ratio);
    let ratio = b.scale(ratio, 2.0 * LARGEST);
    let most = b.f32(LARGEST);
    b.min(ratio, most)
}
