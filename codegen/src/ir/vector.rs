//! Numbers that belong together: vectors of the plane and symmetric matrices. The IR has scalars alone;
//! these are for whoever writes formulas.

use super::{Float, Scalar, Scalars};
use std::ops::{Add, Deref, DerefMut, Mul, Neg, Sub};

/// Σ aᵢ bᵢ.
///
/// # Panics
/// If there are no terms: a bug of the caller.
pub fn dot<'b, const N: usize>(a: [Float<'b>; N], b: [Float<'b>; N]) -> Float<'b> {
    let products = a.into_iter().zip(b).map(|(a, b)| a * b);
    (products.reduce(|sum, product| sum + product)).expect("a sum has terms")
}

/// A vector of the plane: x, y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vec2<'b>(pub [Float<'b>; 2]);

/// A symmetric 2×2 matrix: its components 11, 12, 22.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sym2<'b>(pub [Float<'b>; 3]);

impl<'b> Vec2<'b> {
    /// The scalar product.
    pub fn dot(self, other: Self) -> Float<'b> {
        dot(self.0, other.0)
    }

    /// |v|².
    pub fn norm2(self) -> Float<'b> {
        self.dot(self)
    }

    /// v vᵀ.
    pub fn outer(self) -> Sym2<'b> {
        let [x, y] = self.0;
        Sym2([x.square(), x * y, y.square()])
    }
}

impl<'b> Sym2<'b> {
    /// ½ A:B, half of the sum of the products of all four components.
    pub fn half_contraction(self, other: Self) -> Float<'b> {
        let ([xx, xy, yy], [other_xx, other_xy, other_yy]) = (self.0, other.0);
        (xx * other_xx + yy * other_yy) * 0.5 + xy * other_xy
    }

    /// The product with a vector.
    pub fn times(self, v: Vec2<'b>) -> Vec2<'b> {
        let [xx, xy, yy] = self.0;
        Vec2([dot([xx, xy], v.0), dot([xy, yy], v.0)])
    }

    /// The eigenvalues, the larger first: half of the trace ± the root of what the matrix is beyond it.
    pub fn eigenvalues(self) -> [Float<'b>; 2] {
        let [xx, xy, yy] = self.0;
        let (middle, tilt) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let root = (tilt * tilt + xy * xy).sqrt();
        [middle + root, middle - root]
    }
}

macro_rules! vectors {
    ($($ty:ident $n:literal)*) => {
        $(impl<'b> $ty<'b> {
            /// `x` in each place.
            pub fn splat(x: Float<'b>) -> Self {
                Self([x; $n])
            }

            /// Each component through `f`.
            pub fn map(self, f: impl FnMut(Float<'b>) -> Float<'b>) -> Self {
                Self(self.0.map(f))
            }

            /// Each pair of components through `f`.
            pub fn zip(self, other: Self, f: impl Fn(Float<'b>, Float<'b>) -> Float<'b>) -> Self {
                Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
            }
        }

        impl<'b> From<[Float<'b>; $n]> for $ty<'b> {
            fn from(components: [Float<'b>; $n]) -> Self {
                Self(components)
            }
        }

        impl<'b> Deref for $ty<'b> {
            type Target = [Float<'b>; $n];

            fn deref(&self) -> &Self::Target {
                &self.0
            }
        }

        impl DerefMut for $ty<'_> {
            fn deref_mut(&mut self) -> &mut Self::Target {
                &mut self.0
            }
        }

        impl<'b> IntoIterator for $ty<'b> {
            type Item = Float<'b>;
            type IntoIter = std::array::IntoIter<Float<'b>, $n>;

            fn into_iter(self) -> Self::IntoIter {
                self.0.into_iter()
            }
        }

        impl<'b> Scalars<'b> for $ty<'b> {
            fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
                self.0.each(visit);
            }

            fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
                Self(self.0.replaced(next))
            }
        }

        impl Add for $ty<'_> {
            type Output = Self;
            fn add(self, other: Self) -> Self {
                self.zip(other, |x, y| x + y)
            }
        }

        impl Sub for $ty<'_> {
            type Output = Self;
            fn sub(self, other: Self) -> Self {
                self.zip(other, |x, y| x - y)
            }
        }

        impl Neg for $ty<'_> {
            type Output = Self;
            fn neg(self) -> Self {
                self.map(|x| -x)
            }
        }

        impl<'b> Mul<Float<'b>> for $ty<'b> {
            type Output = Self;
            fn mul(self, by: Float<'b>) -> Self {
                self.map(|x| x * by)
            }
        }

        impl Mul<f32> for $ty<'_> {
            type Output = Self;
            fn mul(self, by: f32) -> Self {
                self.map(|x| x * by)
            }
        })*
    };
}

vectors! { Vec2 2 Sym2 3 }
