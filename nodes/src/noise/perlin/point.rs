//! The unfiltered noise: four corners.

use super::Kind;
use super::grid::Grid;
use crate::noise::sum::Octave;
use crate::noise::sum::Octaves;
use mipless_codegen::ir::{Builder, Float, FunctionRef, Module, dot};

/// The fade of Perlin 2002, 6t⁵ − 15t⁴ + 10t³.
pub(in crate::noise) fn fade(t: Float<'_>) -> Float<'_> {
    t.square() * t * (t * (t * 6.0 + -15.0) + 10.0)
}

/// x + share · (y − x).
pub(in crate::noise) fn between<'b>(share: Float<'b>, [x, y]: [Float<'b>; 2]) -> Float<'b> {
    x + share * (y - x)
}

/// One octave of the unfiltered noise, the body of a fold.
pub(super) fn octave(module: &mut Module, kind: Kind, octaves: Octaves) -> FunctionRef {
    let doc = "One more octave of the unfiltered noise.";
    let b = &Builder::new(format!("{}_octave", kind.name()), doc);
    b.uint_param("index");
    let sum = b.float_param("mean");
    let state = Octave::declare(b, octaves);
    let hashes = Grid::of(&state, kind).corners();
    let [x, y] = state.fractions.map(|t| [t, t + -1.0]);
    let offsets = [[x[0], y[0]], [x[1], y[0]], [x[0], y[1]], [x[1], y[1]]];
    let [c00, c10, c01, c11] = std::array::from_fn(|corner| {
        let weights = kind.weights(hashes[corner]);
        match (kind, &weights[..]) {
            (Kind::Gradient | Kind::Materialx(_), &[x, y]) => dot([x, y], offsets[corner]),
            _ => weights[0],
        }
    });
    let [x, y] = state.fractions.map(|t| match kind {
        Kind::Materialmaker { .. } => t.square() * (t * -2.0 + 3.0),
        _ => fade(t),
    });
    let noise = between(y, [between(x, [c00, c10]), between(x, [c01, c11])]);
    b.result("mean", sum + noise * (state.amplitude * kind.unit()));
    state.advance(b, octaves);
    b.finish(module)
}
