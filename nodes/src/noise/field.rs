//! The field of a filtered source, and the signal that it is at a position with a spread.

use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Value};
use mipless_codegen::moments::{Mode, Signal};

/// The covariance of a position within the footprint, in squared units of the position.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spread {
    /// Σ₁₁, Σ₁₂, Σ₂₂.
    pub(crate) covariance: [Value; 3],
    /// The eigenvalues of Σ, the larger first, at least 0.
    pub(crate) eigenvalues: [Value; 2],
}

/// Positions spread over more than this are spread over it: every noise is gone long before.
const WIDEST: f32 = 1.0e4;

impl Spread {
    /// Of a position (x, y); zero where signals carry none.
    pub(crate) fn of(b: &mut Builder, position: &[Signal]) -> Self {
        let [x, y] = position else {
            panic!("a position has two coordinates")
        };
        let limit = b.f32(WIDEST * WIDEST);
        let (vx, vy) = (x.variance(b), y.variance(b));
        let covariance = x.covariance(b, y).total;
        // One factor for all three keeps the shape.
        let largest = b.max(vx, vy);
        let largest = b.max(largest, limit);
        let factor = b.div(limit, largest);
        let covariance = [vx, covariance, vy].map(|v| b.mul(v, factor));
        let [xx, xy, yy] = covariance;
        let (sum, difference) = (b.add(xx, yy), b.sub(xx, yy));
        let (half, tilt) = (b.scale(sum, 0.5), b.scale(difference, 0.5));
        let square = b.dot(&[tilt, xy], &[tilt, xy]);
        let root = b.sqrt(square);
        let zero = b.f32(0.0);
        let (more, less) = (b.add(half, root), b.sub(half, root));
        Self {
            covariance,
            eigenvalues: [more, b.max(less, zero)],
        }
    }
}

/// A source filtered by the footprint, in units of its position; what is not carried is 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Field {
    /// M.
    pub(crate) mean: Value,
    /// ∇M.
    pub(crate) gradient: [Value; 2],
    /// Hess M: 11, 12, 22.
    pub(crate) hessian: [Value; 3],
    /// The variance that the filter removed beyond what the mode carries.
    pub(crate) rest: Value,
}

impl Field {
    /// The signal of the field at a position with coefficients: g = Jᵀ∇M, H = Jᵀ Hess(M) J +
    /// Σ ∂_i M H_i, the position's own symbols through ∇M, and the rest as a fresh ε.
    pub(crate) fn at(&self, lower: &mut Lower<'_>, position: &[Signal]) -> Signal {
        let [x, y] = position else {
            panic!("a position has two coordinates")
        };
        let algebra = &mut lower.algebra;
        let [dx, dy] = self.gradient;
        let b = &mut algebra.b;
        let mut signal = Signal::certain(b, self.mean);
        if matches!(algebra.mode, Mode::Point | Mode::Naive) {
            return signal;
        }
        if matches!(algebra.mode, Mode::Local | Mode::Quad) {
            let (of_x, of_y) = (x.scale(b, dx), y.scale(b, dy));
            signal = of_x.add(b, &of_y);
            signal.cell = None;
            signal.mean = self.mean;
        }
        if algebra.mode == Mode::Quad {
            let [h11, h12, h22] = self.hessian;
            // Columns of J: the response of (x, y) to δ₁ and to δ₂.
            let columns = [[x.g[0], y.g[0]], [x.g[1], y.g[1]]];
            for (out, (i, j)) in signal.h.iter_mut().zip([(0, 0), (0, 1), (1, 1)]) {
                let [p, q] = columns[i];
                let [r, s] = columns[j];
                let left = b.dot(&[h11, h12], &[r, s]);
                let right = b.dot(&[h12, h22], &[r, s]);
                let bent = b.dot(&[p, q], &[left, right]);
                *out = b.add(*out, bent);
            }
        }
        lower.algebra.attach_fresh(&mut signal, self.rest);
        signal
    }
}
