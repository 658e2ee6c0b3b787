//! The energy of the filtered lattice noise and its derivatives by the footprint.

use mipless_codegen::ir::Float;

/// What the trace and the determinant of Σ/a² say of an octave.
#[derive(Clone, Copy, Debug)]
pub(super) struct Energy<'b> {
    /// 1/D, with D = det(I + Σ/a²).
    pub(super) inverse: Float<'b>,
    /// 1/√D.
    pub(super) root: Float<'b>,
    /// F(Σ)/F(0): the share of the variance that the filter leaves.
    pub(super) left: Float<'b>,
    /// V₁ = −∂_λ F(λΣ) at λ = 1, a share of F(0).
    pub(super) first: Float<'b>,
    /// V₂ = ½ ∂²_λ F(λΣ) at λ = 1, a share of F(0).
    pub(super) second: Float<'b>,
    /// A lower bound of F(0) − F − V₁: (9/4 tr² − 3 det)/D³, which for small Σ is V₂.
    pub(super) least: Float<'b>,
}

impl<'b> Energy<'b> {
    /// With D(λ) = 1 + λ tr + λ² det and m(λ) = 2 + λ tr, F(λΣ)/F(0) is ⅛ (3m²D^{−5/2} − 4D^{−3/2}).
    /// What is 0 in 1 − F is so to within 6e-7 in f32.
    pub(super) fn new(trace: Float<'b>, determinant: Float<'b>) -> Self {
        let inverse = 1.0 / (1.0 + (trace + determinant));
        let root = inverse.sqrt();
        // m²/D.
        let m = trace + 2.0;
        let ratio = m * inverse;
        let square = ratio * m;
        let weight = root * 0.125 * inverse;
        let left = weight * (square * 3.0 + -4.0);

        // ∂F = ⅛ D^{−5/2} Q with Q = 6 m tr + D′ (6 − 7.5 m²/D).
        let weight = weight * inverse;
        let d1 = trace + determinant + determinant;
        let slope = square * -7.5 + 6.0;
        let q = m * trace * 6.0 + d1 * slope;
        let first = -(weight * q);

        // ∂²F = ⅛ D^{−5/2} (Q′ − 2.5 D′Q/D).
        let bend = determinant * slope;
        let moved = ratio * d1;
        let cross = moved * (moved * 7.5 - trace * 15.0);
        let bend = trace.square() * 6.0 + (bend + bend + cross);
        let second = weight * (bend - d1 * inverse * 2.5 * q) * 0.5;

        let cube = inverse.square() * inverse;
        let least = (trace.square() * 2.25 - determinant * 3.0) * cube;
        Self {
            inverse,
            root,
            left,
            first,
            second,
            least,
        }
    }
}
