//! How steep patterns are: what the normal of a height needs to know of what a footprint removed.

use crate::noise::field::Spread;
use mipless_codegen::Lower;
use mipless_codegen::ir::Float;
use mipless_codegen::moments::Signal;

/// Reports bricks with bevels, in rows: √(E|∇|²/Var) of faces of `columns` and `rows` a unit of
/// `texcoord`. Each brick has four ramps from 0 to 1, so that E|∂u|² = 2 · columns · rows/bevel and
/// E|∂v|² = 2 · rows²/bevel; of the variance, that of faces whose edges are in the middle of the ramps
/// is taken.
pub(crate) fn report_bricks<'b>(
    lower: &mut Lower<'_, 'b>,
    texcoord: &[Signal<'b>],
    [columns, rows]: [Float<'b>; 2],
    [mortar_x, bevel_x, mortar, bevel]: [Float<'b>; 4],
) {
    if bevel.is_zero() {
        return;
    }
    let [wide, high] = [(mortar_x, bevel_x), (mortar, bevel)]
        .map(|(mortar, bevel)| (1.0 - (mortar + bevel)).max(0.0));
    let face = wide * high;
    let variance = (face * (1.0 - face)).max(1e-3);
    let ramps = (columns + rows) * rows * (2.0 / std::f32::consts::TAU.powi(2));
    let square = ramps / (variance * bevel.max(1e-3));
    let size = Spread::of(texcoord).eigenvalues[0];
    lower.pattern_detail((square * size).sqrt());
}
