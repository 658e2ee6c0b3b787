//! The virtual split: a map read at four parts of the footprint, from one evaluation of its inputs.
//!
//! The share r of the footprint goes into the nodes (±1, ±1): part k has the mean m + √r g·x_k + r
//! h₁₂ x₁x₂, the gradient g + √r H x_k, and the rest of the footprint and of the second order in its
//! covariance. It holds the skewness that the quadratic model has (MATH §3), for two signals at once.

use super::{Map, Signal};
use crate::ir::{Float, Sym2, Vec2};

/// r = 0.7 min(1, 2h/√(|g|² + h²)), h² = ½‖H‖², where the second order is strong.
const LARGEST: f32 = 0.7;

/// The means of all components; `None` where no second order is carried.
pub(super) fn means<'b>(map: &Map, [x, y]: [&Signal<'b>; 2]) -> Option<Vec<Float<'b>>> {
    if x.h.iter().chain(&*y.h).all(|h| h.is_zero()) {
        return None;
    }
    let r = share(x).max(share(y));
    let (root, rest) = (r.sqrt(), 1.0 - r);

    // What no part changes: symbols and remainders, what is left of the second order, and the
    // diagonal of H, which never moves a part's mean.
    let own = |x: &Signal<'b>| {
        let squares = x.shared.iter().map(|(_, c)| c.square());
        squares.fold(x.private, |sum, square| sum + square)
    };
    let second = [(x, x), (x, y), (y, y)].map(|(x, y)| x.h.half_contraction(y.h));
    let beyond = [own(x), x.covariance(y).rest - second[1], own(y)];
    let diagonal = [(x, x), (x, y), (y, y)].map(|(x, y)| x.h[0] * y.h[0] + x.h[2] * y.h[2]);
    let fixed = Sym2(beyond) + Sym2(second) * rest.square() + Sym2(diagonal) * (r.square() * 0.5);

    let nodes = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
    let parts = nodes.map(|[s, t]| {
        let node = Vec2([s, t].map(|x: f32| r.literal(x)));
        let mean = [x, y].map(|of| of.mean + (of.g.dot(node) * root + of.h[1] * (s * t) * r));
        let [g, h] = [x, y].map(|of| of.g + of.h.times(node) * root);
        let linear = Sym2([g.norm2(), g.dot(h), h.norm2()]) * rest;
        map.part(Vec2(mean), linear + fixed)
    });
    let components = 0..parts[0].len();
    let sum = |i: usize| r.builder().sum(parts.iter().map(|part| part[i]));
    Some(components.map(|i| sum(i) * 0.25).collect())
}

/// The share of the footprint that one signal asks to split.
fn share<'b>(signal: &Signal<'b>) -> Float<'b> {
    let second = signal.h.half_contraction(signal.h);
    let ratio = second / (signal.linear_variance() + second + 1e-20);
    (ratio.sqrt() * (2.0 * LARGEST)).min(LARGEST)
}
