//! A periodic pulse: 1 around every period's centre, 0 elsewhere, with edges that may be ramps.

use mipless_codegen::ir::{Builder, Value};
use mipless_codegen::moments::Normal;

/// A pulse in each of `repeat` equal parts of the unit interval, which itself repeats.
///
/// `half` and `bevel` are in parts: 0.5 is half the distance from a pulse to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pulse {
    /// How many there are in the unit interval, at least 1.
    pub(crate) repeat: f32,
    /// The centre of one, in the units of the part.
    pub(crate) centre: Value,
    /// From the centre to the middle of an edge, in [0, 0.5].
    pub(crate) half: Value,
    /// The width of an edge's ramp, at least 0.
    pub(crate) bevel: Value,
}

/// A coordinate within a footprint: a Gaussian.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axis {
    /// The mean.
    pub(crate) mean: Value,
    /// The standard deviation, at least 1e-6.
    pub(crate) sd: Value,
}

/// Where the two series meet, in parts.
const CROSSOVER: f32 = 0.2;

/// A live ramp is at least this wide, and at least 0.02 σ: its hinges then keep their digits.
const NARROWEST: f32 = 1e-4;

impl Pulse {
    /// The signed distance from the nearest centre, in [−½, ½], and its magnitude.
    fn folded(&self, b: &mut Builder, x: Value) -> [Value; 2] {
        let scaled = b.scale(x, self.repeat);
        let from = b.sub(scaled, self.centre);
        let rounded = b.offset(from, 0.5);
        let rounded = b.floor(rounded);
        let signed = b.sub(from, rounded);
        [signed, b.abs(signed)]
    }

    /// The value at x.
    pub(crate) fn value(&self, b: &mut Builder, x: Value) -> Value {
        let [_, distance] = self.folded(b, x);
        let inside = b.sub(self.half, distance);
        let zero = b.f32(0.0);
        if b.is_zero(self.bevel) {
            let (on, one) = (b.lt(zero, inside), b.f32(1.0));
            return b.select(on, one, zero);
        }
        let narrowest = b.f32(NARROWEST);
        let bevel = b.max(self.bevel, narrowest);
        let share = b.div(inside, bevel);
        let share = b.offset(share, 0.5);
        b.clamp(share, 0.0, 1.0)
    }

    /// The mean over a Gaussian, and its first and second derivative by the coordinate's mean: edges
    /// one by one up to σ = 0.2 parts (those left out are beyond 5 σ), three damped harmonics beyond
    /// (those left out are below 1e-6).
    pub(crate) fn moments(&self, b: &mut Builder, axis: Axis) -> [Value; 3] {
        let [signed, distance] = self.folded(b, axis.mean);
        let sd = b.scale(axis.sd, self.repeat);
        let near = self.edges(b, distance, sd);
        let far = self.harmonics(b, distance, sd);
        let crossover = b.f32(CROSSOVER);
        let narrow = b.lt(sd, crossover);
        let mut out = [0, 1, 2].map(|i| b.select(narrow, near[i], far[i]));
        out[0] = b.clamp(out[0], 0.0, 1.0);
        // The distance is the coordinate or its negative.
        let zero = b.f32(0.0);
        let left = b.lt(signed, zero);
        let negative = b.neg(out[1]);
        out[1] = b.select(left, negative, out[1]);
        out[1] = b.scale(out[1], self.repeat);
        out[2] = b.scale(out[2], self.repeat * self.repeat);
        out
    }

    /// The edges at −1 + h, −h, h, 1 − h and 1 + h, seen from a distance in [0, ½]. The rising edge
    /// at −1 − h is the 1 that the sum starts from.
    fn edges(&self, b: &mut Builder, distance: Value, sd: Value) -> [Value; 3] {
        let one = b.f32(1.0);
        let inverse = b.div(one, sd);
        let (below, above) = (b.sub(distance, self.half), b.add(distance, self.half));
        let mut out = [one, b.f32(0.0), b.f32(0.0)];
        for (from, shift, rises) in [
            (below, 1.0, false),
            (above, 0.0, true),
            (below, 0.0, false),
            (above, -1.0, true),
            (below, -1.0, false),
        ] {
            let from = b.offset(from, shift);
            let edge = self.edge(b, from, sd, inverse);
            for (sum, part) in out.iter_mut().zip(edge) {
                *sum = if rises {
                    b.add(*sum, part)
                } else {
                    b.sub(*sum, part)
                };
            }
        }
        out
    }

    /// A rising edge at a distance: its mean and derivatives.
    fn edge(&self, b: &mut Builder, from: Value, sd: Value, inverse: Value) -> [Value; 3] {
        if b.is_zero(self.bevel) {
            let n = Normal::at(b, from, inverse);
            let density = b.mul(n.density, inverse);
            let curved = b.mul(n.z, density);
            let curved = b.mul(curved, inverse);
            return [n.below, density, b.neg(curved)];
        }
        // (E[max(x + w/2, 0)] − E[max(x − w/2, 0)])/w.
        let narrowest = b.f32(NARROWEST);
        let least = b.scale(sd, 0.02);
        let width = b.max(self.bevel, narrowest);
        let width = b.max(width, least);
        let half = b.scale(width, 0.5);
        let one = b.f32(1.0);
        let inverse_width = b.div(one, width);
        let (start, end) = (b.add(from, half), b.sub(from, half));
        let (n, m) = (Normal::at(b, start, inverse), Normal::at(b, end, inverse));
        let (up, down) = (n.hinge(b, start, sd), m.hinge(b, end, sd));
        let mean = b.sub(up, down);
        let mean = b.mul(mean, inverse_width);
        // Beyond the ramp two large hinges differ by its width, less their roundings.
        let far = b.f32(6.0);
        let passed = b.lt(far, m.z);
        let mean = b.select(passed, one, mean);
        let slope = b.sub(n.below, m.below);
        let slope = b.mul(slope, inverse_width);
        let curved = b.sub(n.density, m.density);
        let curved = b.mul(curved, inverse);
        [mean, slope, b.mul(curved, inverse_width)]
    }

    /// 2h + Σ 2/(πk) sin(2πkh) sinc(kw) e^{−2π²k²σ²} cos(2πkx).
    fn harmonics(&self, b: &mut Builder, distance: Value, sd: Value) -> [Value; 3] {
        use std::f32::consts::{PI, TAU};
        let width = b.add(self.half, self.half);
        let variance = b.square(sd);
        let limit = b.f32(4.0);
        let variance = b.min(variance, limit);
        let exponent = b.scale(variance, -2.0 * PI * PI);
        let first = b.exp(exponent);
        let second = b.square(first);
        let second = b.square(second);
        let third = b.square(second);
        let third = b.mul(third, first);
        let angle = b.scale(distance, TAU);
        let (s1, c1) = (b.sin(angle), b.cos(angle));
        // Double and triple angles.
        let twice = b.add(c1, c1);
        let (s2, c2) = (b.mul(twice, s1), b.mul(twice, c1));
        let c2 = b.offset(c2, -1.0);
        let (s3, c3) = (b.mul(twice, s2), b.mul(twice, c2));
        let (s3, c3) = (b.sub(s3, s1), b.sub(c3, c1));
        let zero = b.f32(0.0);
        let mut out = [width, zero, zero];
        for (k, damping, sine, cosine) in [
            (1.0, first, s1, c1),
            (2.0, second, s2, c2),
            (3.0, third, s3, c3),
        ] {
            let turn = b.scale(width, PI * k);
            let mut amplitude = b.sin(turn);
            if !b.is_zero(self.bevel) {
                let least = b.f32(NARROWEST);
                let half_turn = b.max(self.bevel, least);
                let half_turn = b.scale(half_turn, PI * k);
                let sinc = b.sin(half_turn);
                let sinc = b.div(sinc, half_turn);
                amplitude = b.mul(amplitude, sinc);
            }
            let amplitude = b.mul(amplitude, damping);
            let amplitude = b.scale(amplitude, 2.0 / (PI * k));
            let w = TAU * k;
            for (sum, (trig, factor)) in
                out.iter_mut()
                    .zip([(cosine, 1.0), (sine, -w), (cosine, -w * w)])
            {
                let part = b.mul(amplitude, trig);
                let part = b.scale(part, factor);
                *sum = b.add(*sum, part);
            }
        }
        out
    }
}
