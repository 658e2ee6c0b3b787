//! One octave of the unfiltered noise: the nearest 3×3 kernels.

use super::address::Address;
use super::width::WIDTH;
use crate::noise::hash::direction;
use crate::noise::octave::Octave;
use crate::noise::sum::Octaves;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};

/// The offsets of a position to the three nearest columns, and where they start.
fn nearest(b: &mut Builder, x: Value) -> ([Value; 3], Value) {
    let start = b.offset(x, 0.5);
    let start = b.floor(start);
    let start = b.offset(start, -1.0);
    let first = b.sub(x, start);
    let offsets = [0.0, -1.0, -2.0].map(|by| b.offset(first, by));
    (offsets, start)
}

fn envelope(b: &mut Builder, square: Value) -> Value {
    let exponent = b.scale(square, -0.5 / (WIDTH * WIDTH));
    b.exp(exponent)
}

/// The unfiltered kernels of one lattice row, the body of a fold over rows: E dᵀBd is
/// E (cos θ (x² − y²) + 2 sin θ xy), and what depends on x alone comes from outside.
fn row(module: &mut Module, tiles: bool) -> FunctionRef {
    let doc = "The unfiltered kernels of one lattice row.";
    let mut builder = Builder::new("lattice_row", doc);
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let sum = b.param_f32("sum");
    let start = b.param_f32("start_x");
    let y = b.param_f32("y");
    let columns: Vec<[Value; 3]> = (0..3)
        .map(|i| [0, 1, 2].map(|n| b.param_f32(format!("e_{i}_{n}"))))
        .collect();
    let address = Address::declare(b, tiles);
    let number = b.float_u(index);
    let dy = b.sub(y, number);
    let y2 = b.square(dy);
    let envelope = envelope(b, y2);
    let keys = address.keys(b, index, start, 3);
    let zero = b.f32(0.0);
    let (mut even, mut square, mut mixed) = (zero, zero, zero);
    for (key, [e, ex, exx]) in keys.into_iter().zip(columns) {
        let hash = b.scramble(key);
        let [cos, sin] = direction(b, hash);
        let parts = [
            (&mut even, cos, e),
            (&mut square, cos, exx),
            (&mut mixed, sin, ex),
        ];
        for (sum, turn, weight) in parts {
            let part = b.mul(turn, weight);
            *sum = b.add(*sum, part);
        }
    }
    let even = b.mul(y2, even);
    let row = b.sub(square, even);
    let twice = b.add(dy, dy);
    let mixed = b.mul(twice, mixed);
    let row = b.add(row, mixed);
    let row = b.mul(envelope, row);
    let sum = b.add(sum, row);
    b.result("sum", sum);
    builder.finish(module)
}

/// One octave of the unfiltered noise, the body of a fold.
pub(super) fn octave(module: &mut Module, octaves: Octaves) -> FunctionRef {
    let row = row(module, octaves.tiles());
    let doc = "One more octave of the unfiltered noise.";
    let mut builder = Builder::new("lattice_octave", doc);
    let b = &mut builder;
    b.param("index", Type::U32);
    let sum = b.param_f32("mean");
    let state = Octave::declare(b, octaves);
    let [x, y] = state.fractions;
    let (offsets, start_x) = nearest(b, x);
    let ([first_y, ..], start_y) = nearest(b, y);
    let mut captures = vec![start_x, first_y];
    for x in offsets {
        let square = b.square(x);
        let e = envelope(b, square);
        captures.extend([e, b.mul(e, x), b.mul(e, square)]);
    }
    let address = state.address(b).rows_counted_from(b, start_y);
    captures.extend(address.captures());
    let (zero, three) = (b.f32(0.0), b.u32(3));
    let rows = b.fold(&row, three, &[zero], &captures)[0];
    // c = 1/(√π a³).
    let unit = 1.0 / (std::f32::consts::PI.sqrt() * WIDTH.powi(3));
    let amplitude = b.scale(state.amplitude, unit);
    let part = b.mul(rows, amplitude);
    let sum = b.add(sum, part);
    b.result("mean", sum);
    state.advance(b, octaves);
    builder.finish(module)
}
