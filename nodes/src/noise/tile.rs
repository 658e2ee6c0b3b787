//! Lattices that tile: places, integers as reals, wrapped to a period that goes from octave to octave.

use mipless_codegen::ir::{Builder, Value};

/// `x`, integers up to a few periods away from 0, wrapped to [0, period).
pub(super) fn wrapped(b: &mut Builder, x: Value, period: Value) -> Value {
    // In the middle between two integers the quotient's rounding does not matter.
    let middle = b.offset(x, 0.5);
    let turns = b.div(middle, period);
    let turns = b.floor(turns);
    let whole = b.mul(turns, period);
    b.sub(x, whole)
}

/// The cell (an i32) wrapped to [0, period), as a real.
pub(super) fn wrapped_cell(b: &mut Builder, cell: Value, period: Value) -> Value {
    // The quotient of a far cell is off by some turns; the rest is then small and exact.
    let far = b.float_i(cell);
    let turns = b.div(far, period);
    let turns = b.trunc_i(turns);
    let whole = b.trunc_i(period);
    let whole = b.mul_i(turns, whole);
    let rest = b.sub_i(cell, whole);
    let rest = b.float_i(rest);
    wrapped(b, rest, period)
}
