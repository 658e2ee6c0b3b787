//! Positions as an integer cell and a fraction, through sums and products with numbers.
//!
//! At a coordinate of 10⁶ one f32 has a step of 0.06; the pair keeps the fraction's 24 bits. Every
//! step is exact or acts on the fraction alone: factors are split into 12-bit halves by masking, so
//! that partial products are exact, and each gives its integer part to the cell. Nothing here
//! depends on an order of evaluation that a shader compiler may change.

use crate::ir::{Float, Int, SharedFunction};

/// The mean of a position: an integer part, if it is carried, and the rest.
pub(super) type Mean<'b> = (Option<Int<'b>>, Float<'b>);

/// The magnitude from which on a position is one number, with a cell of 0: an integer could not hold
/// what becomes of it, and the number has no fraction that would be lost.
const FARTHEST: f32 = (1u32 << 30) as f32;

/// The largest magnitude of a position.
const LARGEST: f32 = 1e38;

/// A number nearer to 0 is no cell's: from a cell of −1 its rest would be rounded to 1.
const NEAREST: f32 = 1.0 / (1u32 << 25) as f32;

/// A number as its integer part and the rest in [0, 1); as 0 and itself below [`NEAREST`] and from
/// [`FARTHEST`] on.
fn whole<'b>(number: Float<'b>) -> (Int<'b>, Float<'b>) {
    let magnitude = number.abs();
    let splits = magnitude.ge(NEAREST) & magnitude.lt(FARTHEST);
    let whole = splits.select(number.floor(), 0.0);
    (whole.to_int(), number - whole)
}

/// A number as its integer part and the rest in [0, 1], whatever its magnitude.
pub(super) fn split<'b>(number: Float<'b>) -> (Int<'b>, Float<'b>) {
    let whole = number.floor();
    (whole.to_int(), number - whole)
}

/// Moves the integer part of `rest` to the cell, so that the rest lies in [0, 1).
fn carry<'b>(cell: Int<'b>, rest: Float<'b>) -> (Int<'b>, Float<'b>) {
    let (carried, fraction) = whole(rest);
    (cell + carried, fraction)
}

/// A cell and a fraction that stand for `value`, or that value itself where an integer cannot hold it.
fn near_or_flat<'b>(
    (cell, fraction): (Int<'b>, Float<'b>),
    value: Float<'b>,
) -> (Int<'b>, Float<'b>) {
    let near = value.abs().lt(FARTHEST);
    let flat = value.clamp(-LARGEST, LARGEST);
    (near.select(cell, 0), near.select(fraction, flat))
}

/// The sum of two positions.
pub(super) fn add<'b>(x: Mean<'b>, y: Mean<'b>) -> Mean<'b> {
    let rest = x.1 + y.1;
    let cell = match (x.0, y.0) {
        (None, None) => return (None, rest),
        (Some(cell), None) | (None, Some(cell)) => cell,
        (Some(c), Some(d)) => {
            let sum = carry(c + d, rest);
            let (cell, fraction) = near_or_flat(sum, c.to_float() + d.to_float() + rest);
            return (Some(cell), fraction);
        }
    };
    let (cell, fraction) = carry(cell, rest);
    (Some(cell), fraction)
}

/// The product of a position and a number. Cells up to 2²³ and factors keep all bits of the
/// fraction of the result; beyond, detail is lost gradually.
pub(super) fn scale<'b>((cell, fraction): Mean<'b>, by: Float<'b>) -> Mean<'b> {
    let Some(cell) = cell else {
        return (None, fraction * by);
    };
    let (cell, fraction) = match by.as_constant() {
        Some(constant) if constant.fract() == 0.0 && constant.abs() < 1e6 => {
            let product = carry(cell * constant as i32, fraction * by);
            near_or_flat(product, (cell.to_float() + fraction) * by)
        }
        _ => {
            let of = SharedFunction {
                name: "scale_position",
                variant: 0,
                doc: "A position times a number: the integer part, and the rest in [0, 1).",
            };
            let arguments = [
                ("cell", cell.into()),
                ("fraction", fraction.into()),
                ("by", by.into()),
            ];
            let [cell, fraction] = by.builder().shared_scalars(of, &arguments, |_, v| {
                let (cell, fraction) = scale_any(v[0].int(), v[1].float(), v[2].float());
                [("cell", cell.into()), ("fraction", fraction.into())]
            });
            (cell.int(), fraction.float())
        }
    };
    (Some(cell), fraction)
}

/// A position over a number that is known: times the number's inverse to twice the digits of an f32.
pub(super) fn divide<'b>(position: Mean<'b>, by: f32) -> Mean<'b> {
    let inverse = 1.0 / f64::from(by);
    let high = inverse as f32;
    let low = (inverse - f64::from(high)) as f32;
    let quotient = scale(position, position.1.literal(high));
    match position.0 {
        Some(cell) if low != 0.0 => add(quotient, (None, (cell.to_float() + position.1) * low)),
        _ => quotient,
    }
}

/// A position modulo `period`, in [0, period).
///
/// The period is the f32 that it is, 2π too: sin(2πu), whose factor is that f32, then has a period of
/// exactly 1 in u, wherever u is.
pub(super) fn modulo<'b>((cell, fraction): Mean<'b>, period: f32) -> Float<'b> {
    divide((cell, fraction), period).1 * period
}

/// [`scale`] by a number that is not known.
fn scale_any<'b>(cell: Int<'b>, fraction: Float<'b>, by: Float<'b>) -> (Int<'b>, Float<'b>) {
    // The nearest multiple of 2¹² and what is left, so that no part is farther from 0 than twice the
    // cell: the parts of the product then fit where it does.
    let high = ((cell + 0x800) >> 12).to_float() * 4096.0;
    let low = (((cell + 0x800) & 0xfff) + -0x800).to_float();
    let by_high = by.high();
    let by_low = by - by_high;
    let (mut sum, mut rest) = (cell.literal(0), fraction * by);
    for part in [high, low] {
        for factor in [by_high, by_low] {
            // The nearest integer: what is left of a small product is its own digits.
            let product = part * factor;
            let nearest = (product + 0.5).floor();
            sum += nearest.to_int();
            rest += product - nearest;
        }
    }
    near_or_flat(carry(sum, rest), (cell.to_float() + fraction) * by)
}
