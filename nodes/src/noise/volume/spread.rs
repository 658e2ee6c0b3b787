//! The covariance of a position in space.

use super::symmetric::{PAIRS, Symmetric};
use mipless_codegen::ir::{Builder, Float, Scalar, Scalars, dot};
use mipless_codegen::moments::Signal;

/// Positions spread over more than this many kernel widths are spread over it: every noise is gone
/// long before, and the square of the square is finite.
const WIDEST: f32 = 1.0e4;

/// S = Σ/a² of a position in cells, a being the width of the kernel.
#[derive(Clone, Copy, Debug)]
pub(in crate::noise) struct Spread<'b> {
    /// S.
    pub(in crate::noise) covariance: Symmetric<'b>,
    /// The adjugate, S⁻¹ det S.
    pub(in crate::noise) adjugate: Symmetric<'b>,
    /// det S, 0 for a surface that nothing displaces.
    pub(in crate::noise) determinant: Float<'b>,
    /// tr S.
    pub(in crate::noise) trace: Float<'b>,
}

/// P = (I + S)⁻¹.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inverse<'b> {
    /// P.
    pub(super) matrix: Symmetric<'b>,
    /// tr adj S.
    pub(super) minors: Float<'b>,
    /// 1/det(I + S).
    pub(super) shrink: Float<'b>,
}

impl<'b> Spread<'b> {
    /// Of a position (x, y, z), for a kernel of this width in cells; zero where signals carry none.
    pub(in crate::noise) fn of(position: &[Signal<'b>], width: f32) -> Self {
        assert_eq!(position.len(), 3, "a position in space");
        let b = position[0].mean.builder();
        // One factor for all keeps the shape.
        let most = (WIDEST * width) * (WIDEST * width);
        let total = b.sum(position.iter().map(Signal::variance));
        let factor = most / total.max(most) * (1.0 / (width * width));
        let covariance =
            Symmetric(PAIRS.map(|[i, j]| position[i].covariance(&position[j]).total * factor));
        let flat = position.iter().all(|axis| axis.other_variance().is_zero());
        let (adjugate, determinant) = if flat {
            // Rank 2: the adjugate of JJᵀ is ccᵀ with c the cross product of J's columns.
            let root = factor.sqrt();
            let [p, q] = [0, 1].map(|k| [0, 1, 2].map(|i| position[i].g[k] * root));
            let c = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| p[i] * q[j] - p[j] * q[i]);
            (Symmetric(PAIRS.map(|[i, j]| c[i] * c[j])), b.float(0.0))
        } else {
            let adjugate = covariance.adjugate();
            let determinant = dot(covariance.row(0), adjugate.row(0)).max(0.0);
            (adjugate, determinant)
        };
        Self {
            covariance,
            adjugate,
            determinant,
            trace: covariance.trace(),
        }
    }

    /// (I + S)⁻¹. With t = tr S, m = tr adj S, e = 1 + t + m + det S it is ((1 + t)I − S + adj S)/e.
    pub(super) fn inverse(&self) -> Inverse<'b> {
        let minors = self.adjugate.trace().max(0.0);
        let shrink = 1.0 / (self.trace + minors + self.determinant + 1.0);
        // 1 + t − S₁₁ is 1 + S₂₂ + S₃₃, without a difference.
        let [x, y, z] = self.covariance.diagonal();
        let [_, xy, xz, _, yz, _] = *self.covariance;
        let first = [y + z + 1.0, -xy, -xz, x + z + 1.0, -yz, x + y + 1.0];
        Inverse {
            matrix: Symmetric(std::array::from_fn(|at| {
                (first[at] + self.adjugate[at]) * shrink
            })),
            minors,
            shrink,
        }
    }

    /// The largest standard deviation on the surface: the root of the larger of two eigenvalues.
    pub(in crate::noise) fn size(&self) -> Float<'b> {
        let half = self.trace * 0.5;
        let apart = (half.square() - self.adjugate.trace()).max(0.0).sqrt();
        (half + apart).sqrt()
    }

    /// The parameters of a function that takes it over.
    pub(in crate::noise) fn declare(b: &'b Builder) -> Self {
        let axes = ["x", "y", "z"];
        let matrix = |name: &str| {
            let entry =
                |[i, j]: [usize; 2]| b.float_param(format!("{name}_{}{}", axes[i], axes[j]));
            Symmetric(PAIRS.map(entry))
        };
        Self {
            covariance: matrix("s"),
            adjugate: matrix("adjugate"),
            determinant: b.float_param("determinant"),
            trace: b.float_param("trace"),
        }
    }

    /// For a lattice `scale` times as fine.
    pub(super) fn scaled(&self, scale: Float<'b>) -> Self {
        let area = scale.square().min(WIDEST * WIDEST / (self.trace + 1e-12));
        // Factor by factor: the cube of what scales a footprint of nothing is no number.
        Self {
            covariance: self.covariance.scaled(area),
            adjugate: self.adjugate.scaled(area).scaled(area),
            determinant: self.determinant * area * area * area,
            trace: self.trace * area,
        }
    }
}

impl<'b> Scalars<'b> for Spread<'b> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        let Self {
            covariance,
            adjugate,
            determinant,
            trace,
        } = *self;
        ([covariance, adjugate], determinant, trace).each(visit);
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        Self {
            covariance: self.covariance.replaced(next),
            adjugate: self.adjugate.replaced(next),
            determinant: self.determinant.replaced(next),
            trace: self.trace.replaced(next),
        }
    }
}
