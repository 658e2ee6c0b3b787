//! Symmetric 3×3 matrices, and the two of a footprint.

use mipless_codegen::ir::{Builder, Float, Scalar, Scalars, dot};
use std::ops::Deref;

/// The pairs of axes of a symmetric matrix, in the order of its six numbers.
pub(super) const PAIRS: [[usize; 2]; 6] = [[0, 0], [0, 1], [0, 2], [1, 1], [1, 2], [2, 2]];

/// Where the number of a pair of axes stands.
pub(super) fn place(i: usize, j: usize) -> usize {
    PAIRS
        .iter()
        .position(|&pair| pair == [i.min(j), i.max(j)])
        .expect("axes are below 3")
}

/// A symmetric matrix by its numbers, in the order of [`PAIRS`].
#[derive(Clone, Copy, Debug)]
pub(in crate::noise) struct Symmetric<'b>(pub(in crate::noise) [Float<'b>; 6]);

impl<'b> Symmetric<'b> {
    /// The entry of two axes.
    pub(super) fn at(&self, i: usize, j: usize) -> Float<'b> {
        self.0[place(i, j)]
    }

    /// A row.
    pub(super) fn row(&self, i: usize) -> [Float<'b>; 3] {
        [0, 1, 2].map(|j| self.at(i, j))
    }

    /// All rows.
    pub(super) fn rows(&self) -> [[Float<'b>; 3]; 3] {
        [0, 1, 2].map(|i| self.row(i))
    }

    /// The diagonal.
    pub(in crate::noise) fn diagonal(&self) -> [Float<'b>; 3] {
        [0, 1, 2].map(|i| self.at(i, i))
    }

    /// The trace.
    pub(super) fn trace(&self) -> Float<'b> {
        let [x, y, z] = self.diagonal();
        x + y + z
    }

    /// The product with a vector.
    pub(super) fn times(&self, v: [Float<'b>; 3]) -> [Float<'b>; 3] {
        self.rows().map(|row| dot(row, v))
    }

    /// The matrix with every number multiplied.
    pub(super) fn scaled(&self, by: Float<'b>) -> Self {
        Self(self.0.map(|entry| entry * by))
    }

    /// I + this.
    pub(super) fn raised(&self) -> Self {
        Self(std::array::from_fn(|at| match PAIRS[at] {
            [i, j] if i == j => self.0[at] + 1.0,
            _ => self.0[at],
        }))
    }

    /// The adjugate: S⁻¹ det S.
    pub(super) fn adjugate(&self) -> Self {
        Self(PAIRS.map(|[i, j]| {
            let [p, q] = [(i + 1) % 3, (i + 2) % 3];
            let [r, s] = [(j + 1) % 3, (j + 2) % 3];
            self.at(p, r) * self.at(q, s) - self.at(p, s) * self.at(q, r)
        }))
    }
}

impl<'b> Deref for Symmetric<'b> {
    type Target = [Float<'b>; 6];

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

impl<'b> Scalars<'b> for Symmetric<'b> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        self.0.each(visit);
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        Self(self.0.replaced(next))
    }
}

/// What every kernel of an octave needs of the footprint.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape<'b> {
    /// P.
    pub(super) inverse: Symmetric<'b>,
    /// I + S.
    pub(super) total: Symmetric<'b>,
}

impl<'b> Shape<'b> {
    pub(super) fn declare(b: &'b Builder) -> Self {
        let matrix =
            |name: &str| Symmetric(PAIRS.map(|[i, j]| b.float_param(format!("{name}_{i}{j}"))));
        Self {
            inverse: matrix("p"),
            total: matrix("t"),
        }
    }
}

impl<'b> Scalars<'b> for Shape<'b> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        [self.inverse, self.total].each(visit);
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        Self {
            inverse: self.inverse.replaced(next),
            total: self.total.replaced(next),
        }
    }
}
