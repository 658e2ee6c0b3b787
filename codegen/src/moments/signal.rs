//! A scalar signal with its first two moments in factored form, and the linear rules.

mod share;
mod slope;

use super::position;
use crate::ir::{Bool, Builder, Float, Int, Operand, Sym2, Vec2};
use smallvec::SmallVec;
use std::ops::{Add, Mul, Neg, Sub};

pub(super) use share::{of_function, of_terms};
pub use slope::Slope;
use slope::combined;

/// A unit-variance symbol ε that several signals share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Symbol(pub u32);

/// A scalar signal: see the module documentation. Coefficients that are absent are the constant 0.
#[derive(Debug)]
pub struct Signal<'b> {
    /// The mean; where `cell` is present, the mean is `cell + mean` and `mean` lies in [0, 1).
    pub mean: Float<'b>,
    /// The integer part of the mean of a position, which keeps its detail far from the origin.
    pub cell: Option<Int<'b>>,
    /// The linear response to δ.
    pub g: Vec2<'b>,
    /// The quadratic response to δ.
    pub h: Sym2<'b>,
    /// Coefficients of shared symbols, in the symbols' order.
    pub shared: SmallVec<[(Symbol, Float<'b>); 2]>,
    /// The variance of what nothing else shares.
    pub private: Float<'b>,
    /// The least and largest value that the signal takes at any point, as far as is known.
    pub range: [f32; 2],
    /// The two values of a signal that takes no others, such as a step: every function of it is
    /// linear.
    pub binary: Option<[Float<'b>; 2]>,
    /// The symbol of this signal's second Hermite polynomial, where several transfers read it.
    pub hermite: Option<Symbol>,
    /// Of a slope: the share of the footprint that has it, 3 E[X²]²/E[X⁴], as of a Gaussian there and 0
    /// elsewhere; `None` for a Gaussian's 1.
    pub share: Option<Float<'b>>,
    /// How the signal changes with u and with v, where that is carried and known.
    pub slope: Option<Slope<'b>>,
}

impl Clone for Signal<'_> {
    fn clone(&self) -> Self {
        Self {
            // Copied as a whole: one by one takes as long as all the rest.
            shared: SmallVec::from_slice(&self.shared),
            slope: self.slope.clone(),
            ..*self
        }
    }
}

/// The covariance of two signals, split by what carries it.
#[derive(Clone, Copy, Debug)]
pub struct Covariance<'b> {
    /// The part of g.
    pub linear: Float<'b>,
    /// The part of everything else.
    pub rest: Float<'b>,
    /// The sum.
    pub total: Float<'b>,
}

/// No bound.
pub(crate) const UNBOUNDED: [f32; 2] = [f32::NEG_INFINITY, f32::INFINITY];

/// How many numbers a signal without symbols has: the mean, g, H and the private variance.
pub(crate) const PARTS: usize = 7;

impl<'b> Signal<'b> {
    /// A signal without spread.
    pub fn certain(mean: Float<'b>) -> Self {
        let zero = mean.literal(0.0);
        let range = mean.as_constant().map_or(UNBOUNDED, |x| [x, x]);
        Self {
            mean,
            cell: None,
            g: Vec2::splat(zero),
            h: Sym2::splat(zero),
            shared: SmallVec::new(),
            private: zero,
            range,
            binary: None,
            hermite: None,
            share: None,
            slope: None,
        }
    }

    /// A constant.
    pub fn constant(b: &'b Builder, x: f32) -> Self {
        Self::certain(b.float(x))
    }

    /// The same with a range.
    pub fn with_range(self, range: [f32; 2]) -> Self {
        Self { range, ..self }
    }

    /// The numbers of a signal that carries neither symbols nor a cell: mean, g, H, private variance.
    pub(crate) fn parts(&self) -> [Float<'b>; PARTS] {
        let ([gx, gy], [hxx, hxy, hyy]) = (self.g.0, self.h.0);
        [self.mean, gx, gy, hxx, hxy, hyy, self.private]
    }

    /// The signal of these numbers.
    pub(crate) fn of_parts([mean, gx, gy, hxx, hxy, hyy, private]: [Float<'b>; PARTS]) -> Self {
        Self {
            g: Vec2([gx, gy]),
            h: Sym2([hxx, hxy, hyy]),
            private,
            ..Self::certain(mean)
        }
    }

    /// Whether nothing but the mean is carried.
    pub fn is_certain(&self) -> bool {
        self.g.iter().all(|v| v.is_zero())
            && self.h.iter().all(|v| v.is_zero())
            && self.shared.iter().all(|(_, v)| v.is_zero())
            && self.private.is_zero()
    }

    /// The mean as one number.
    pub fn flat_mean(&self) -> Float<'b> {
        match self.cell {
            None => self.mean,
            Some(cell) => cell.to_float() + self.mean,
        }
    }

    /// The integer part of the mean and the rest in [0, 1), for lattices, whatever is carried. A place so
    /// far away that it is one number is taken for 0: an integer cannot hold its cell.
    pub fn place(&self) -> (Int<'b>, Float<'b>) {
        match self.cell {
            None => position::split(self.mean),
            Some(cell) => (cell, self.mean.abs().lt(2.0).select(self.mean, 0.0)),
        }
    }

    /// The same signal with its mean as one number.
    pub fn flat(&self) -> Self {
        Self {
            mean: self.flat_mean(),
            cell: None,
            ..self.clone()
        }
    }

    /// |g|².
    pub fn linear_variance(&self) -> Float<'b> {
        self.g.norm2()
    }

    /// ½‖H‖² + Σ c² + private: the variance beyond the linear response.
    pub fn other_variance(&self) -> Float<'b> {
        self.h.half_contraction(self.h) + self.private + self.shared_variance()
    }

    /// Σ c²: the variance of shared symbols.
    pub fn shared_variance(&self) -> Float<'b> {
        let squares = self.shared.iter().map(|(_, c)| c.square());
        self.mean.builder().sum(squares)
    }

    /// The variance.
    pub fn variance(&self) -> Float<'b> {
        self.linear_variance() + self.other_variance()
    }

    /// The covariance with another signal: the dot product of the coefficients.
    pub fn covariance(&self, other: &Self) -> Covariance<'b> {
        let linear = self.g.dot(other.g);
        let rest = self.h.half_contraction(other.h) + self.shared_covariance(other);
        Covariance {
            linear,
            rest,
            total: linear + rest,
        }
    }

    /// Σ c d over the symbols that both carry.
    pub(super) fn shared_covariance(&self, other: &Self) -> Float<'b> {
        let both = |&(symbol, c): &(Symbol, Float<'b>)| Some(c * other.coefficient(symbol)?);
        self.mean.builder().sum(self.shared.iter().filter_map(both))
    }

    /// The coefficient of a shared symbol.
    pub fn coefficient(&self, symbol: Symbol) -> Option<Float<'b>> {
        self.shared
            .iter()
            .find(|&&(s, _)| s == symbol)
            .map(|&(_, c)| c)
    }

    /// The coefficient of a shared symbol, 0 where it is not carried.
    pub(super) fn coefficient_or_zero(&self, symbol: Symbol) -> Float<'b> {
        let coefficient = self.coefficient(symbol);
        coefficient.unwrap_or_else(|| self.mean.literal(0.0))
    }

    /// The skewness κ₃/σ³ that g and H carry, limited to ±1 (`inverse_sd` = 1/σ):
    /// κ₃ = 3 gᵀHg + tr H³. In units of σ, since a footprint's sixth power overflows.
    pub fn skewness(&self, inverse_sd: Float<'b>) -> Float<'b> {
        let Vec2([x, y]) = self.g * inverse_sd;
        let Sym2([h11, h12, h22]) = self.h * inverse_sd;
        let xy = x * y;
        let quadratic = (x.square() * h11 + (xy + xy) * h12 + y.square() * h22) * 3.0;
        // tr H³ = h₁₁³ + h₂₂³ + 3 h₁₂² (h₁₁ + h₂₂).
        let cube = h11.square() * h11 + h22.square() * h22 + h12.square() * 3.0 * (h11 + h22);
        let skewness = quadratic + cube;
        if skewness.is_zero() {
            return skewness;
        }
        skewness.clamp(-1.0, 1.0)
    }

    /// `by · X` for a number without spread.
    pub fn scale(&self, by: impl Operand<'b, f32>) -> Self {
        let by = by.within(self.mean.builder());
        let known = by.as_constant();
        if known == Some(1.0) {
            return self.clone();
        }
        let (cell, mean) = position::scale((self.cell, self.mean), by);
        let [low, high] = self.range;
        Self {
            mean,
            cell,
            g: self.g * by,
            h: self.h * by,
            shared: self.shared.iter().map(|&(s, c)| (s, c * by)).collect(),
            private: self.private * by.square(),
            range: match known {
                Some(by) if low.is_finite() && high.is_finite() => ordered(low * by, high * by),
                _ => UNBOUNDED,
            },
            binary: self.binary.map(|values| values.map(|v| v * by)),
            hermite: None,
            share: self.share,
            slope: self.map_slope(|slope| slope.scale(by)),
        }
    }

    /// `X / by` for a number that is known: a position keeps all its digits, which a product with the
    /// rounded inverse of the number would not.
    pub fn over(&self, by: f32) -> Self {
        let (cell, mean) = position::divide((self.cell, self.mean), by);
        Self {
            cell,
            mean,
            ..self.scale(1.0 / by)
        }
    }

    /// `X + by` for a number without spread.
    pub fn offset(&self, by: impl Operand<'b, f32>) -> Self {
        let by = by.within(self.mean.builder());
        if by.is_zero() {
            return self.clone();
        }
        let (cell, mean) = position::add((self.cell, self.mean), (None, by));
        let range = match by.as_constant() {
            Some(by) => [self.range[0] + by, self.range[1] + by],
            None => UNBOUNDED,
        };
        Self {
            mean,
            cell,
            range,
            binary: self.binary.map(|values| values.map(|v| v + by)),
            hermite: None,
            ..self.clone()
        }
    }

    /// `other` where the condition holds, else this.
    pub(crate) fn select(&self, condition: Bool<'b>, other: &Self) -> Self {
        let (x, y) = (self.flat(), other.flat());
        let pick = |c: Float<'b>, d: Float<'b>| condition.select(d, c);
        let shared = symbols_of(&[&x, &y]).into_iter().map(|symbol| {
            let [c, d] = [&x, &y].map(|signal| signal.coefficient_or_zero(symbol));
            (symbol, pick(c, d))
        });
        Self {
            mean: pick(x.mean, y.mean),
            cell: None,
            g: x.g.zip(y.g, pick),
            h: x.h.zip(y.h, pick),
            shared: shared.collect(),
            private: pick(x.private, y.private),
            range: [x.range[0].min(y.range[0]), x.range[1].max(y.range[1])],
            binary: None,
            hermite: None,
            share: share::either(&x, &y, condition),
            slope: combined(&x, &y, |p, q| p.select(condition, q)),
        }
    }

    /// What both carry of shared symbols, added.
    fn shared_sum(&self, other: &Self) -> SmallVec<[(Symbol, Float<'b>); 2]> {
        let mut shared = SmallVec::new();
        let (mut i, mut j) = (0, 0);
        while i < self.shared.len() || j < other.shared.len() {
            match (self.shared.get(i), other.shared.get(j)) {
                (Some(&(s, c)), Some(&(t, d))) if s == t => {
                    shared.push((s, c + d));
                    (i, j) = (i + 1, j + 1);
                }
                (Some(&(s, c)), Some(&(t, _))) if s < t => {
                    shared.push((s, c));
                    i += 1;
                }
                (Some(&(s, c)), None) => {
                    shared.push((s, c));
                    i += 1;
                }
                (_, Some(&(t, d))) => {
                    shared.push((t, d));
                    j += 1;
                }
                (None, None) => break,
            }
        }
        shared
    }

    /// Adds a coefficient of a shared symbol that is not yet carried, or adds to it.
    pub(super) fn push_shared(&mut self, symbol: Symbol, coefficient: Float<'b>) {
        debug_assert!(self.coefficient(symbol).is_none(), "{symbol:?} twice");
        let at = self
            .shared
            .iter()
            .position(|&(s, _)| s > symbol)
            .unwrap_or(self.shared.len());
        self.shared.insert(at, (symbol, coefficient));
    }

    /// Makes one symbol, the first, of those of `symbols` that the signal carries.
    pub(crate) fn merge(&mut self, symbols: &[Symbol]) {
        let mine: Vec<(Symbol, Float<'b>)> = (self.shared.iter().copied())
            .filter(|(symbol, _)| symbols.contains(symbol))
            .collect();
        let [(first, _), _, ..] = mine[..] else {
            return;
        };
        let squares = mine.iter().map(|(_, coefficient)| coefficient.square());
        let root = self.mean.builder().sum(squares).sqrt();
        self.shared.retain(|(symbol, _)| !symbols.contains(symbol));
        self.push_shared(first, root);
    }

    /// Folds a shared symbol into the private variance.
    pub fn retire(&mut self, symbol: Symbol) {
        if let Some(at) = self.shared.iter().position(|&(s, _)| s == symbol) {
            let (_, coefficient) = self.shared.remove(at);
            self.private += coefficient.square();
        }
    }
}

/// `X + Y`: coefficients add.
impl<'b> Add for &Signal<'b> {
    type Output = Signal<'b>;

    fn add(self, other: Self) -> Signal<'b> {
        let (cell, mean) = position::add((self.cell, self.mean), (other.cell, other.mean));
        let mut binary = None;
        for (x, y) in [(self, other), (other, self)] {
            if let (Some(values), true) = (x.binary, y.is_certain() && y.cell.is_none()) {
                binary = Some(values.map(|v| v + y.mean));
            }
        }
        Signal {
            mean,
            cell,
            g: self.g + other.g,
            h: self.h + other.h,
            private: self.private + other.private,
            shared: self.shared_sum(other),
            range: [
                self.range[0] + other.range[0],
                self.range[1] + other.range[1],
            ],
            binary,
            hermite: None,
            share: share::of_sum(self, other),
            slope: combined(self, other, |p, q| p + q),
        }
    }
}

/// `−X`.
impl<'b> Neg for &Signal<'b> {
    type Output = Signal<'b>;

    fn neg(self) -> Signal<'b> {
        self.scale(-1.0)
    }
}

/// `X − Y`.
impl<'b> Sub for &Signal<'b> {
    type Output = Signal<'b>;

    fn sub(self, other: Self) -> Signal<'b> {
        self + &-other
    }
}

/// `X · by` for a number without spread.
impl<'b, R: Operand<'b, f32>> Mul<R> for &Signal<'b> {
    type Output = Signal<'b>;

    fn mul(self, by: R) -> Signal<'b> {
        self.scale(by)
    }
}

/// The same operators for signals that are not needed any more.
macro_rules! owned {
    ($($trait:ident $method:ident;)*) => {
        $(impl<'b> $trait for Signal<'b> {
            type Output = Self;

            fn $method(self, other: Self) -> Self {
                (&self).$method(&other)
            }
        }

        impl<'b> $trait<&Self> for Signal<'b> {
            type Output = Self;

            fn $method(self, other: &Self) -> Self {
                (&self).$method(other)
            }
        }

        impl<'b> $trait<Signal<'b>> for &Signal<'b> {
            type Output = Signal<'b>;

            fn $method(self, other: Signal<'b>) -> Signal<'b> {
                self.$method(&other)
            }
        })*
    };
}

owned! { Add add; Sub sub; }

impl Neg for Signal<'_> {
    type Output = Self;

    fn neg(self) -> Self {
        -&self
    }
}

impl<'b, R: Operand<'b, f32>> Mul<R> for Signal<'b> {
    type Output = Self;

    fn mul(self, by: R) -> Self {
        self.scale(by)
    }
}

/// The symbols that signals carry, in order.
pub(super) fn symbols_of(signals: &[&Signal<'_>]) -> SmallVec<[Symbol; 8]> {
    let all = signals.iter().flat_map(|signal| &signal.shared);
    let mut symbols: SmallVec<[Symbol; 8]> = all.map(|&(symbol, _)| symbol).collect();
    symbols.sort_unstable();
    symbols.dedup();
    symbols
}

/// Two numbers in order.
pub(super) fn ordered(a: f32, b: f32) -> [f32; 2] {
    if a <= b { [a, b] } else { [b, a] }
}
