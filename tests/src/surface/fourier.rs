//! Fourier's transform of a row whose length is a power of two (Cooley & Tukey 1965).

use std::f64::consts::TAU;
use std::ops::{Add, Mul, Sub};

/// A complex number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Complex {
    pub(super) re: f64,
    pub(super) im: f64,
}

impl Complex {
    /// Of this length and angle.
    pub(super) fn polar(length: f64, angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self {
            re: length * cos,
            im: length * sin,
        }
    }

    /// A real number.
    pub(super) const fn real(re: f64) -> Self {
        Self { re, im: 0.0 }
    }
}

impl Add for Complex {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            re: self.re + other.re,
            im: self.im + other.im,
        }
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self {
            re: self.re - other.re,
            im: self.im - other.im,
        }
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
        }
    }
}

/// The roots of unity that transforms of one length use.
#[derive(Clone, Debug)]
pub(super) struct Roots(Vec<Complex>);

impl Roots {
    /// Of rows of this length, a power of two; `sign` is −1 forward and 1 backward.
    pub(super) fn new(length: usize, sign: f64) -> Self {
        assert!(length.is_power_of_two(), "{length} is no power of two");
        let angle = |k: usize| sign * TAU * k as f64 / length as f64;
        Self(
            (0..length / 2)
                .map(|k| Complex::polar(1.0, angle(k)))
                .collect(),
        )
    }

    /// Transforms a row in place, without a factor.
    pub(super) fn transform(&self, row: &mut [Complex]) {
        let n = row.len();
        let shift = usize::BITS - n.trailing_zeros();
        for i in 0..n {
            let j = i.reverse_bits() >> shift;
            if i < j {
                row.swap(i, j);
            }
        }
        let mut half = 1;
        while half < n {
            let stride = n / (2 * half);
            for block in row.chunks_mut(2 * half) {
                let (low, high) = block.split_at_mut(half);
                for (k, (a, b)) in low.iter_mut().zip(high).enumerate() {
                    let turned = *b * self.0[k * stride];
                    (*a, *b) = (*a + turned, *a - turned);
                }
            }
            half *= 2;
        }
    }
}
