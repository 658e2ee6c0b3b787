//! The inverse trigonometric functions, in the ops that every device has.

use std::f32::consts::{FRAC_PI_2, PI};

use mipless_codegen::ir::{Builder, Value};

/// Coefficients of arctan(t)/t in t², within 2e-8 on [0, 1] (Abramowitz & Stegun 4.4.49).
const ODD: [f32; 9] = [
    1.0,
    -0.333_331_45,
    0.199_935_51,
    -0.142_088_99,
    0.106_562_64,
    -0.075_289_64,
    0.042_909_614,
    -0.016_165_737,
    0.002_866_225_7,
];

/// arctan(t) for t in [0, 1].
fn octant(b: &mut Builder, t: Value) -> Value {
    let square = b.square(t);
    let mut sum = b.f32(ODD[8]);
    for c in ODD[..8].iter().rev() {
        sum = b.mul(sum, square);
        sum = b.offset(sum, *c);
    }
    b.mul(sum, t)
}

/// The angle of the point (x, y), from −π to π; 0 at the origin.
pub(crate) fn angle(b: &mut Builder, y: Value, x: Value) -> Value {
    let (across, up) = (b.abs(x), b.abs(y));
    let (short, long) = (b.min(across, up), b.max(across, up));
    let least = b.f32(1e-30);
    let long = b.max(long, least);
    let ratio = b.div(short, long);
    let acute = octant(b, ratio);
    let complement = b.f32(FRAC_PI_2);
    let complement = b.sub(complement, acute);
    let steep = b.lt(across, up);
    let first = b.select(steep, complement, acute);
    let zero = b.f32(0.0);
    let half = b.f32(PI);
    let second = b.sub(half, first);
    let left = b.lt(x, zero);
    let upper = b.select(left, second, first);
    let lower = b.neg(upper);
    let below = b.lt(y, zero);
    b.select(below, lower, upper)
}

/// arctan(x).
pub(crate) fn tangent(b: &mut Builder, x: Value) -> Value {
    let one = b.f32(1.0);
    angle(b, x, one)
}

/// x limited to [−1, 1], and √(1 − x²).
fn unit(b: &mut Builder, x: Value) -> (Value, Value) {
    let x = b.clamp(x, -1.0, 1.0);
    let one = b.f32(1.0);
    let (less, more) = (b.sub(one, x), b.add(one, x));
    let product = b.mul(less, more);
    (x, b.sqrt(product))
}

/// arcsin(x) of x limited to [−1, 1].
pub(crate) fn sine(b: &mut Builder, x: Value) -> Value {
    let (x, rest) = unit(b, x);
    angle(b, x, rest)
}

/// arccos(x) of x limited to [−1, 1].
pub(crate) fn cosine(b: &mut Builder, x: Value) -> Value {
    let (x, rest) = unit(b, x);
    angle(b, rest, x)
}
