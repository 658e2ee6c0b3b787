//! The moments of a field over the parts of a footprint, and the signals that they make.

use super::footprint::{CAPTURES, Footprint, Part, part};
use super::pyramid::triangle;
use super::read::Tap;
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Type, Value};
use mipless_codegen::moments::Signal;

/// A field over a footprint: mean and gradient (a texel) by channel, and the lower triangle of the
/// covariance; without moments, the means alone.
#[derive(Clone, Debug)]
pub(crate) struct Gathered {
    pub(crate) mean: Vec<Value>,
    pub(crate) gradient: Vec<[Value; 2]>,
    pub(crate) covariance: Vec<Value>,
}

/// Where a field is read: the footprint, the pixel's axes in pictures if it has nodes, and whatever
/// else each part needs.
pub(crate) struct Place<'a> {
    pub(crate) footprint: &'a Footprint,
    pub(crate) pixel: Option<[[Value; 2]; 2]>,
    pub(crate) more: Vec<Value>,
}

/// Gathers the field that `at` gives for a part, over all parts: means and covariances by West's
/// recurrence (1979), so that no second moment appears and covariances are positive semi-definite.
///
/// The covariance of a part is that of its gradient and what is beyond it; between the parts it is
/// that of their means (Grenier et al. 2022, eq. 14, 15, 18 and 19).
pub(crate) fn gather(
    lower: &mut Lower<'_>,
    key: &str,
    (channels, carries): (usize, bool),
    place: &Place<'_>,
    at: impl FnOnce(&mut Builder, &Part, &[Value]) -> Tap,
) -> Gathered {
    let numbers = if carries {
        3 * channels + triangle(channels)
    } else {
        channels
    };
    let types: Vec<Type> = place.more.iter().map(|&v| lower.b().ty(v)).collect();
    let has_nodes = place.pixel.is_some();
    let body = lower.function(&format!("{key} gather {carries}"), |module| {
        let mut b = Builder::new("part_of_footprint", "One more part of the footprint.");
        let index = b.param("index", Type::U32);
        let before = b.param_f32("weight_so_far");
        let state: Vec<Value> = (0..numbers)
            .map(|i| b.param_f32(format!("state_{i}")))
            .collect();
        let captures = CAPTURES.map(|name| b.param_f32(name));
        let pixel = has_nodes.then(|| {
            ["a", "b"].map(|side| ["x", "y"].map(|axis| b.param_f32(format!("pixel_{side}{axis}"))))
        });
        let more: Vec<Value> = (types.iter().enumerate())
            .map(|(i, &ty)| b.param(format!("place_{i}"), ty))
            .collect();
        let part = part(&mut b, index, &captures, pixel);
        let tap = at(&mut b, &part, &more);
        let weight = part.weight;
        let after = b.add(before, weight);
        let tiny = b.f32(1e-30);
        let divisor = b.max(after, tiny);
        let share = b.div(weight, divisor);
        b.result("weight_so_far", after);
        let deviation: Vec<Value> = (tap.mean.iter().zip(&state))
            .map(|(&mean, &so_far)| b.sub(mean, so_far))
            .collect();
        let mut results = Vec::new();
        for (&deviation, &so_far) in deviation.iter().zip(&state) {
            let step = b.mul(share, deviation);
            results.push(b.add(so_far, step));
        }
        for &slope in tap.gradient.iter().flatten() {
            let step = b.mul(weight, slope);
            results.push(b.add(state[results.len()], step));
        }
        let one = b.f32(1.0);
        let rest = b.sub(one, share);
        for i in 0..if carries { channels } else { 0 } {
            for k in 0..=i {
                let entry = results.len() - 3 * channels;
                let linear = b.dot(&tap.gradient[i], &tap.gradient[k]);
                let linear = b.mul(linear, part.variance);
                let inside = b.add(linear, tap.rest[entry]);
                let between = b.mul(deviation[i], deviation[k]);
                let between = b.mul(between, rest);
                let all = b.add(inside, between);
                let step = b.mul(weight, all);
                results.push(b.add(state[results.len()], step));
            }
        }
        for (i, result) in results.into_iter().enumerate() {
            b.result(format!("state_{i}"), result);
        }
        b.finish(module)
    });
    let b = lower.b();
    let zero = b.f32(0.0);
    let mut captures = place.footprint.captures.clone();
    captures.extend(place.pixel.iter().flatten().flatten());
    captures.extend(&place.more);
    let state = b.fold(
        &body,
        place.footprint.count,
        &vec![zero; 1 + numbers],
        &captures,
    );
    let tap = Tap::of(&state[1..], channels);
    Gathered {
        mean: tap.mean,
        gradient: tap.gradient,
        covariance: tap.rest,
    }
}

impl Gathered {
    /// The signals at a position in pictures of so many texels: responses by the gradients, and
    /// what is left of the covariance as parts that the channels share.
    pub(crate) fn signals(
        &self,
        lower: &mut Lower<'_>,
        position: &[Signal],
        texels: [f32; 2],
        footprint: &Footprint,
    ) -> Vec<Signal> {
        let [x, y] = position else {
            panic!("a position has two coordinates")
        };
        let (x, y) = (
            Signal {
                cell: None,
                ..x.clone()
            },
            Signal {
                cell: None,
                ..y.clone()
            },
        );
        let b = lower.b();
        let mut rest = Vec::new();
        let [xx, xy, yy] = footprint.covariance;
        for i in 0..self.mean.len() {
            for k in 0..=i {
                let ([p, q], [r, s]) = (self.gradient[i], self.gradient[k]);
                let along = b.dot(&[xx, xy], &[r, s]);
                let across = b.dot(&[xy, yy], &[r, s]);
                let linear = b.dot(&[p, q], &[along, across]);
                rest.push(b.sub(self.covariance[rest.len()], linear));
            }
        }
        let mut signals: Vec<Signal> = (self.mean.iter().zip(&self.gradient))
            .map(|(&mean, &[dx, dy])| {
                let (dx, dy) = (b.scale(dx, texels[0]), b.scale(dy, texels[1]));
                let (of_x, of_y) = (x.scale(b, dx), y.scale(b, dy));
                let mut signal = of_x.add(b, &of_y);
                signal.mean = mean;
                signal.range = [f32::NEG_INFINITY, f32::INFINITY];
                signal
            })
            .collect();
        lower.algebra.attach_joint(&mut signals, &rest);
        signals
    }
}
