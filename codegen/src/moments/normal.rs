//! The normal distribution in IR.

use crate::ir::Float;

/// φ(z), P = Φ(z) and Q = Φ(−z) of one z, all from one exponential.
///
/// erf is Abramowitz & Stegun 7.1.26: P and Q are within 5.3e-7 and monotone; the smaller of the
/// two is the tail itself, never 1 minus the other.
#[derive(Clone, Copy, Debug)]
pub struct Normal<'b> {
    /// z, limited to ±12.
    pub z: Float<'b>,
    /// The density at z.
    pub density: Float<'b>,
    /// Φ(z).
    pub below: Float<'b>,
    /// Φ(−z).
    pub above: Float<'b>,
}

impl<'b> Normal<'b> {
    /// At z = (m − t)/σ, given 1/σ.
    pub fn at(distance: Float<'b>, inverse_sd: Float<'b>) -> Self {
        Self::of(distance * inverse_sd)
    }

    /// At z.
    pub fn of(z: Float<'b>) -> Self {
        let z = z.clamp(-12.0, 12.0);
        let bell = (z.square() * -0.5).exp();
        // t = 1/(1 + p|z|/√2), tail = ½ (a₁t + … + a₅t⁵) e^{−z²/2}.
        const P: f32 = 0.327_591_1;
        let t = 1.0 / (z.abs() * (P * std::f32::consts::FRAC_1_SQRT_2) + 1.0);
        let mut sum = z.literal(0.5 * 1.061_405_4);
        for a in [-1.453_152, 1.421_413_7, -0.284_496_74, 0.254_829_6] {
            sum = sum * t + 0.5 * a;
        }
        let tail = sum * t * bell;
        let rest = 1.0 - tail;
        let positive = z.ge(0.0);
        Self {
            z,
            density: bell * 0.398_942_3,
            below: positive.select(rest, tail),
            above: positive.select(tail, rest),
        }
    }

    /// At −z.
    pub fn mirrored(&self) -> Self {
        Self {
            z: -self.z,
            below: self.above,
            above: self.below,
            ..*self
        }
    }

    /// E[max(distance + σZ, 0)] = σ(zΦ(z) + φ(z)), where this is the normal at z = distance/σ.
    pub fn hinge(&self, distance: Float<'b>, sd: Float<'b>) -> Float<'b> {
        let near = sd * (self.z * self.below + self.density).max(0.0);
        // z is limited: far above the kink the hinge is the distance itself.
        self.z.gt(6.0).select(distance, near)
    }

    /// The distortion of a unit hinge: d(z) = (z² + 1)PQ − |z|φ|P − Q| − φ², at least 0.
    pub fn hinge_distortion(&self) -> Float<'b> {
        let Self {
            z,
            density,
            below: p,
            above: q,
        } = *self;
        let d = (z.square() + 1.0) * (p * q) - z.abs() * density * (p - q).abs() - density.square();
        d.max(0.0)
    }
}

/// The probability between two edges, from the tails of the nearer side.
pub(super) fn probability<'b>(from: &Normal<'b>, to: &Normal<'b>) -> Float<'b> {
    let right = (from.z + to.z).gt(0.0);
    let p = right.select(to.above - from.above, from.below - to.below);
    p.max(0.0)
}
