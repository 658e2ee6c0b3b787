//! The normal distribution in IR.

use crate::ir::{Builder, Value};

/// φ(z), P = Φ(z) and Q = Φ(−z) of one z, all from one exponential.
///
/// erf is Abramowitz & Stegun 7.1.26: P and Q are within 5.3e-7 and monotone; the smaller of the
/// two is the tail itself, never 1 minus the other.
#[derive(Clone, Copy, Debug)]
pub struct Normal {
    /// z, limited to ±12.
    pub z: Value,
    /// The density at z.
    pub density: Value,
    /// Φ(z).
    pub below: Value,
    /// Φ(−z).
    pub above: Value,
}

impl Normal {
    /// At z = (m − t)/σ, given 1/σ.
    pub fn at(b: &mut Builder, distance: Value, inverse_sd: Value) -> Self {
        let z = b.mul(distance, inverse_sd);
        Self::of(b, z)
    }

    /// At z.
    pub fn of(b: &mut Builder, z: Value) -> Self {
        let z = b.clamp(z, -12.0, 12.0);
        let square = b.square(z);
        let exponent = b.scale(square, -0.5);
        let bell = b.exp(exponent);
        let density = b.scale(bell, 0.398_942_3);
        // t = 1/(1 + p|z|/√2), tail = ½ (a₁t + … + a₅t⁵) e^{−z²/2}.
        let magnitude = b.abs(z);
        let d = b.scale(magnitude, 0.327_591_1 * std::f32::consts::FRAC_1_SQRT_2);
        let d = b.offset(d, 1.0);
        let one = b.f32(1.0);
        let t = b.div(one, d);
        let mut sum = b.f32(0.5 * 1.061_405_4);
        for a in [-1.453_152, 1.421_413_7, -0.284_496_74, 0.254_829_6] {
            sum = b.mul(sum, t);
            sum = b.offset(sum, 0.5 * a);
        }
        let sum = b.mul(sum, t);
        let tail = b.mul(sum, bell);
        let rest = b.sub(one, tail);
        let zero = b.f32(0.0);
        let positive = b.le(zero, z);
        Self {
            z,
            density,
            below: b.select(positive, rest, tail),
            above: b.select(positive, tail, rest),
        }
    }

    /// E[max(distance + σZ, 0)] = σ(zΦ(z) + φ(z)), where this is the normal at z = distance/σ.
    pub fn hinge(&self, b: &mut Builder, distance: Value, sd: Value) -> Value {
        let product = b.mul(self.z, self.below);
        let sum = b.add(product, self.density);
        let zero = b.f32(0.0);
        let sum = b.max(sum, zero);
        let near = b.mul(sd, sum);
        // z is limited: far above the kink the hinge is the distance itself.
        let far = b.f32(6.0);
        let above = b.lt(far, self.z);
        b.select(above, distance, near)
    }

    /// The distortion of a unit hinge: d(z) = (z² + 1)PQ − |z|φ|P − Q| − φ², at least 0.
    pub fn hinge_distortion(&self, b: &mut Builder) -> Value {
        let square = b.square(self.z);
        let square = b.offset(square, 1.0);
        let pq = b.mul(self.below, self.above);
        let first = b.mul(square, pq);
        let magnitude = b.abs(self.z);
        let difference = b.sub(self.below, self.above);
        let difference = b.abs(difference);
        let bell = b.mul(magnitude, self.density);
        let second = b.mul(bell, difference);
        let third = b.square(self.density);
        let d = b.sub(first, second);
        let d = b.sub(d, third);
        let zero = b.f32(0.0);
        b.max(d, zero)
    }
}
