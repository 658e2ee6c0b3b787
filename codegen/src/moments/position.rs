//! Positions as an integer cell and a fraction, through sums and products with numbers.
//!
//! At a coordinate of 10⁶ one f32 has a step of 0.06; the pair keeps the fraction's 24 bits. Every
//! step is exact or acts on the fraction alone: factors are split into 12-bit halves by masking, so
//! that partial products are exact, and each gives its integer part to the cell. Nothing here
//! depends on an order of evaluation that a shader compiler may change.

use crate::ir::{Builder, SharedFunction, Value};

/// The mean of a position: an integer part, if it is carried, and the rest.
pub(super) type Mean = (Option<Value>, Value);

/// Moves the integer part of `rest` to the cell, so that the rest lies in [0, 1).
fn carry(b: &mut Builder, cell: Value, rest: Value) -> Mean {
    let whole = b.floor(rest);
    let fraction = b.sub(rest, whole);
    let whole = b.trunc_i(whole);
    (Some(b.add_i(cell, whole)), fraction)
}

/// The sum of two positions.
pub(super) fn add(b: &mut Builder, x: Mean, y: Mean) -> Mean {
    let rest = b.add(x.1, y.1);
    match (x.0, y.0) {
        (None, None) => (None, rest),
        (Some(cell), None) | (None, Some(cell)) => carry(b, cell, rest),
        (Some(c), Some(d)) => {
            let cell = b.add_i(c, d);
            carry(b, cell, rest)
        }
    }
}

/// The product of a position and a number. Cells up to 2²³ and factors keep all bits of the
/// fraction of the result; beyond, detail is lost gradually.
pub(super) fn scale(b: &mut Builder, x: Mean, by: Value) -> Mean {
    let (Some(cell), fraction) = x else {
        return (None, b.mul(x.1, by));
    };
    let scaled = b.mul(fraction, by);
    if let Some(constant) = b.as_constant(by)
        && constant.fract() == 0.0
        && constant.abs() < 1e6
    {
        let whole = b.i32(constant as i32);
        let cell = b.mul_i(cell, whole);
        return carry(b, cell, scaled);
    }
    let [cell, fraction] = b.shared(
        SharedFunction {
            name: "scale_position",
            variant: 0,
            doc: "A position times a number: the integer part, and the rest in [0, 1).",
        },
        &[("cell", cell), ("fraction", fraction), ("by", by)],
        |b, v| {
            let (cell, fraction) = scale_any(b, v[0], v[1], v[2]);
            [("cell", cell), ("fraction", fraction)]
        },
    );
    (Some(cell), fraction)
}

/// [`scale`] by a number that is not known.
fn scale_any(b: &mut Builder, cell: Value, fraction: Value, by: Value) -> (Value, Value) {
    let scaled = b.mul(fraction, by);
    let (mask, shift) = (b.i32(0xfff), b.u32(12));
    let (low, high) = (b.and_i(cell, mask), b.shr_i(cell, shift));
    let (low, high) = (b.float_i(low), b.float_i(high));
    let high = b.scale(high, 4096.0);
    let by_high = b.high(by);
    let by_low = b.sub(by, by_high);
    let (mut sum, mut rest) = (b.i32(0), scaled);
    for part in [high, low] {
        for factor in [by_high, by_low] {
            let product = b.mul(part, factor);
            let whole = b.floor(product);
            let fraction = b.sub(product, whole);
            let whole = b.trunc_i(whole);
            sum = b.add_i(sum, whole);
            rest = b.add(rest, fraction);
        }
    }
    let (cell, fraction) = carry(b, sum, rest);
    (cell.expect("a position keeps its cell"), fraction)
}
