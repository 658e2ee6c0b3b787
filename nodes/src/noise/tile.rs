//! Lattices that tile: places, integers as reals, wrapped to a period that goes from octave to octave.

use mipless_codegen::ir::{Float, Int};

/// `x`, integers up to a few periods away from 0, wrapped to [0, period).
pub(super) fn wrapped<'b>(x: Float<'b>, period: Float<'b>) -> Float<'b> {
    // In the middle between two integers the quotient's rounding does not matter.
    x - ((x + 0.5) / period).floor() * period
}

/// The cell wrapped to [0, period), as a real.
pub(super) fn wrapped_cell<'b>(cell: Int<'b>, period: Float<'b>) -> Float<'b> {
    // The quotient of a far cell is off by some turns; the rest is then small and exact.
    let turns = (cell.to_float() / period).to_int();
    wrapped((cell - turns * period.to_int()).to_float(), period)
}
