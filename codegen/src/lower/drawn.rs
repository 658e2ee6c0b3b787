//! A signal drawn to the mean of the texture, where a footprint holds so much of it that this mean
//! says more than the filter does.
//!
//! Far away every pixel of a texture that is alike everywhere is its mean F, and a closed form may
//! be biased there. A filtered value C is drawn to F by the share l that brings it nearest to the
//! true mean T of a pixel: l = Σ (F − C)(T − C) / Σ (F − C)² over places, as [`super::audit`]
//! measures it for each band of footprints. Where inputs of the graph shape the texture, F moves
//! with them, and F/C at their defaults times C takes its place, within the range of the signal; where
//! that is not right at the ends of an input's slider, the share falls to 0 as the input leaves its
//! default. For points inside the footprint 1 − l is Wiener's share V/(V + N/7), with V the variance of T over
//! places and N that of points within a footprint.

use super::bands::Bands;
use super::{Lower, Method};
use crate::ir::Float;
use crate::moments::Signal;

/// Where the components of a signal are drawn.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Far {
    /// To these means.
    Means(Vec<f32>),
    /// To so many times themselves.
    Times(Vec<f32>),
}

impl Far {
    /// To where a component of this value is drawn.
    pub(super) fn of<T: Copy + std::ops::Mul<f32, Output = T>>(
        &self,
        component: usize,
        value: T,
        number: impl Fn(f32) -> T,
    ) -> T {
        match self {
            Self::Means(means) => number(means[component]),
            Self::Times(factors) => value * factors[component],
        }
    }
}

/// A number among the inputs of the graph near whose default alone signals are drawn.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Near {
    /// Which.
    pub(super) scalar: usize,
    /// The default.
    pub(super) default: f32,
    /// How far from it nothing is drawn any more.
    pub(super) reach: f32,
}

/// The mean of a texture, and how far signals are drawn there.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Drawn {
    /// Where to.
    pub(super) far: Far,
    /// The share of the way, in each band.
    pub(super) lost: [f32; Bands::COUNT],
    /// The bands.
    pub(super) bands: Bands,
    /// Near what alone.
    pub(super) near: Vec<Near>,
}

impl Drawn {
    /// The bits of the bands in which signals are drawn.
    pub(super) fn within(&self) -> u32 {
        let bits = self.lost.iter().enumerate();
        bits.fold(0, |bits, (band, &lost)| {
            bits | u32::from(lost > 0.0) << band
        })
    }

    /// The share at a band, between the measured ones linearly. Of what has a mean, nothing but the
    /// mean is left two bands after the last.
    pub(super) fn lost<'b>(&self, band: Float<'b>) -> Float<'b> {
        let mut lost = band.builder().float(self.lost[0]);
        for (i, pair) in self.lost.windows(2).enumerate() {
            if pair[0] != pair[1] {
                lost += (pair[1] - pair[0]) * (band - i as f32).clamp(0.0, 1.0);
            }
        }
        let last = Bands::COUNT - 1;
        if self.lost[last] > 0.5 {
            let beyond = (0.5 * (band - last as f32)).clamp(0.0, 1.0);
            lost += (1.0 - lost) * beyond;
        }
        lost
    }

    /// Holds near these alone.
    pub(super) fn stay_near<'n>(&mut self, near: impl Iterator<Item = &'n Near>) {
        for near in near {
            if !self.near.iter().any(|known| known.scalar == near.scalar) {
                self.near.push(near.clone());
            }
        }
    }

    /// A component of this mean, drawn by a share.
    pub(super) fn draw<'b>(&self, component: usize, mean: Float<'b>, lost: Float<'b>) -> Float<'b> {
        let far = self.far.of(component, mean, |x| mean.literal(x));
        mean + lost * (far - mean)
    }
}

impl<'b> Lower<'_, 'b> {
    /// The share of the way at a band, and near the defaults of what it holds for alone.
    pub(super) fn lost(&self, drawn: &Drawn, band: Float<'b>) -> Float<'b> {
        let mut lost = drawn.lost(band);
        for near in &drawn.near {
            let away = self.arguments.parameters[near.scalar].float() + -near.default;
            lost *= (1.0 - away.abs() * (1.0 / near.reach)).max(0.0);
        }
        lost
    }

    /// The node's signals drawn to their means, where `auto` is to do so.
    pub(super) fn drawn(&self, index: usize, signals: &[Signal<'b>]) -> Option<Vec<Signal<'b>>> {
        let compiler = self.compiler;
        let applies = compiler.options.method == Method::Auto
            && self.algebra.mode.spreads()
            && !self.measures
            && !self.in_rule;
        let drawn = compiler.facts.drawn.get(&index).filter(|_| applies)?;
        let lost = self.lost(drawn, drawn.bands.of(&self.arguments));
        let each = signals.iter().enumerate().map(|(i, signal)| {
            let flat = signal.flat();
            let mean = drawn.draw(i, flat.mean, lost);
            Signal {
                mean: bounded(mean, flat.range),
                binary: None,
                hermite: None,
                ..flat
            }
        });
        Some(each.collect())
    }
}

/// A mean within the range of what it is the mean of, where that is known.
pub(super) fn bounded<'b>(mean: Float<'b>, [low, high]: [f32; 2]) -> Float<'b> {
    if low.is_finite() && high.is_finite() {
        mean.clamp(low, high)
    } else {
        mean
    }
}
