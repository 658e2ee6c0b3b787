//! One of several signals, by where another signal lies: ifgreater, switch, and every mask that is
//! a step.
//!
//! out = Σ_k 1_k(S) W_k with 1_k the indicator of the k-th interval between the thresholds. With
//! c_k = cov(S, W_k)/σ_S and W_k = m_k + c_k z + W⊥_k, where z is the standard score of S and W⊥_k is
//! independent of it (RULES: a mask M(S) correlated with what it masks):
//!
//! ```text
//! out = T(z) + Σ_k 1_k(S) W⊥_k,   T(z) = m_k + c_k z on the k-th interval.
//! ```
//!
//! T is piecewise linear: its mean μ, its slope and its distortion Σ ∫_k (T − μ − αz)²φ have closed
//! forms. The rest has mean 0, coefficients Σ P_k w⊥_k, and beyond them the variance
//! Σ P_k Var(W⊥_k − Σ_j P_j W⊥_j), since the indicators exclude one another. Exact in mean, variance
//! and covariances for jointly Gaussian signals.

use super::normal::probability;
use super::piecewise::Residual;
use super::{Algebra, Normal, Piecewise, Signal, Slope, spread};
use crate::ir::{Float, dot};
use std::rc::Rc;

/// The probability of an interval, and ∫ zφ and ∫ z²φ over it.
struct Interval<'b> {
    p: Float<'b>,
    first: Float<'b>,
    second: Float<'b>,
    ends: [Normal<'b>; 2],
}

impl<'b> Interval<'b> {
    fn new(from: Normal<'b>, to: Normal<'b>) -> Self {
        let p = probability(&from, &to);
        Self {
            p,
            first: from.density - to.density,
            // Standard scores of the ends are −z.
            second: p + (to.z * to.density - from.z * from.density),
            ends: [from, to],
        }
    }
}

/// A branch W_k: where it is taken, what it is, and c_k.
struct Branch<'a, 'b> {
    interval: Interval<'b>,
    signal: &'a Signal<'b>,
    score: Float<'b>,
}

impl<'b> Algebra<'b> {
    /// `branches[0]` where S is below the first threshold, `branches[k]` from the k-th on.
    ///
    /// # Panics
    /// If there is not one branch more than thresholds: a bug of the caller.
    pub fn selection(
        &mut self,
        s: &Signal<'b>,
        thresholds: &[f32],
        branches: &[Signal<'b>],
    ) -> Signal<'b> {
        assert_eq!(
            branches.len(),
            thresholds.len() + 1,
            "branches of a selection"
        );
        let s = &s.flat();
        let branches: Vec<Signal<'b>> = branches.iter().map(Signal::flat).collect();
        let range = (branches.iter()).fold([f32::INFINITY, f32::NEG_INFINITY], |range, w| {
            [range[0].min(w.range[0]), range[1].max(w.range[1])]
        });
        let out = if !self.mode.spreads() || s.is_certain() {
            picked(s, thresholds, &branches)
        } else if s.binary.is_some() {
            self.switched(s, thresholds, &branches)
        } else {
            self.selected(s, thresholds, &branches)
        };
        Signal { range, ..out }
    }

    /// Of a condition with a spread.
    fn selected(
        &mut self,
        s: &Signal<'b>,
        thresholds: &[f32],
        branches: &[Signal<'b>],
    ) -> Signal<'b> {
        self.bent = true;
        self.period = None;
        let s = &self.expose(s);
        let signals: Vec<Signal<'b>> = branches.iter().map(|w| self.expose(w)).collect();
        let (b, (_, inverse)) = (self.b, spread(s.variance()));
        let intervals = intervals(s.mean, inverse, thresholds);
        let branches: Vec<Branch<'_, 'b>> = (intervals.into_iter().zip(&signals))
            .map(|(interval, signal)| Branch {
                interval,
                signal,
                score: s.covariance(signal).total * inverse,
            })
            .collect();
        // Σ_k m_k u_k + c_k v_k.
        let sum = |weights: fn(&Interval<'b>) -> [Float<'b>; 2]| {
            let line = |k: &Branch<'_, 'b>| dot([k.signal.mean, k.score], weights(&k.interval));
            b.sum(branches.iter().map(line))
        };

        // μ, and the slope by z, of which Σ c_k ∫ z²φ − P_k c_k is the part beyond the branches'.
        let mean = sum(|k| [k.p, k.first]);
        let slope = sum(|k| [k.first, k.second]);
        let own = sum(|k| [k.first, k.second - k.p]);
        let distortions = branches.iter().map(|k| {
            let residual = Residual {
                constant: k.signal.mean - mean,
                slope: k.score - slope,
            };
            let [from, to] = &k.interval.ends;
            residual.between(from, to)
        });
        let distortion = b.sum(distortions) + apart(s, &branches, inverse);

        // Σ P_k W_k and what S adds to it.
        let mut out = s * (own * inverse) + average(&branches);
        out.mean = mean;
        out.binary = match &signals[..] {
            [low, high] if low.is_certain() && high.is_certain() => Some([low.mean, high.mean]),
            _ => None,
        };
        self.attach_fresh(&mut out, distortion);
        out.slope = self.chosen(s, thresholds, &signals);
        out
    }

    /// The slopes of Σ_k 1_k(S) W_k = W₀ + Σ_k (S ≥ t_k)(W_k − W_{k−1}): those of the branches where they
    /// are taken, and a lower bound of those of the jumps.
    fn chosen(
        &mut self,
        s: &Signal<'b>,
        thresholds: &[f32],
        branches: &[Signal<'b>],
    ) -> Option<Slope<'b>> {
        if !self.derives() {
            return None;
        }
        let of_s = s.slopes()?;
        let slopes: Option<Vec<Slope<'b>>> = branches.iter().map(Signal::slopes).collect();
        let slopes = slopes?;
        let s = s.clone().with_slope(None);
        let mut out: Slope<'b> = slopes[0].clone();
        for (k, &threshold) in thresholds.iter().enumerate() {
            let step = Piecewise::step(self.b.float(threshold));
            let taken = self.transfer(&s, &step);
            let jump = branches[k + 1].mean - branches[k].mean;
            let edge = self.derivative(&s, &step) * jump;
            let across = [0, 1].map(|i| &slopes[k + 1][i] - &slopes[k][i]);
            let part = self.bilinear(&[(&taken, &across), (&edge, &of_s)]);
            out = Rc::new([0, 1].map(|i| &out[i] + &part[i]));
        }
        Some(out)
    }

    /// Of a condition that takes two values: every indicator is linear in it.
    fn switched(
        &mut self,
        s: &Signal<'b>,
        thresholds: &[f32],
        branches: &[Signal<'b>],
    ) -> Signal<'b> {
        let s = self.expose(s);
        let mut out = self.expose(&branches[0]);
        let mut before = out.clone();
        for (&threshold, w) in thresholds.iter().zip(&branches[1..]) {
            let mask = self.transfer(&s, &Piecewise::step(self.b.float(threshold)));
            let w = self.expose(w);
            out = out + self.product(&mask, &(&w - &before));
            before = w;
        }
        out
    }
}

/// Σ P_k W_k.
fn average<'b>(branches: &[Branch<'_, 'b>]) -> Signal<'b> {
    let nothing = Signal::constant(branches[0].score.builder(), 0.0);
    (branches.iter()).fold(nothing, |sum, k| sum + k.signal * k.interval.p)
}

/// Σ P_k Var(W⊥_k − Σ_j P_j W⊥_j); of two branches P₀P₁ Var(W⊥₁ − W⊥₀).
fn apart<'b>(s: &Signal<'b>, branches: &[Branch<'_, 'b>], inverse: Float<'b>) -> Float<'b> {
    let beyond = |w: Signal<'b>, c: Float<'b>| (w - s * (c * inverse)).variance();
    if let [low, high] = branches {
        let variance = beyond(high.signal - low.signal, high.score - low.score);
        return low.interval.p * high.interval.p * variance;
    }
    let average = average(branches);
    let b = inverse.builder();
    let common = b.sum(branches.iter().map(|k| k.interval.p * k.score));
    b.sum((branches.iter()).map(|k| k.interval.p * beyond(k.signal - &average, k.score - common)))
}

/// Of a condition without spread.
fn picked<'b>(s: &Signal<'b>, thresholds: &[f32], branches: &[Signal<'b>]) -> Signal<'b> {
    let mut out = branches[0].clone();
    for (&threshold, w) in thresholds.iter().zip(&branches[1..]) {
        match s.mean.as_constant() {
            Some(at) if at >= threshold => out = w.clone(),
            Some(_) => {}
            None => out = out.select(s.mean.ge(threshold), w),
        }
    }
    out
}

/// The intervals between −∞, the thresholds, and ∞.
fn intervals<'b>(mean: Float<'b>, inverse: Float<'b>, thresholds: &[f32]) -> Vec<Interval<'b>> {
    let scores = thresholds.iter().map(|&t| (mean - t) * inverse);
    let [first, last] = [12.0, -12.0].map(|z| mean.literal(z));
    let edges = [first].into_iter().chain(scores).chain([last]);
    let normals: Vec<Normal<'b>> = edges.map(Normal::of).collect();
    let pairs = normals.windows(2);
    pairs.map(|pair| Interval::new(pair[0], pair[1])).collect()
}
