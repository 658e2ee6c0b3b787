//! Where a noise on a lattice is evaluated: a place and the footprint there, as arguments of its function.

use crate::noise::field::{Field, Spread};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Float, FunctionRef, Int, Scalars, Sym2, Vec2};
use mipless_codegen::moments::Signal;
use std::array;

/// The results of a function at a position, with the footprint after `others` where the mode filters.
pub(crate) fn called<'b>(
    lower: &Lower<'_, 'b>,
    function: &FunctionRef,
    (position, spread): (&[Signal<'b>], &Spread<'b>),
    others: impl Scalars<'b>,
) -> Vec<Float<'b>> {
    let places: Vec<(Int<'b>, Float<'b>)> = position.iter().map(Signal::place).collect();
    let footprint = (lower.mode().filters()).then_some((spread.covariance, spread.eigenvalues));
    lower.b().call(function, (places, others, footprint))
}

/// The parameters of a place: its cells and its fractions.
pub(crate) fn declared<const AXES: usize>(b: &Builder) -> ([Int<'_>; AXES], [Float<'_>; AXES]) {
    let axes: [(Int<'_>, Float<'_>); AXES] = array::from_fn(|axis| {
        let name = ["x", "y", "z"][axis];
        (b.int_param(format!("cell_{name}")), b.float_param(name))
    });
    (
        axes.map(|(cell, _)| cell),
        axes.map(|(_, fraction)| fraction),
    )
}

/// The parameters of a footprint.
pub(crate) fn declared_spread(b: &Builder) -> Spread<'_> {
    Spread {
        covariance: Sym2(b.float_params(["s_xx", "s_xy", "s_yy"])),
        eigenvalues: b.float_params(["s_major", "s_minor"]),
    }
}

/// The field of a mean, a gradient and a Hessian, of which what is missing is 0.
pub(crate) fn field<'b>(parts: &[Float<'b>], rest: Option<Float<'b>>) -> Field<'b> {
    let zero = parts[0].literal(0.0);
    let at = |i: usize| parts.get(i).copied().unwrap_or(zero);
    Field {
        mean: at(0),
        gradient: Vec2([1, 2].map(at)),
        hessian: Sym2([3, 4, 5].map(at)),
        rest: rest.unwrap_or(zero),
    }
}

/// The cell that a window of `count` cells around `x` starts at: cells are taken for their centres.
pub(crate) fn window_start<'b>(x: Float<'b>, count: Float<'b>) -> Float<'b> {
    (x + count * -0.5 + 0.5).floor()
}
