//! One octave of the unfiltered noise: the nearest 3×3 kernels.

use super::address::Address;
use super::width::WIDTH;
use crate::noise::hash::direction;
use crate::noise::sum::Octave;
use crate::noise::sum::Octaves;
use mipless_codegen::ir::{Builder, Float, FunctionRef, Module};

/// The offsets of a position to the three nearest columns, and where they start.
fn nearest<'b>(x: Float<'b>) -> ([Float<'b>; 3], Float<'b>) {
    let start = (x + 0.5).floor() + -1.0;
    let first = x - start;
    ([0.0, -1.0, -2.0].map(|by| first + by), start)
}

fn envelope(square: Float<'_>) -> Float<'_> {
    (square * (-0.5 / (WIDTH * WIDTH))).exp()
}

/// The unfiltered kernels of one lattice row, the body of a fold over rows: E dᵀBd is
/// E (cos θ (x² − y²) + 2 sin θ xy), and what depends on x alone comes from outside.
fn row(module: &mut Module, tiles: bool) -> FunctionRef {
    let doc = "The unfiltered kernels of one lattice row.";
    let b = &Builder::new("lattice_row", doc);
    let index = b.uint_param("index");
    let sum = b.float_param("sum");
    let start = b.float_param("start_x");
    let y = b.float_param("y");
    let columns = [0, 1, 2].map(|i| [0, 1, 2].map(|n| b.float_param(format!("e_{i}_{n}"))));
    let address = Address::declare(b, tiles);
    let dy = y - index.to_float();
    let y2 = dy.square();
    let keys = address.keys(index, start, 3);
    let turns: Vec<[Float<'_>; 2]> = (keys.into_iter())
        .map(|key| direction(key.scramble()))
        .collect();
    let of = |turn: usize, power: usize| {
        b.sum(
            turns
                .iter()
                .zip(columns)
                .map(|(turns, e)| turns[turn] * e[power]),
        )
    };
    let (even, square, mixed) = (of(0, 0), of(0, 2), of(1, 1));
    let row = (square - y2 * even) + (dy + dy) * mixed;
    b.result("sum", sum + envelope(y2) * row);
    b.finish(module)
}

/// One octave of the unfiltered noise, the body of a fold.
pub(super) fn octave(module: &mut Module, octaves: Octaves) -> FunctionRef {
    let row = row(module, octaves.tiles());
    let doc = "One more octave of the unfiltered noise.";
    let b = &Builder::new("lattice_octave", doc);
    b.uint_param("index");
    let sum = b.float_param("mean");
    let state = Octave::declare(b, octaves);
    let [x, y] = state.fractions;
    let (offsets, start_x) = nearest(x);
    let ([first_y, ..], start_y) = nearest(y);
    let columns = offsets.map(|x| {
        let square = x.square();
        let e = envelope(square);
        [e, e * x, e * square]
    });
    let address = state.address().rows_counted_from(start_y);
    let captures = (start_x, first_y, columns, address);
    let rows = b.fold(&row, b.uint(3), b.float(0.0), captures);
    // c = 1/(√π a³).
    let unit = 1.0 / (std::f32::consts::PI.sqrt() * WIDTH.powi(3));
    b.result("mean", sum + rows * (state.amplitude * unit));
    state.advance(b, octaves);
    b.finish(module)
}
