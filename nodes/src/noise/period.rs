//! Lattice cells that repeat.

use mipless_codegen::ir::{Builder, Value};

/// A cell of [0, period) that stands for `cell` and all cells that whole periods separate from it;
/// a period of 0 repeats nothing.
pub(crate) fn wrapped(b: &mut Builder, cell: Value, period: i32) -> Value {
    if period <= 0 {
        return cell;
    }
    let length = b.i32(period);
    let mut rest = cell;
    // Beyond 2²⁴ the first quotient may be off by what its rounding is; the second is exact.
    for _ in 0..2 {
        let number = b.float_i(rest);
        let number = b.offset(number, 0.5);
        let turns = b.scale(number, 1.0 / period as f32);
        let turns = b.floor(turns);
        let turns = b.trunc_i(turns);
        let whole = b.mul_i(turns, length);
        rest = b.sub_i(rest, whole);
    }
    rest
}
