//! Lattice cells that repeat.

use mipless_codegen::ir::Int;

/// A cell of [0, period) that stands for `cell` and all cells that whole periods separate from it;
/// a period of 0 repeats nothing.
pub(crate) fn wrapped(cell: Int<'_>, period: i32) -> Int<'_> {
    if period <= 0 {
        return cell;
    }
    let mut rest = cell;
    // Beyond 2²⁴ the first quotient may be off by what its rounding is; the second is exact.
    for _ in 0..2 {
        let turns = ((rest.to_float() + 0.5) * (1.0 / period as f32)).floor();
        rest -= turns.to_int() * period;
    }
    rest
}
