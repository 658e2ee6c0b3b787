//! The unfiltered noise: four corners.

use super::Kind;
use super::grid::Grid;
use crate::noise::octave::Octave;
use crate::noise::sum::Octaves;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};

/// The fade of Perlin 2002, 6t⁵ − 15t⁴ + 10t³.
pub(in crate::noise) fn fade(b: &mut Builder, t: Value) -> Value {
    let rest = b.scale(t, 6.0);
    let rest = b.offset(rest, -15.0);
    let rest = b.mul(t, rest);
    let rest = b.offset(rest, 10.0);
    let square = b.square(t);
    let cube = b.mul(square, t);
    b.mul(cube, rest)
}

/// x + share · (y − x).
pub(in crate::noise) fn between(b: &mut Builder, share: Value, [x, y]: [Value; 2]) -> Value {
    let rise = b.sub(y, x);
    let part = b.mul(share, rise);
    b.add(x, part)
}

/// One octave of the unfiltered noise, the body of a fold.
pub(super) fn octave(module: &mut Module, kind: Kind, octaves: Octaves) -> FunctionRef {
    let doc = "One more octave of the unfiltered noise.";
    let mut b = Builder::new(format!("{}_octave", kind.name()), doc);
    b.param("index", Type::U32);
    let sum = b.param_f32("mean");
    let state = Octave::declare(&mut b, octaves);
    let hashes = Grid::of(&state).corners(&mut b);
    let offsets = state.fractions.map(|t| [t, b.offset(t, -1.0)]);
    let mut at = 0;
    let corners = hashes.map(|hash| {
        let offset = [offsets[0][at % 2], offsets[1][at / 2]];
        at += 1;
        let weights = kind.weights(&mut b, hash);
        match kind {
            Kind::Gradient => b.dot(&weights, &offset),
            Kind::Value => weights[0],
        }
    });
    let [x, y] = state.fractions.map(|t| fade(&mut b, t));
    let low = between(&mut b, x, [corners[0], corners[1]]);
    let high = between(&mut b, x, [corners[2], corners[3]]);
    let noise = between(&mut b, y, [low, high]);
    let amplitude = b.scale(state.amplitude, kind.unit());
    let part = b.mul(noise, amplitude);
    let sum = b.add(sum, part);
    b.result("mean", sum);
    state.advance(&mut b, octaves);
    b.finish(module)
}
