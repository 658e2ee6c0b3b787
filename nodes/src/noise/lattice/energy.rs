//! The energy of the filtered lattice noise and its derivatives by the footprint.

use mipless_codegen::ir::{Builder, Value};

/// What the trace and the determinant of Σ/a² say of an octave.
#[derive(Clone, Copy, Debug)]
pub(super) struct Energy {
    /// 1/D, with D = det(I + Σ/a²).
    pub(super) inverse: Value,
    /// 1/√D.
    pub(super) root: Value,
    /// F(Σ)/F(0): the share of the variance that the filter leaves.
    pub(super) left: Value,
    /// V₁ = −∂_λ F(λΣ) at λ = 1, a share of F(0).
    pub(super) first: Value,
    /// V₂ = ½ ∂²_λ F(λΣ) at λ = 1, a share of F(0).
    pub(super) second: Value,
    /// A lower bound of F(0) − F − V₁: (9/4 tr² − 3 det)/D³, which for small Σ is V₂.
    pub(super) least: Value,
}

impl Energy {
    /// With D(λ) = 1 + λ tr + λ² det and m(λ) = 2 + λ tr, F(λΣ)/F(0) is ⅛ (3m²D^{−5/2} − 4D^{−3/2}).
    /// What is 0 in 1 − F is so to within 6e-7 in f32.
    pub(super) fn new(b: &mut Builder, trace: Value, determinant: Value) -> Self {
        let one = b.f32(1.0);
        let d = b.add(trace, determinant);
        let d = b.add(one, d);
        let inverse = b.div(one, d);
        let root = b.sqrt(inverse);
        // m²/D.
        let m = b.offset(trace, 2.0);
        let ratio = b.mul(m, inverse);
        let square = b.mul(ratio, m);
        let eighth = b.scale(root, 0.125);
        let weight = b.mul(eighth, inverse);
        let left = b.scale(square, 3.0);
        let left = b.offset(left, -4.0);
        let left = b.mul(weight, left);
        // ∂F = ⅛ D^{−5/2} Q with Q = 6 m tr + D′ (6 − 7.5 m²/D).
        let weight = b.mul(weight, inverse);
        let d1 = b.add(trace, determinant);
        let d1 = b.add(d1, determinant);
        let slope = b.scale(square, -7.5);
        let slope = b.offset(slope, 6.0);
        let product = b.mul(m, trace);
        let product = b.scale(product, 6.0);
        let q = b.mul(d1, slope);
        let q = b.add(product, q);
        let first = b.mul(weight, q);
        let first = b.neg(first);
        // ∂²F = ⅛ D^{−5/2} (Q′ − 2.5 D′Q/D).
        let trace2 = b.square(trace);
        let trace2 = b.scale(trace2, 6.0);
        let bend = b.mul(determinant, slope);
        let bend = b.add(bend, bend);
        let moved = b.mul(ratio, d1);
        let cross = b.scale(moved, 7.5);
        let drop = b.scale(trace, 15.0);
        let cross = b.sub(cross, drop);
        let cross = b.mul(moved, cross);
        let bend = b.add(bend, cross);
        let bend = b.add(trace2, bend);
        let share = b.mul(d1, inverse);
        let share = b.scale(share, 2.5);
        let drop = b.mul(share, q);
        let bend = b.sub(bend, drop);
        let second = b.mul(weight, bend);
        let second = b.scale(second, 0.5);
        let cube = b.square(inverse);
        let cube = b.mul(cube, inverse);
        let square = b.square(trace);
        let square = b.scale(square, 2.25);
        let steep = b.scale(determinant, 3.0);
        let least = b.sub(square, steep);
        let least = b.mul(least, cube);
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
