//! The moment algebra: what a signal is, and how operations act on it.
//!
//! Over the footprint of a pixel the position is uv₀ + A·δ with δ ~ N(0, I₂). A [`Signal`] is
//!
//! ```text
//! X = mean + g·δ + ½(δᵀHδ − tr H) + Σ c_k ε_k + √private · ε
//! ```
//!
//! with unit, uncorrelated ε. Covariance is the dot product of coefficients (½ H:H for the second
//! order), so it is symmetric and positive semi-definite by construction. The rules are those of
//! Bruneton & Neyret 2012 §2.2 (linear), Isserlis (products), Stein and Bussgang (transfers) and
//! Clark 1961 (maxima), each in a form that survives f32.
//!
//! # What every rule keeps
//! - A footprint of 0 gives the value of the point function; a rule never divides by a spread.
//! - Second-order coefficients are carried only by [`Mode::Quad`]; elsewhere they are the constant
//!   0 and vanish when the function is built.
//! - What no result reads does not exist: a moment that is not demanded is dead code.

mod branch;
mod cubature;
mod curve;
mod extremum;
mod joint;
mod map;
mod normal;
mod piecewise;
mod position;
mod product;
mod selection;
mod signal;
mod slope;
mod smooth;
mod tabulated;
mod tapped;
#[cfg(test)]
mod tests;
mod transfer;
mod wave;

use crate::ir::{Builder, Float};

pub(crate) use branch::Branch;
pub use curve::Curve;
pub use map::Domain;
pub(crate) use map::{Grid, Map, SIDE, tables};
pub use normal::Normal;
pub use piecewise::{Bump, Knot, Piecewise, Shape};
pub(crate) use signal::PARTS;
pub use signal::{Covariance, Signal, Slope, Symbol};
pub use smooth::{Exponential, Polynomial, RealPower, Reciprocal, Sine};
pub use tabulated::Tabulated;
pub(crate) use tabulated::{Pyramids, Sampled, Samples, pyramids, sample_points};
pub(crate) use tapped::{SIDES, Tapped};
pub use transfer::{Gaussian, Moments, Rebuild, SharedTransfer, Transfer};
pub(crate) use wave::Wholes;
pub use wave::{Corner, LinearWave, SquareWave};

/// Which moments signals carry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Mode {
    /// None: the unfiltered value.
    Point,
    /// The sources' filtered means; what follows takes them for values.
    Naive,
    /// One variance per source and footprint (Heitz et al. 2013; Deliot & Heitz 2019).
    Ensemble,
    /// Mean, gradient and remainder.
    Local,
    /// The same with the Hessian and the third cumulant.
    Quad,
}

impl Mode {
    /// Whether sources are filtered.
    pub const fn filters(self) -> bool {
        !matches!(self, Self::Point)
    }

    /// Whether signals carry a spread.
    pub const fn spreads(self) -> bool {
        !matches!(self, Self::Point | Self::Naive)
    }
}

/// The algebra at work in one function: where operations put their instructions and fresh symbols.
#[derive(Debug)]
pub struct Algebra<'b> {
    /// The function under construction.
    pub b: &'b Builder,
    /// Which moments are carried.
    pub mode: Mode,
    /// Whether the signal under construction is read by several consumers, so that its fresh parts
    /// are symbols of their own.
    pub shares: bool,
    /// Whether an operation since this was last cleared was not linear in a signal with a spread.
    pub bent: bool,
    /// Whether it is asked on what share of a footprint slopes are.
    pub(crate) shares_slopes: bool,
    /// Whether a function has jumped whose derivative was asked for, since it was last cleared.
    pub(crate) jumped: bool,
    /// The most knots of a transfer since [`Self::bent`] was last cleared.
    pub(crate) knots: u32,
    /// The period of the last transfer that bent, where it has one.
    pub(crate) period: Option<f32>,
    /// Whether signals carry how they change with u and v.
    pub(crate) derives: bool,
    /// What stands for whole parts, where a node that takes them is looked at alone.
    pub(crate) wholes: Wholes<'b>,
    symbols: u32,
}

impl<'b> Algebra<'b> {
    /// An algebra that builds into `b`.
    pub fn new(b: &'b Builder, mode: Mode) -> Self {
        Self {
            b,
            mode,
            shares: false,
            bent: false,
            shares_slopes: false,
            jumped: false,
            knots: 0,
            period: None,
            derives: false,
            wholes: Wholes::Own,
            symbols: 0,
        }
    }

    /// The symbol that [`Self::fresh_symbol`] gives next.
    pub fn next_symbol(&self) -> Symbol {
        Symbol(self.symbols)
    }

    /// A symbol that no signal has yet.
    pub fn fresh_symbol(&mut self) -> Symbol {
        self.symbols += 1;
        Symbol(self.symbols - 1)
    }

    /// Adds a fresh ε of this variance (at least 0): a symbol where the signal is shared, else a
    /// part of its private variance.
    pub fn attach_fresh(&mut self, signal: &mut Signal<'b>, variance: Float<'b>) {
        if variance.is_zero() {
            return;
        }
        if self.shares {
            let symbol = self.fresh_symbol();
            signal.push_shared(symbol, variance.sqrt());
        } else {
            signal.private += variance;
        }
    }

    /// The same signal, ready to be read more than once by what is built of it: its private variance
    /// becomes a symbol, and so does its second Hermite polynomial.
    pub fn expose(&mut self, x: &Signal<'b>) -> Signal<'b> {
        let mut out = x.clone();
        if !self.mode.spreads() || x.is_certain() {
            return out;
        }
        self.publish(&mut out);
        if out.hermite.is_none() {
            out.hermite = Some(self.fresh_symbol());
        }
        out
    }

    /// Makes a symbol of the private variance, if there is any.
    pub(crate) fn publish(&mut self, signal: &mut Signal<'b>) -> Option<Symbol> {
        if signal.private.is_zero() {
            return None;
        }
        let symbol = self.fresh_symbol();
        signal.push_shared(symbol, signal.private.sqrt());
        signal.private = self.b.float(0.0);
        Some(symbol)
    }

    /// Says the period of the function that a node composed of several operations, where it has one:
    /// that of its last transfer is in other units.
    pub fn repeats(&mut self, period: Option<f32>) {
        self.period = period;
    }
}

/// σ = √(v + 1e-12) and 1/σ: no rule divides by 0, and a σ of 1e-6 blurs nothing that can be seen.
pub(crate) fn spread(variance: Float<'_>) -> (Float<'_>, Float<'_>) {
    let sd = (variance + 1e-12).sqrt();
    (sd, 1.0 / sd)
}
