//! Positions as an integer cell and a fraction, through sums and products with numbers.
//!
//! At a coordinate of 10⁶ one f32 has a step of 0.06; the pair keeps the fraction's 24 bits. Every
//! step is exact or acts on the fraction alone: factors are split into 12-bit halves by masking, so
//! that partial products are exact, and each gives its integer part to the cell. Nothing here
//! depends on an order of evaluation that a shader compiler may change.

use crate::ir::{Float, Int, SharedFunction};

/// The mean of a position: an integer part, if it is carried, and the rest.
pub(super) type Mean<'b> = (Option<Int<'b>>, Float<'b>);

/// A number as its integer part and the rest in [0, 1).
fn whole<'b>(number: Float<'b>) -> (Int<'b>, Float<'b>) {
    let whole = number.floor();
    (whole.to_int(), number - whole)
}

/// Moves the integer part of `rest` to the cell, so that the rest lies in [0, 1).
fn carry<'b>(cell: Int<'b>, rest: Float<'b>) -> (Int<'b>, Float<'b>) {
    let (carried, fraction) = whole(rest);
    (cell + carried, fraction)
}

/// The sum of two positions.
pub(super) fn add<'b>(x: Mean<'b>, y: Mean<'b>) -> Mean<'b> {
    let rest = x.1 + y.1;
    let cell = match (x.0, y.0) {
        (None, None) => return (None, rest),
        (Some(cell), None) | (None, Some(cell)) => cell,
        (Some(c), Some(d)) => c + d,
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
            carry(cell * constant as i32, fraction * by)
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

/// [`scale`] by a number that is not known.
fn scale_any<'b>(cell: Int<'b>, fraction: Float<'b>, by: Float<'b>) -> (Int<'b>, Float<'b>) {
    let (low, high) = ((cell & 0xfff).to_float(), (cell >> 12).to_float() * 4096.0);
    let by_high = by.high();
    let by_low = by - by_high;
    let (mut sum, mut rest) = (cell.literal(0), fraction * by);
    for part in [high, low] {
        for factor in [by_high, by_low] {
            let (whole, fraction) = whole(part * factor);
            sum += whole;
            rest += fraction;
        }
    }
    carry(sum, rest)
}
