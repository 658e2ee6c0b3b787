//! How steep patterns are: what the normal of a height needs to know of what a footprint removed.

use crate::noise::field::Spread;
use mipless_codegen::Lower;
use mipless_codegen::ir::Value;
use mipless_codegen::moments::Signal;

/// Reports bricks with bevels, in rows: √(E|∇|²/Var) of faces of `columns` and `rows` a unit of
/// `texcoord`. Each brick has four ramps from 0 to 1, so that E|∂u|² = 2 · columns · rows/bevel and
/// E|∂v|² = 2 · rows²/bevel; of the variance, that of faces whose edges are in the middle of the ramps
/// is taken.
pub(crate) fn report_bricks(
    lower: &mut Lower<'_>,
    texcoord: &[Signal],
    [columns, rows]: [Value; 2],
    [mortar_x, bevel_x, mortar, bevel]: [Value; 4],
) {
    let b = lower.b();
    if b.is_zero(bevel) {
        return;
    }
    let spread = Spread::of(b, texcoord);
    let (one, zero, least) = (b.f32(1.0), b.f32(0.0), b.f32(1e-3));
    let [wide, high] = [(mortar_x, bevel_x), (mortar, bevel)].map(|(mortar, bevel)| {
        let lost = b.add(mortar, bevel);
        let left = b.sub(one, lost);
        b.max(left, zero)
    });
    let face = b.mul(wide, high);
    let rest = b.sub(one, face);
    let variance = b.mul(face, rest);
    let variance = b.max(variance, least);
    let narrow = b.max(bevel, least);
    let both = b.add(columns, rows);
    let ramps = b.mul(both, rows);
    let ramps = b.scale(ramps, 2.0 / std::f32::consts::TAU.powi(2));
    let divisor = b.mul(variance, narrow);
    let square = b.div(ramps, divisor);
    let square = b.mul(square, spread.eigenvalues[0]);
    let detail = b.sqrt(square);
    lower.pattern_detail(detail);
}
