//! A scalar signal with its first two moments in factored form, and the linear rules.

use super::position;
use crate::ir::{Builder, Value};
use smallvec::SmallVec;

/// A unit-variance symbol ε that several signals share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Symbol(pub u32);

/// A scalar signal: see the module documentation. Coefficients that are absent are the constant 0.
#[derive(Debug)]
pub struct Signal {
    /// The mean; where `cell` is present, the mean is `cell + mean` and `mean` lies in [0, 1).
    pub mean: Value,
    /// The integer part of the mean of a position, which keeps its detail far from the origin.
    pub cell: Option<Value>,
    /// The linear response to δ.
    pub g: [Value; 2],
    /// The quadratic response to δ: H₁₁, H₁₂, H₂₂.
    pub h: [Value; 3],
    /// Coefficients of shared symbols, in the symbols' order.
    pub shared: SmallVec<[(Symbol, Value); 2]>,
    /// The variance of what nothing else shares.
    pub private: Value,
    /// The least and largest value that the signal takes at any point, as far as is known.
    pub range: [f32; 2],
    /// The two values of a signal that takes no others, such as a step: every function of it is
    /// linear.
    pub binary: Option<[Value; 2]>,
    /// The symbol of this signal's second Hermite polynomial, where several transfers read it.
    pub hermite: Option<Symbol>,
}

impl Clone for Signal {
    fn clone(&self) -> Self {
        Self {
            // Copied as a whole: one by one takes as long as all the rest.
            shared: SmallVec::from_slice(&self.shared),
            ..*self
        }
    }
}

/// The covariance of two signals, split by what carries it.
#[derive(Clone, Copy, Debug)]
pub struct Covariance {
    /// The part of g.
    pub linear: Value,
    /// The part of everything else.
    pub rest: Value,
    /// The sum.
    pub total: Value,
}

/// No bound.
pub(crate) const UNBOUNDED: [f32; 2] = [f32::NEG_INFINITY, f32::INFINITY];

impl Signal {
    /// A signal without spread.
    pub fn certain(b: &mut Builder, mean: Value) -> Self {
        let zero = b.f32(0.0);
        let range = b.as_constant(mean).map_or(UNBOUNDED, |x| [x, x]);
        Self {
            mean,
            cell: None,
            g: [zero; 2],
            h: [zero; 3],
            shared: SmallVec::new(),
            private: zero,
            range,
            binary: None,
            hermite: None,
        }
    }

    /// A constant.
    pub fn constant(b: &mut Builder, x: f32) -> Self {
        let mean = b.f32(x);
        Self::certain(b, mean)
    }

    /// The same with a range.
    pub fn with_range(self, range: [f32; 2]) -> Self {
        Self { range, ..self }
    }

    /// Whether nothing but the mean is carried.
    pub fn is_certain(&self, b: &Builder) -> bool {
        let zero = |&v: &Value| b.is_zero(v);
        self.g.iter().all(zero)
            && self.h.iter().all(zero)
            && self.shared.iter().all(|(_, v)| zero(v))
            && zero(&self.private)
    }

    /// The mean as one number.
    pub fn flat_mean(&self, b: &mut Builder) -> Value {
        match self.cell {
            None => self.mean,
            Some(cell) => {
                let cell = b.float_i(cell);
                b.add(cell, self.mean)
            }
        }
    }

    /// The same signal with its mean as one number.
    pub fn flat(&self, b: &mut Builder) -> Self {
        Self {
            mean: self.flat_mean(b),
            cell: None,
            ..self.clone()
        }
    }

    /// |g|².
    pub fn linear_variance(&self, b: &mut Builder) -> Value {
        b.dot(&self.g, &self.g)
    }

    /// ½‖H‖² + Σ c² + private: the variance beyond the linear response.
    pub fn other_variance(&self, b: &mut Builder) -> Value {
        let second = half_contraction(b, self.h, self.h);
        let own = b.add(second, self.private);
        let shared = self.shared_variance(b);
        b.add(own, shared)
    }

    /// Σ c²: the variance of shared symbols.
    pub(super) fn shared_variance(&self, b: &mut Builder) -> Value {
        let mut sum = b.f32(0.0);
        for &(_, c) in &self.shared {
            let square = b.square(c);
            sum = b.add(sum, square);
        }
        sum
    }

    /// The variance.
    pub fn variance(&self, b: &mut Builder) -> Value {
        let linear = self.linear_variance(b);
        let other = self.other_variance(b);
        b.add(linear, other)
    }

    /// The covariance with another signal: the dot product of the coefficients.
    pub fn covariance(&self, b: &mut Builder, other: &Self) -> Covariance {
        let linear = b.dot(&self.g, &other.g);
        let second = half_contraction(b, self.h, other.h);
        let shared = self.shared_covariance(b, other);
        let rest = b.add(second, shared);
        Covariance {
            linear,
            rest,
            total: b.add(linear, rest),
        }
    }

    /// Σ c d over the symbols that both carry.
    pub(super) fn shared_covariance(&self, b: &mut Builder, other: &Self) -> Value {
        let mut sum = b.f32(0.0);
        for &(symbol, c) in &self.shared {
            if let Some(d) = other.coefficient(symbol) {
                let product = b.mul(c, d);
                sum = b.add(sum, product);
            }
        }
        sum
    }

    /// The coefficient of a shared symbol.
    pub fn coefficient(&self, symbol: Symbol) -> Option<Value> {
        self.shared
            .iter()
            .find(|&&(s, _)| s == symbol)
            .map(|&(_, c)| c)
    }

    /// The skewness κ₃/σ³ that g and H carry, limited to ±1 (`inverse_sd` = 1/σ):
    /// κ₃ = 3 gᵀHg + tr H³. In units of σ, since a footprint's sixth power overflows.
    pub fn skewness(&self, b: &mut Builder, inverse_sd: Value) -> Value {
        let [x, y] = self.g.map(|v| b.mul(v, inverse_sd));
        let [h11, h12, h22] = self.h.map(|v| b.mul(v, inverse_sd));
        let (xx, xy, yy) = (b.square(x), b.mul(x, y), b.square(y));
        let xy2 = b.add(xy, xy);
        let quadratic = b.dot(&[xx, xy2, yy], &[h11, h12, h22]);
        let quadratic = b.scale(quadratic, 3.0);
        // tr H³ = h₁₁³ + h₂₂³ + 3 h₁₂² (h₁₁ + h₂₂).
        let (a2, d2, b2) = (b.square(h11), b.square(h22), b.square(h12));
        let trace = b.add(h11, h22);
        let b2 = b.scale(b2, 3.0);
        let cube = b.dot(&[a2, d2, b2], &[h11, h22, trace]);
        let skewness = b.add(quadratic, cube);
        if b.is_zero(skewness) {
            return skewness;
        }
        b.clamp(skewness, -1.0, 1.0)
    }

    /// Every coefficient through `f`, the mean through `mean`, private variances through `private`.
    fn map(
        &self,
        b: &mut Builder,
        (cell, mean): (Option<Value>, Value),
        mut f: impl FnMut(&mut Builder, Value) -> Value,
        private: impl FnOnce(&mut Builder, Value) -> Value,
    ) -> Self {
        Self {
            mean,
            cell,
            g: self.g.map(|v| f(b, v)),
            h: self.h.map(|v| f(b, v)),
            shared: self.shared.iter().map(|&(s, v)| (s, f(b, v))).collect(),
            private: private(b, self.private),
            range: UNBOUNDED,
            binary: None,
            hermite: None,
        }
    }

    /// `by · X` for a number without spread.
    pub fn scale(&self, b: &mut Builder, by: Value) -> Self {
        if b.as_constant(by) == Some(1.0) {
            return self.clone();
        }
        let mean = position::scale(b, (self.cell, self.mean), by);
        let mut out = self.map(
            b,
            mean,
            |b, v| b.mul(v, by),
            |b, v| {
                let square = b.square(by);
                b.mul(v, square)
            },
        );
        out.range = match b.as_constant(by) {
            Some(by) if self.range[0].is_finite() && self.range[1].is_finite() => {
                ordered(self.range[0] * by, self.range[1] * by)
            }
            _ => UNBOUNDED,
        };
        out.binary = self.binary.map(|values| values.map(|v| b.mul(v, by)));
        out
    }

    /// `X + by` for a number without spread.
    pub fn offset(&self, b: &mut Builder, by: Value) -> Self {
        if b.is_zero(by) {
            return self.clone();
        }
        let (cell, mean) = position::add(b, (self.cell, self.mean), (None, by));
        let range = match b.as_constant(by) {
            Some(by) => [self.range[0] + by, self.range[1] + by],
            None => UNBOUNDED,
        };
        Self {
            mean,
            cell,
            range,
            binary: self.binary.map(|values| values.map(|v| b.add(v, by))),
            hermite: None,
            ..self.clone()
        }
    }

    /// `other` where the condition holds, else this.
    pub(super) fn select(&self, b: &mut Builder, condition: Value, other: &Self) -> Self {
        let (x, y) = (self.flat(b), other.flat(b));
        let zero = b.f32(0.0);
        let mut symbols: SmallVec<[Symbol; 4]> = (x.shared.iter().chain(&y.shared))
            .map(|&(symbol, _)| symbol)
            .collect();
        symbols.sort_unstable();
        symbols.dedup();
        let shared = symbols.into_iter().map(|symbol| {
            let [c, d] = [&x, &y].map(|signal| signal.coefficient(symbol).unwrap_or(zero));
            (symbol, b.select(condition, d, c))
        });
        let shared = shared.collect();
        let mut pick = |c: Value, d: Value| b.select(condition, d, c);
        Self {
            mean: pick(x.mean, y.mean),
            cell: None,
            g: [pick(x.g[0], y.g[0]), pick(x.g[1], y.g[1])],
            h: [
                pick(x.h[0], y.h[0]),
                pick(x.h[1], y.h[1]),
                pick(x.h[2], y.h[2]),
            ],
            shared,
            private: pick(x.private, y.private),
            range: [x.range[0].min(y.range[0]), x.range[1].max(y.range[1])],
            binary: None,
            hermite: None,
        }
    }

    /// `−X`.
    pub fn negate(&self, b: &mut Builder) -> Self {
        let minus = b.f32(-1.0);
        self.scale(b, minus)
    }

    /// `X + Y`: coefficients add.
    pub fn add(&self, b: &mut Builder, other: &Self) -> Self {
        let (cell, mean) = position::add(b, (self.cell, self.mean), (other.cell, other.mean));
        let mut binary = None;
        for (x, y) in [(self, other), (other, self)] {
            if let (Some(values), true) = (x.binary, y.is_certain(b) && y.cell.is_none()) {
                binary = Some(values.map(|v| b.add(v, y.mean)));
            }
        }
        let mut shared = SmallVec::new();
        let (mut i, mut j) = (0, 0);
        while i < self.shared.len() || j < other.shared.len() {
            match (self.shared.get(i), other.shared.get(j)) {
                (Some(&(s, c)), Some(&(t, d))) if s == t => {
                    shared.push((s, b.add(c, d)));
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
        let mut pair = |a: Value, c: Value| b.add(a, c);
        Self {
            mean,
            cell,
            g: [pair(self.g[0], other.g[0]), pair(self.g[1], other.g[1])],
            h: [
                pair(self.h[0], other.h[0]),
                pair(self.h[1], other.h[1]),
                pair(self.h[2], other.h[2]),
            ],
            private: pair(self.private, other.private),
            shared,
            range: [
                self.range[0] + other.range[0],
                self.range[1] + other.range[1],
            ],
            binary,
            hermite: None,
        }
    }

    /// `X − Y`.
    pub fn sub(&self, b: &mut Builder, other: &Self) -> Self {
        let other = other.negate(b);
        self.add(b, &other)
    }
}

/// ½ A:B of symmetric 2×2 matrices.
pub(super) fn half_contraction(b: &mut Builder, x: [Value; 3], y: [Value; 3]) -> Value {
    let (p, q, r) = (b.mul(x[0], y[0]), b.mul(x[2], y[2]), b.mul(x[1], y[1]));
    let diagonal = b.add(p, q);
    let diagonal = b.scale(diagonal, 0.5);
    b.add(diagonal, r)
}

/// Two numbers in order.
pub(super) fn ordered(a: f32, b: f32) -> [f32; 2] {
    if a <= b { [a, b] } else { [b, a] }
}

impl Signal {
    /// Adds a coefficient of a shared symbol that is not yet carried, or adds to it.
    pub(super) fn push_shared(&mut self, symbol: Symbol, coefficient: Value) {
        debug_assert!(self.coefficient(symbol).is_none(), "{symbol:?} twice");
        let at = self
            .shared
            .iter()
            .position(|&(s, _)| s > symbol)
            .unwrap_or(self.shared.len());
        self.shared.insert(at, (symbol, coefficient));
    }

    /// Makes one symbol, the first, of those of `symbols` that the signal carries.
    pub(crate) fn merge(&mut self, b: &mut Builder, symbols: &[Symbol]) {
        let mine: Vec<(Symbol, Value)> = (self.shared.iter().copied())
            .filter(|(symbol, _)| symbols.contains(symbol))
            .collect();
        let [(first, start), rest @ ..] = &mine[..] else {
            return;
        };
        if rest.is_empty() {
            return;
        }
        let mut sum = b.square(*start);
        for (_, coefficient) in rest {
            let square = b.square(*coefficient);
            sum = b.add(sum, square);
        }
        let (first, root) = (*first, b.sqrt(sum));
        self.shared.retain(|(symbol, _)| !symbols.contains(symbol));
        self.push_shared(first, root);
    }

    /// Folds a shared symbol into the private variance.
    pub fn retire(&mut self, b: &mut Builder, symbol: Symbol) {
        if let Some(at) = self.shared.iter().position(|&(s, _)| s == symbol) {
            let (_, coefficient) = self.shared.remove(at);
            let square = b.square(coefficient);
            self.private = b.add(self.private, square);
        }
    }
}
