//! The covariance of a position in space.

use super::{PAIRS, place};
use mipless_codegen::ir::{Builder, Value};
use mipless_codegen::moments::Signal;

/// Positions spread over more than this many kernel widths are spread over it: every noise is gone
/// long before, and the square of the square is finite.
const WIDEST: f32 = 1.0e4;

/// S = Σ/a² of a position in cells, a being the width of the kernel.
#[derive(Clone, Copy, Debug)]
pub(in crate::noise) struct Spread {
    /// In the order of [`PAIRS`].
    pub(in crate::noise) covariance: [Value; 6],
    /// The adjugate, S⁻¹ det S.
    pub(in crate::noise) adjugate: [Value; 6],
    /// det S, 0 for a surface that nothing displaces.
    pub(in crate::noise) determinant: Value,
    /// tr S.
    pub(in crate::noise) trace: Value,
}

/// P = (I + S)⁻¹.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inverse {
    /// In the order of [`PAIRS`].
    pub(super) matrix: [Value; 6],
    /// tr adj S.
    pub(super) minors: Value,
    /// 1/det(I + S).
    pub(super) shrink: Value,
}

impl Spread {
    /// Of a position (x, y, z), for a kernel of this width in cells; zero where signals carry none.
    pub(in crate::noise) fn of(b: &mut Builder, position: &[Signal], width: f32) -> Self {
        assert_eq!(position.len(), 3, "a position in space");
        // One factor for all keeps the shape.
        let mut total = b.f32(0.0);
        for axis in position {
            let variance = axis.variance(b);
            total = b.add(total, variance);
        }
        let limit = b.f32((WIDEST * width) * (WIDEST * width));
        let most = b.max(total, limit);
        let factor = b.div(limit, most);
        let factor = b.scale(factor, 1.0 / (width * width));
        let root = b.sqrt(factor);
        let covariance = PAIRS.map(|[i, j]| {
            let covariance = position[i].covariance(b, &position[j]).total;
            b.mul(covariance, factor)
        });
        let others = position.iter().map(|axis| axis.other_variance(b));
        let flat = others.collect::<Vec<_>>().iter().all(|&v| b.is_zero(v));
        let (adjugate, determinant) = if flat {
            // Rank 2: the adjugate of JJᵀ is ccᵀ with c the cross product of J's columns.
            let [p, q] = [0, 1].map(|k| [0, 1, 2].map(|i| b.mul(position[i].g[k], root)));
            let c = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| {
                let (left, right) = (b.mul(p[i], q[j]), b.mul(p[j], q[i]));
                b.sub(left, right)
            });
            (PAIRS.map(|[i, j]| b.mul(c[i], c[j])), b.f32(0.0))
        } else {
            let adjugate = PAIRS.map(|[i, j]| cofactor(b, &covariance, i, j));
            let row = [0, 1, 2].map(|j| adjugate[place(0, j)]);
            let determinant = b.dot(&covariance[..3], &row);
            let zero = b.f32(0.0);
            (adjugate, b.max(determinant, zero))
        };
        let diagonal = [0, 3, 5].map(|at| covariance[at]);
        let sum = b.add(diagonal[0], diagonal[1]);
        Self {
            covariance,
            adjugate,
            determinant,
            trace: b.add(sum, diagonal[2]),
        }
    }

    /// (I + S)⁻¹. With t = tr S, m = tr adj S, e = 1 + t + m + det S it is ((1 + t)I − S + adj S)/e.
    pub(super) fn inverse(&self, b: &mut Builder) -> Inverse {
        let minors = [0, 3, 5].map(|at| self.adjugate[at]);
        let sum = b.add(minors[0], minors[1]);
        let sum = b.add(sum, minors[2]);
        let zero = b.f32(0.0);
        let minors = b.max(sum, zero);
        let e = b.add(self.trace, minors);
        let e = b.add(e, self.determinant);
        let e = b.offset(e, 1.0);
        let one = b.f32(1.0);
        let shrink = b.div(one, e);
        // 1 + t − S₁₁ is 1 + S₂₂ + S₃₃, without a difference.
        let diagonal = [0, 3, 5].map(|at| self.covariance[at]);
        let mut matrix = self.covariance;
        for (at, out) in matrix.iter_mut().enumerate() {
            let first = match at {
                0 => b.add(diagonal[1], diagonal[2]),
                3 => b.add(diagonal[0], diagonal[2]),
                5 => b.add(diagonal[0], diagonal[1]),
                _ => b.neg(self.covariance[at]),
            };
            let first = match at {
                0 | 3 | 5 => b.offset(first, 1.0),
                _ => first,
            };
            let sum = b.add(first, self.adjugate[at]);
            *out = b.mul(sum, shrink);
        }
        Inverse {
            matrix,
            minors,
            shrink,
        }
    }

    /// The largest standard deviation on the surface: the root of the larger of two eigenvalues.
    pub(in crate::noise) fn size(&self, b: &mut Builder) -> Value {
        let [x, y, z] = [0, 3, 5].map(|at| self.adjugate[at]);
        let minors = b.add(x, y);
        let minors = b.add(minors, z);
        let half = b.scale(self.trace, 0.5);
        let square = b.square(half);
        let zero = b.f32(0.0);
        let apart = b.sub(square, minors);
        let apart = b.max(apart, zero);
        let apart = b.sqrt(apart);
        let eigenvalue = b.add(half, apart);
        b.sqrt(eigenvalue)
    }

    /// The parameters of a function that takes it over, in the order of [`Spread::captures`].
    pub(in crate::noise) fn declare(b: &mut Builder) -> Self {
        let axes = ["x", "y", "z"];
        let mut matrix =
            |name: &str| PAIRS.map(|[i, j]| b.param_f32(format!("{name}_{}{}", axes[i], axes[j])));
        let (covariance, adjugate) = (matrix("s"), matrix("adjugate"));
        Self {
            covariance,
            adjugate,
            determinant: b.param_f32("determinant"),
            trace: b.param_f32("trace"),
        }
    }

    pub(in crate::noise) fn captures(&self) -> Vec<Value> {
        let mut all = self.covariance.to_vec();
        all.extend(self.adjugate);
        all.extend([self.determinant, self.trace]);
        all
    }

    /// For a lattice `scale` times as fine.
    pub(super) fn scaled(&self, b: &mut Builder, scale: Value) -> Self {
        let area = b.square(scale);
        let raised = b.offset(self.trace, 1e-12);
        let limit = b.f32(WIDEST * WIDEST);
        let most = b.div(limit, raised);
        let area = b.min(area, most);
        let area2 = b.square(area);
        let area3 = b.mul(area2, area);
        Self {
            covariance: self.covariance.map(|s| b.mul(s, area)),
            adjugate: self.adjugate.map(|s| b.mul(s, area2)),
            determinant: b.mul(self.determinant, area3),
            trace: b.mul(self.trace, area),
        }
    }
}

/// The cofactor (i, j) of a symmetric matrix.
fn cofactor(b: &mut Builder, matrix: &[Value; 6], i: usize, j: usize) -> Value {
    let [p, q] = [(i + 1) % 3, (i + 2) % 3];
    let [r, s] = [(j + 1) % 3, (j + 2) % 3];
    let left = b.mul(matrix[place(p, r)], matrix[place(q, s)]);
    let right = b.mul(matrix[place(p, s)], matrix[place(q, r)]);
    b.sub(left, right)
}
