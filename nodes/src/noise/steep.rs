//! The slopes of noises: what a filter removed of them, from the spectrum, and the signals that they are.
//!
//! Of a noise with the power spectrum P, filtered by a footprint of covariance Σ, with q = wᵀΣw: the
//! slopes of the filtered field have E[∇M ∇Mᵀ] = ∫ P wwᵀ e^{−q}, their response to the place within the
//! footprint has E[H Σ H] = ∫ P wwᵀ q e^{−q}, and beyond both is left
//!
//! ```text
//! R(Σ) = ∫ P w wᵀ (1 − e^{−q} (1 + q)),
//! ```
//!
//! a mean over the ensemble, as the variance that a filter removed is (Bruneton & Neyret 2012 §2.2 for
//! slopes; Hermite–Parseval). Slopes are not correlated with the value of a stationary noise.

use super::field::{Field, Spread};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Float, Sym2};
use mipless_codegen::moments::{Mode, Signal};

/// A part of an isotropic spectrum, |w|^{2·order} e^{−area·|w|²}.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Band {
    /// 0, 1 or 2.
    pub(crate) order: u32,
    /// In squared cells.
    pub(crate) area: f32,
    /// Its variance.
    pub(crate) variance: f32,
}

impl Band {
    /// q(n₁, n₂) and Σ ∂q/∂n n(1 − n), with which the first eigenvalue of E[∇M ∇Mᵀ] is
    /// σ²/(2a²) √(n₁n₂) n₁ q, n = a²/(a² + s): −½∂F/∂Σ of the energy F = √(n₁n₂) (n₁ + n₂)/2 and so on.
    fn factor<'b>(self, [n1, n2]: [Float<'b>; 2]) -> [Float<'b>; 2] {
        let [m1, m2] = [n1, n2].map(|n| n * (1.0 - n));
        match self.order {
            0 => [n1.literal(1.0), n1.literal(0.0)],
            1 => [1.5 * n1 + 0.5 * n2, 1.5 * m1 + 0.5 * m2],
            _ => [
                1.875 * n1.square() + 0.75 * (n1 * n2) + 0.375 * n2.square(),
                3.75 * (n1 * m1) + 0.75 * (m1 * n2 + n1 * m2) + 0.75 * (n2 * m2),
            ],
        }
    }

    /// What R has in the direction of the first eigenvalue.
    fn removed<'b>(self, [s1, s2]: [Float<'b>; 2]) -> Float<'b> {
        let by = 1.0 / self.area;
        let [x1, x2] = [s1, s2].map(|s| s * by);
        let [n1, n2] = [x1, x2].map(|x| 1.0 / (1.0 + x));
        let [q, moved] = self.factor([n1, n2]);
        let root = (n1 * n2).sqrt() * n1;
        let left = root * q;
        let response = left * (1.5 * (1.0 - n1) + 0.5 * (1.0 - n2)) + root * moved;
        let whole = [1.0, 2.0, 3.0][self.order as usize];
        let exact = (whole - left - response).max(0.0);

        // ½E[w₁² q²], which small footprints need: of the difference above they leave roundings.
        let sixth = [6.0, 24.0, 60.0][self.order as usize];
        let least = 5.0 * x1.square() + 2.0 * (x1 * x2) + x2.square();
        let least = (sixth / 16.0) * least;
        let narrow = (x1 + x2).lt(0.004);
        narrow.select(least, exact) * (0.5 * self.variance * by)
    }
}

/// R(Σ) of a sum of bands, in the units of the footprint.
pub(crate) fn of_bands<'b>(
    lower: &mut Lower<'_, 'b>,
    spread: &Spread<'b>,
    bands: &[Band],
) -> Sym2<'b> {
    let key = format!("steepness {bands:?}");
    let function = lower.function(&key, |module| {
        let b = &Builder::new(
            "steepness",
            "The slopes that a footprint removes from a noise.",
        );
        let covariance = Sym2(b.float_params(["s_xx", "s_xy", "s_yy"]));
        let [major, minor] = b.float_params(["s_major", "s_minor"]);
        let zero = b.float(0.0);
        let [mut along, mut across] = [zero; 2];
        for band in bands {
            along += band.removed([major, minor]);
            across += band.removed([minor, major]);
        }
        let rest = turned(covariance, [major, minor], [along, across]);
        b.results(["uu", "uv", "vv"], rest);
        b.finish(module)
    });
    let results = lower
        .b()
        .call(&function, (spread.covariance, spread.eigenvalues));
    Sym2([results[0], results[1], results[2]])
}

/// The matrix with these eigenvalues in the directions of the eigenvalues of Σ.
fn turned<'b>(
    covariance: Sym2<'b>,
    [major, minor]: [Float<'b>; 2],
    [along, across]: [Float<'b>; 2],
) -> Sym2<'b> {
    let gap = major - minor;
    // Of a round footprint both are equal but for rounding, in whatever direction.
    let tells = gap.gt(1e-5 * major + 1e-30);
    let by = tells.select((along - across) / tells.select(gap, 1.0), 0.0);
    let [xx, xy, yy] = covariance.0;
    Sym2([
        across + by * (xx - minor).max(0.0),
        by * xy,
        across + by * (yy - minor).max(0.0),
    ])
}

impl<'b> Field<'b> {
    /// [`Self::at`], with slopes where they are asked for: of the field's gradient, its Hessian as the
    /// response to the position, and `rest` beyond both, by the chain rule.
    pub(crate) fn steep(
        &self,
        lower: &mut Lower<'_, 'b>,
        position: &[Signal<'b>],
        rest: impl FnOnce(&mut Lower<'_, 'b>) -> Sym2<'b>,
    ) -> Signal<'b> {
        let signal = self.at(lower, position);
        if !lower.derives() {
            return signal;
        }
        let plain: Vec<Signal<'b>> = (position.iter())
            .map(|axis| axis.flat().with_slope(None))
            .collect();
        let [h11, h12, h22] = *self.hessian;
        let mut gradient = [[h11, h12], [h12, h22]].map(|[x, y]| &plain[0] * x + &plain[1] * y);
        for (along, mean) in gradient.iter_mut().zip(self.gradient) {
            along.mean = mean;
            along.range = [f32::NEG_INFINITY, f32::INFINITY];
        }
        if lower.mode() == Mode::Quad {
            let rest = rest(lower);
            lower.algebra.attach_joint(&mut gradient, &*rest);
        }
        let slope = lower.algebra.chained(&gradient, position);
        signal.with_slope(slope)
    }
}
