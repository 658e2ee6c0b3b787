//! What values a signal can have: intervals, one a component, with the arithmetic of intervals
//! (Moore 1966, *Interval Analysis*, ch. 2). An interval holds every value, and often more: the
//! operands of an operation are taken for independent.

use std::fmt;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The values from `low` to `high`, both of them included where they are finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The least.
    pub low: f32,
    /// The largest.
    pub high: f32,
}

impl Interval {
    /// Any number.
    pub const ANY: Self = Self::new(f32::NEG_INFINITY, f32::INFINITY);

    /// From a number to a number.
    pub const fn new(low: f32, high: f32) -> Self {
        Self { low, high }
    }

    /// One number.
    pub const fn point(x: f32) -> Self {
        Self::new(x, x)
    }

    /// The least interval that holds these numbers; any number where one is none.
    fn around<const N: usize>(numbers: [f32; N]) -> Self {
        if numbers.iter().any(|x| x.is_nan()) {
            return Self::ANY;
        }
        let low = numbers.into_iter().fold(f32::INFINITY, f32::min);
        let high = numbers.into_iter().fold(f32::NEG_INFINITY, f32::max);
        Self { low, high }
    }

    /// Whether it holds a number.
    pub fn contains(self, x: f32) -> bool {
        self.low <= x && x <= self.high
    }

    /// Whether it has both ends.
    pub fn is_bounded(self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    /// What both hold, and what is between them.
    pub fn hull(self, other: Self) -> Self {
        Self::new(self.low.min(other.low), self.high.max(other.high))
    }

    /// The values of a function that rises or falls everywhere, from those at the ends.
    pub fn monotone(self, f: impl Fn(f32) -> f32) -> Self {
        Self::around([f(self.low), f(self.high)])
    }

    /// |x|.
    pub fn abs(self) -> Self {
        let [low, high] = [self.low.abs(), self.high.abs()];
        let least = if self.contains(0.0) {
            0.0
        } else {
            low.min(high)
        };
        Self::new(least, low.max(high))
    }

    /// The smaller of two numbers.
    pub fn min(self, other: Self) -> Self {
        Self::new(self.low.min(other.low), self.high.min(other.high))
    }

    /// The larger of two numbers.
    pub fn max(self, other: Self) -> Self {
        Self::new(self.low.max(other.low), self.high.max(other.high))
    }
}

impl fmt::Display for Interval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.low.is_finite(), self.high.is_finite()) {
            _ if self.low == self.high => write!(f, "{}", self.low),
            (true, true) => write!(f, "from {} to {}", self.low, self.high),
            (true, false) => write!(f, "{} or more", self.low),
            (false, true) => write!(f, "{} or less", self.high),
            (false, false) => f.write_str("any number"),
        }
    }
}

impl Add for Interval {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::around([self.low + other.low, self.high + other.high])
    }
}

impl Neg for Interval {
    type Output = Self;

    fn neg(self) -> Self {
        Self::new(-self.high, -self.low)
    }
}

impl Sub for Interval {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Interval {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        // 0 times whatever is 0: no value is infinite, though there may be no largest.
        let product = |x: f32, y: f32| if x == 0.0 || y == 0.0 { 0.0 } else { x * y };
        Self::around([
            product(self.low, other.low),
            product(self.low, other.high),
            product(self.high, other.low),
            product(self.high, other.high),
        ])
    }
}

impl Div for Interval {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        if other.contains(0.0) {
            return Self::ANY;
        }
        self * Self::around([1.0 / other.low, 1.0 / other.high])
    }
}

/// The values of a signal: an interval for each component, of which it has as many as its type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach(pub [Interval; 4]);

impl Reach {
    /// Any number in each component.
    pub const ANY: Self = Self([Interval::ANY; 4]);

    /// The same interval in each component.
    pub const fn of(low: f32, high: f32) -> Self {
        Self([Interval::new(low, high); 4])
    }

    /// A number in each component.
    pub fn point(x: f32) -> Self {
        Self::of(x, x)
    }

    /// These numbers; the last of them in all further components.
    pub fn numbers(numbers: &[f32]) -> Self {
        let last = numbers.len().saturating_sub(1);
        Self(std::array::from_fn(|i| {
            numbers
                .get(i.min(last))
                .map_or(Interval::ANY, |&x| Interval::point(x))
        }))
    }

    /// The first component of each.
    pub fn combined(parts: &[Self]) -> Self {
        Self(std::array::from_fn(|i| {
            parts.get(i).map_or(Interval::ANY, |part| part.0[0])
        }))
    }

    /// A component as the first of all.
    pub fn component(self, i: usize) -> Self {
        Self([self.0.get(i).copied().unwrap_or(Interval::ANY); 4])
    }

    /// A function of each component.
    pub fn map(self, f: impl Fn(Interval) -> Interval) -> Self {
        Self(self.0.map(f))
    }

    /// A function of each component that rises or falls everywhere.
    pub fn monotone(self, f: impl Fn(f32) -> f32 + Copy) -> Self {
        self.map(|interval| interval.monotone(f))
    }

    /// A function of each pair of components.
    pub fn zip(self, other: Self, f: impl Fn(Interval, Interval) -> Interval) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }

    /// The interval of the first `components` together.
    pub fn whole(self, components: usize) -> Interval {
        let parts = self.0.into_iter().take(components);
        parts.reduce(Interval::hull).unwrap_or(Interval::ANY)
    }

    /// What either holds and what is between.
    pub fn hull(self, other: Self) -> Self {
        self.zip(other, Interval::hull)
    }

    /// The smaller.
    pub fn min(self, other: Self) -> Self {
        self.zip(other, Interval::min)
    }

    /// The larger.
    pub fn max(self, other: Self) -> Self {
        self.zip(other, Interval::max)
    }

    /// from + share · (to − from), which lies between the two where the share is from 0 to 1.
    pub fn mixed(from: Self, to: Self, share: Self) -> Self {
        let one = Self::point(1.0);
        let mixed = from * (one - share) + to * share;
        let between = share.0.map(|s| s.low >= 0.0 && s.high <= 1.0);
        let hull = from.hull(to);
        Self(std::array::from_fn(|i| {
            if between[i] { hull.0[i] } else { mixed.0[i] }
        }))
    }
}

macro_rules! componentwise {
    ($($trait:ident $function:ident),*) => {$(
        impl $trait for Reach {
            type Output = Self;

            fn $function(self, other: Self) -> Self {
                self.zip(other, $trait::$function)
            }
        }
    )*};
}

componentwise! { Add add, Sub sub, Mul mul, Div div }

impl Neg for Reach {
    type Output = Self;

    fn neg(self) -> Self {
        self.map(Neg::neg)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_lies_in_the_interval_of_its_operation() {
        let ends = [-3.0, -1.0, -0.5, 0.0, 0.25, 2.0];
        let intervals: Vec<Interval> = (ends.iter())
            .flat_map(|&low| {
                ends.iter()
                    .filter(move |&&h| h >= low)
                    .map(move |&h| (low, h))
            })
            .map(|(low, high)| Interval::new(low, high))
            .collect();
        let inside = |i: Interval| [0.0, 0.3, 1.0].map(|t| i.low + t * (i.high - i.low));
        for &x in &intervals {
            for &y in &intervals {
                for (a, b) in inside(x)
                    .into_iter()
                    .flat_map(|a| inside(y).map(|b| (a, b)))
                {
                    assert!((x + y).contains(a + b));
                    assert!((x - y).contains(a - b));
                    assert!((x * y).contains(a * b));
                    assert!(
                        b == 0.0 || {
                            let quotient = x / y;
                            let slack = 1e-6 * (a / b).abs();
                            quotient.low <= a / b + slack && a / b - slack <= quotient.high
                        }
                    );
                    assert!(x.min(y).contains(a.min(b)) && x.max(y).contains(a.max(b)));
                    assert!(x.abs().contains(a.abs()));
                }
            }
        }
        assert_eq!(Interval::ANY * Interval::point(0.0), Interval::point(0.0));
        assert_eq!(Interval::ANY - Interval::ANY, Interval::ANY);
    }
}
