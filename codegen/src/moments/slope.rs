//! Derivative signals: how a signal changes with u and with v, as two signals of their own.
//!
//! In an algebra that [`derives`](Algebra::derives), a signal X carries X_u and X_v beside its value,
//! and every operation differentiates them by its own rule: the chain rule is a sum of products of
//! signals,
//!
//! ```text
//! (T(X))_u = T′(X) X_u,   (XY)_u = Y X_u + X Y_u,   (X + M (Y − X))_u = X_u + M (Y − X)_u + (Y − X) M_u,
//! ```
//!
//! so that slopes have means, responses to the place in the footprint and covariances with one another
//! as any signals (Bruneton & Neyret 2012 §3; Isserlis for the products). Elsewhere slopes are absent,
//! and nothing is computed for them.
//!
//! A sum of products Σ_k Y_k A_k of numbers Y_k and pairs A_k = (A_ku, A_kv) has the second-order
//! covariance Σ_kl [cov(A_ki, A_lj) cov(Y_k, Y_l) + cov(A_ki, Y_l) cov(Y_k, A_lj)], which both slopes
//! carry as symbols that they share.

use super::signal::{of_function, of_terms, symbols_of};
use super::{Algebra, Gaussian, Mode, Signal, Slope, Transfer, spread};
use crate::ir::{Float, Sym2, Vec2};
use std::rc::Rc;

/// A number times a pair of slopes.
pub(super) type Term<'a, 'b> = (&'a Signal<'b>, &'a [Signal<'b>; 2]);

/// A signal's slopes carry at most this many symbols: the covariance of the oldest is put into two.
const MOST: usize = 8;

/// The least variance that another is divided by.
const NARROWEST: f32 = 1e-20;

/// The covariance matrix of two pairs' products, entry by entry.
fn matrix<'b>(mut entry: impl FnMut(usize, usize) -> Float<'b>) -> Sym2<'b> {
    Sym2([entry(0, 0), entry(0, 1), entry(1, 1)])
}

impl<'b> Algebra<'b> {
    /// Σ_k Y_k A_k: means with the covariances, coefficients by both factors, and what is of the second
    /// order in fresh symbols that both slopes carry.
    pub(super) fn bilinear(&mut self, terms: &[Term<'_, 'b>]) -> Slope<'b> {
        let b = self.b;
        let mut out = [0, 1].map(|_| Signal::constant(b, 0.0));
        let mut uncertain: Vec<Term<'_, 'b>> = Vec::new();
        for &(factor, pair) in terms {
            if factor.is_certain() {
                let by = factor.flat_mean();
                for (sum, slope) in out.iter_mut().zip(pair) {
                    *sum = &*sum + slope * by;
                }
                continue;
            }
            if pair.iter().all(|slope| slope.is_certain()) {
                let factor = Signal {
                    share: (self.shares_slopes).then(|| factor.evenness() * 3.0),
                    ..plain(&factor.flat())
                };
                for (sum, slope) in out.iter_mut().zip(pair) {
                    *sum = &*sum + &factor * slope.mean;
                }
                continue;
            }
            uncertain.push((factor, pair));
        }
        if uncertain.is_empty() {
            return Rc::new(out);
        }
        let shares = self.shares(&out, &uncertain);
        let mut fresh = [b.float(0.0); 3];
        for &(factor, pair) in &uncertain {
            let mean = factor.flat_mean();
            for (sum, slope) in out.iter_mut().zip(pair) {
                *sum = &*sum + first_order(factor, mean, slope);
            }
            // What of the factor is no response and no symbol both slopes have in proportion.
            let private = factor.private + factor.h.half_contraction(factor.h);
            let own = Vec2([pair[0].mean, pair[1].mean]).outer() * private;
            fresh = std::array::from_fn(|i| fresh[i] + own[i]);
        }
        for (k, &(y, p)) in uncertain.iter().enumerate() {
            for (l, &(z, q)) in uncertain.iter().enumerate() {
                let factors = if k == l {
                    y.variance()
                } else {
                    y.covariance(z).total
                };
                let part = matrix(|i, j| {
                    let slopes = if k == l && i == j {
                        p[i].variance()
                    } else {
                        p[i].covariance(&q[j]).total
                    };
                    let crossed = p[i].covariance(z).total * y.covariance(&q[j]).total;
                    slopes * factors + crossed
                });
                fresh = std::array::from_fn(|i| fresh[i] + part[i]);
            }
        }
        self.attach_joint(&mut out, &fresh);
        for (slope, share) in out.iter_mut().zip(shares) {
            slope.share = share;
        }
        Rc::new(out)
    }

    /// On what shares of the footprint both components of a sum of terms are slopes.
    fn shares(&self, rest: &[Signal<'b>; 2], uncertain: &[Term<'_, 'b>]) -> [Option<Float<'b>>; 2] {
        if !self.shares_slopes {
            return [None, None];
        }
        [0, 1].map(|i| {
            let one = self.b.float(1.0);
            let rest = [rest[i].second_moment(), rest[i].share.unwrap_or(one)];
            let terms = uncertain.iter().map(|&(factor, pair)| {
                [
                    factor.second_moment() * pair[i].second_moment(),
                    pair[i].share_times(factor.evenness()),
                ]
            });
            let all: Vec<[Float<'b>; 2]> = std::iter::once(rest).chain(terms).collect();
            of_terms(&all)
        })
    }

    /// T′(X): of the function's own derivative, where it has one that is averaged in closed form. Else
    /// by T's Hermite coefficients c_n over the Gaussian, of which v E[T′²] is Σ n c_n²: those from the
    /// fourth on are taken for the fourth. That is exact for polynomials of degree 4, and a lower bound
    /// for others; of a jump, whose slope has no variance, it is what is used.
    pub(super) fn derivative(&mut self, x: &Signal<'b>, t: &dyn Transfer<'b>) -> Signal<'b> {
        if let Some(derivative) = t.derivative() {
            let bent = (self.bent, self.knots, self.period);
            let mut out = self.transfer(&plain(x), &*derivative);
            (self.bent, self.knots, self.period) = bent;
            if let Some(values) = derivative.values() {
                out.binary = Some(values.map(|value| self.b.float(value)));
            } else if self.shares_slopes {
                let (sd, inverse_sd) = spread(x.variance());
                // Tables know means, not values.
                let part = |mean, share: f32| Gaussian {
                    mean,
                    variance: (sd * share).square(),
                    sd: sd * share,
                    inverse_sd: inverse_sd * (1.0 / share),
                    range: x.range,
                };
                out.share = Some(of_function(x.flat_mean(), sd, |at, share| {
                    let part = part(at, share);
                    let m = derivative.moments(&part);
                    m.mean.square() + m.slope.square() * part.variance + m.distortion
                }));
            }
            return out;
        }
        self.jumped |= t.is_steep();
        let variance = x.variance();
        let (sd, inverse_sd) = spread(variance);
        let m = t.moments(&Gaussian {
            mean: x.mean,
            variance,
            sd,
            inverse_sd,
            range: x.range,
        });
        let mut out = plain(x) * m.curvature;
        out.mean = m.slope;
        // c₂² and c₃², and what is beyond them.
        let second = (m.curvature * variance).square() * 0.5;
        let third = (m.third * sd).square() * variance.square() * (1.0 / 6.0);
        let beyond = (m.distortion - second - third).max(0.0);
        let left = (third.min(m.distortion) * 3.0 + beyond * 4.0) / (variance + NARROWEST);
        self.attach_fresh(&mut out, left);
        out
    }

    /// The slopes of a function of signals that is α·x and a distortion: those of the linear part, and
    /// of the distortion, whose Hermite polynomials are of the second degree at least, what those of the
    /// second have: 2 D S/v, evenly over the signals. A lower bound.
    pub(super) fn slopes_of_linear(
        &mut self,
        parts: &[(&Signal<'b>, Float<'b>)],
        distortion: Float<'b>,
    ) -> Option<Slope<'b>> {
        let b = self.b;
        let mut out = [0, 1].map(|_| Signal::constant(b, 0.0));
        let mut fresh = [b.float(0.0); 3];
        let share = 2.0 / parts.len().max(1) as f32;
        for &(x, by) in parts {
            let slope = x.slopes()?;
            let variance = x.variance() + NARROWEST;
            for (sum, slope) in out.iter_mut().zip(&*slope) {
                *sum = &*sum + slope * by;
            }
            let scale = distortion * share / variance;
            let part = matrix(|i, j| slope[i].covariance(&slope[j]).total * scale);
            fresh = std::array::from_fn(|i| fresh[i] + part[i]);
        }
        self.attach_joint(&mut out, &fresh);
        Some(Rc::new(out))
    }

    /// Slopes of these means and responses whose remainders have this covariance.
    pub fn slope_of(&mut self, means: [Signal<'b>; 2], rest: Sym2<'b>) -> Slope<'b> {
        let mut out = means;
        self.attach_joint(&mut out, &*rest);
        Rc::new(out)
    }

    /// Slopes by the coordinates of a field, as those by u and v: Σ_k G_k p_k with the slopes p_k of the
    /// coordinates, where these are known.
    pub fn chained(&mut self, gradient: &[Signal<'b>], place: &[Signal<'b>]) -> Option<Slope<'b>> {
        let slopes: Option<Vec<Slope<'b>>> = place.iter().map(Signal::slopes).collect();
        let slopes = slopes?;
        let terms: Vec<Term<'_, 'b>> = (gradient.iter().zip(&slopes))
            .map(|(along, slope)| (along, &**slope))
            .collect();
        Some(self.bilinear(&terms))
    }

    /// The same slopes with no more symbols than a signal carries: the covariance of the oldest goes into
    /// two.
    pub(crate) fn condensed(&mut self, slope: Slope<'b>) -> Slope<'b> {
        let [u, v] = &*slope;
        let symbols = symbols_of(&[u, v]);
        if symbols.len() <= MOST {
            return slope;
        }
        let zero = self.b.float(0.0);
        let mut kept = [u.clone(), v.clone()];
        let mut folded = [zero; 3];
        for &symbol in &symbols[..symbols.len() - MOST + 2] {
            let pair = [0, 1].map(|i| kept[i].coefficient_or_zero(symbol));
            let outer = Vec2(pair).outer();
            folded = std::array::from_fn(|i| folded[i] + outer[i]);
            for slope in &mut kept {
                slope.shared.retain(|&mut (s, _)| s != symbol);
            }
        }
        self.attach_joint(&mut kept, &folded);
        Rc::new(kept)
    }

    /// Whether slopes are carried.
    pub fn derives(&self) -> bool {
        self.derives && self.mode >= Mode::Local
    }
}

/// The signal without its slopes.
fn plain<'b>(x: &Signal<'b>) -> Signal<'b> {
    x.clone().with_slope(None)
}

/// Y A to the first order, with the covariance in the mean; without private parts.
fn first_order<'b>(factor: &Signal<'b>, mean: Float<'b>, slope: &Signal<'b>) -> Signal<'b> {
    let mut out = Signal::certain(mean * slope.mean + factor.covariance(slope).total);
    out.g = slope.g * mean + factor.g * slope.mean;
    for symbol in symbols_of(&[factor, slope]) {
        let [c, d] = [factor, slope].map(|signal| signal.coefficient_or_zero(symbol));
        out.push_shared(symbol, d * mean + c * slope.mean);
    }
    // A slope's own second order passes as a spread.
    out.private = (slope.private + slope.h.half_contraction(slope.h)) * mean.square();
    out
}
