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

use super::piecewise::{Residual, probability};
use super::{Algebra, Normal, Signal, spread};
use crate::ir::{Builder, Value};

/// The probability of an interval, and ∫ zφ and ∫ z²φ over it.
struct Interval {
    p: Value,
    first: Value,
    second: Value,
    ends: [Normal; 2],
}

impl Interval {
    fn new(b: &mut Builder, from: Normal, to: Normal) -> Self {
        let p = probability(b, &from, &to);
        let first = b.sub(from.density, to.density);
        // Standard scores of the ends are −z.
        let (left, right) = (b.mul(from.z, from.density), b.mul(to.z, to.density));
        let edge = b.sub(right, left);
        Self {
            p,
            first,
            second: b.add(p, edge),
            ends: [from, to],
        }
    }
}

impl Algebra {
    /// `branches[0]` where S is below the first threshold, `branches[k]` from the k-th on.
    ///
    /// # Panics
    /// If there is not one branch more than thresholds: a bug of the caller.
    pub fn selection(&mut self, s: &Signal, thresholds: &[f32], branches: &[Signal]) -> Signal {
        assert_eq!(
            branches.len(),
            thresholds.len() + 1,
            "branches of a selection"
        );
        let s = &s.flat(&mut self.b);
        let branches: Vec<Signal> = branches.iter().map(|w| w.flat(&mut self.b)).collect();
        let range = (branches.iter()).fold([f32::INFINITY, f32::NEG_INFINITY], |range, w| {
            [range[0].min(w.range[0]), range[1].max(w.range[1])]
        });
        if !self.mode.spreads() || s.is_certain(&self.b) {
            return self.picked(s, thresholds, &branches, range);
        }
        if s.binary.is_some() {
            return self.switched(s, thresholds, &branches, range);
        }
        self.bent = true;
        self.period = None;
        let s = &self.expose(s);
        let branches: Vec<Signal> = branches.iter().map(|w| self.expose(w)).collect();
        let b = &mut self.b;
        let variance = s.variance(b);
        let (_, inverse) = spread(b, variance);
        let intervals = intervals(b, s.mean, inverse, thresholds);
        // c_k, μ, and the slope by z, of which Σ c_k ∫ z²φ − P_k c_k is the part beyond the branches'.
        let scores: Vec<Value> = (branches.iter())
            .map(|w| {
                let covariance = s.covariance(b, w);
                b.mul(covariance.total, inverse)
            })
            .collect();
        let zero = b.f32(0.0);
        let (mut mean, mut slope, mut own) = (zero, zero, zero);
        for ((interval, w), &c) in intervals.iter().zip(&branches).zip(&scores) {
            let part = b.dot(&[w.mean, c], &[interval.p, interval.first]);
            mean = b.add(mean, part);
            let part = b.dot(&[w.mean, c], &[interval.first, interval.second]);
            slope = b.add(slope, part);
            let edge = b.sub(interval.second, interval.p);
            let part = b.dot(&[w.mean, c], &[interval.first, edge]);
            own = b.add(own, part);
        }
        let mut distortion = zero;
        for ((interval, w), &c) in intervals.iter().zip(&branches).zip(&scores) {
            let residual = Residual {
                constant: b.sub(w.mean, mean),
                slope: b.sub(c, slope),
            };
            let [from, to] = &interval.ends;
            let part = residual.between(b, from, to);
            distortion = b.add(distortion, part);
        }
        // Σ P_k W_k and what S adds to it.
        let of_s = b.mul(own, inverse);
        let mut out = s.scale(b, of_s);
        let mut average = Signal::constant(b, 0.0);
        for (interval, w) in intervals.iter().zip(&branches) {
            let part = w.scale(b, interval.p);
            average = average.add(b, &part);
        }
        out = out.add(b, &average);
        out.mean = mean;
        out.range = range;
        out.binary = None;
        let inside = self.apart(s, &intervals, &branches, &scores, inverse);
        let distortion = self.b.add(distortion, inside);
        if let [low, high] = &branches[..]
            && low.is_certain(&self.b)
            && high.is_certain(&self.b)
        {
            out.binary = Some([low.mean, high.mean]);
        }
        self.attach_fresh(&mut out, distortion);
        out
    }

    /// Σ P_k Var(W⊥_k − Σ_j P_j W⊥_j); of two branches P₀P₁ Var(W⊥₁ − W⊥₀).
    fn apart(
        &mut self,
        s: &Signal,
        intervals: &[Interval],
        branches: &[Signal],
        scores: &[Value],
        inverse: Value,
    ) -> Value {
        let b = &mut self.b;
        let beyond = |b: &mut Builder, w: &Signal, c: Value| {
            let by = b.mul(c, inverse);
            let along = s.scale(b, by);
            w.sub(b, &along).variance(b)
        };
        if let ([first, second], [low, high], [c, d]) = (intervals, branches, scores) {
            let apart = high.sub(b, low);
            let score = b.sub(*d, *c);
            let variance = beyond(b, &apart, score);
            let both = b.mul(first.p, second.p);
            return b.mul(both, variance);
        }
        let (mut average, mut common) = (Signal::constant(b, 0.0), b.f32(0.0));
        for ((interval, w), &c) in intervals.iter().zip(branches).zip(scores) {
            let part = w.scale(b, interval.p);
            average = average.add(b, &part);
            let part = b.mul(interval.p, c);
            common = b.add(common, part);
        }
        let mut sum = b.f32(0.0);
        for ((interval, w), &c) in intervals.iter().zip(branches).zip(scores) {
            let apart = w.sub(b, &average);
            let score = b.sub(c, common);
            let variance = beyond(b, &apart, score);
            let part = b.mul(interval.p, variance);
            sum = b.add(sum, part);
        }
        sum
    }

    /// Of a condition without spread.
    fn picked(
        &mut self,
        s: &Signal,
        thresholds: &[f32],
        branches: &[Signal],
        range: [f32; 2],
    ) -> Signal {
        let b = &mut self.b;
        let mut out = branches[0].clone();
        for (&threshold, w) in thresholds.iter().zip(&branches[1..]) {
            match b.as_constant(s.mean) {
                Some(at) if at >= threshold => out = w.clone(),
                Some(_) => {}
                None => {
                    let threshold = b.f32(threshold);
                    let on = b.le(threshold, s.mean);
                    out = out.select(b, on, w);
                }
            }
        }
        Signal { range, ..out }
    }

    /// Of a condition that takes two values: every indicator is linear in it.
    fn switched(
        &mut self,
        s: &Signal,
        thresholds: &[f32],
        branches: &[Signal],
        range: [f32; 2],
    ) -> Signal {
        let s = self.expose(s);
        let mut out = self.expose(&branches[0]);
        let mut before = out.clone();
        for (&threshold, w) in thresholds.iter().zip(&branches[1..]) {
            let at = self.b.f32(threshold);
            let step = super::Piecewise::step(&mut self.b, at);
            let mask = self.transfer(&s, &step);
            let w = self.expose(w);
            let rise = w.sub(&mut self.b, &before);
            let part = self.product(&mask, &rise);
            out = out.add(&mut self.b, &part);
            before = w;
        }
        Signal { range, ..out }
    }
}

/// The intervals between −∞, the thresholds, and ∞.
fn intervals(b: &mut Builder, mean: Value, inverse: Value, thresholds: &[f32]) -> Vec<Interval> {
    let mut edges = vec![b.f32(12.0)];
    for &threshold in thresholds {
        let at = b.f32(threshold);
        let distance = b.sub(mean, at);
        edges.push(b.mul(distance, inverse));
    }
    edges.push(b.f32(-12.0));
    let normals: Vec<Normal> = edges.into_iter().map(|z| Normal::of(b, z)).collect();
    normals
        .windows(2)
        .map(|pair| Interval::new(b, pair[0], pair[1]))
        .collect()
}
