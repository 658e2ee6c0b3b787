//! Distances to random points in space, one in every cubic cell, and their averages by seven taps.
//!
//! As in the plane, taps at the nodes of the seven-point rule of degree 5 on the surface average small
//! footprints, and larger ones are drawn towards the mean of the noise by the slopes that were measured
//! in the plane. Every tap searches the nearest 27 cells.

use super::shape::Worley;
use super::taps::{Kept, NODES, Nearest};
use crate::noise::cell::lattice_seed;
use crate::noise::components::Hash;
use crate::noise::jenkins;
use crate::noise::period::wrapped;
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Float, FunctionRef, Int, Module, Uint, Vec2};
use mipless_codegen::moments::{Mode, Signal};

/// What a step along x, y and z adds to the key of a cell.
const STEPS: [u32; 3] = [0x9e37_79b1, 0x27d4_eb2f, 0x1656_67b1];

/// Where in its cell a point lies before the jitter, and its number.
fn random<'b>(
    worley: Worley,
    cell: [Int<'b>; 3],
    seed: Uint<'b>,
) -> ([Float<'b>; 3], Option<Float<'b>>) {
    let place = cell.map(|cell| wrapped(cell, worley.period).to_uint());
    match worley.hash {
        Hash::Mipless => {
            let key = (place.iter().zip(STEPS)).fold(seed, |key, (&cell, step)| key + cell * step);
            let [first, second] = [key.scramble(), (key ^ 0x9e37_79b9).scramble()];
            let bits = [first & 0xffff, first >> 16, second & 0xffff];
            let channel = u32::from(worley.channel.unwrap_or_default());
            let number = ((second >> 16) + channel).scramble();
            let number = (worley.solid).then(|| jenkins::unit(number));
            (bits.map(|bits| bits.to_float() * (1.0 / 65536.0)), number)
        }
        Hash::Materialx => {
            let shares = jenkins::three(place, seed).map(jenkins::unit);
            let number = match worley.channel {
                _ if !worley.solid => None,
                Some(channel) => Some(shares[usize::from(channel)]),
                None => Some(jenkins::unit(jenkins::space(place, seed))),
            };
            (shares, number)
        }
    }
}

/// i/3, which is 11 i/32 up to 26.
fn third(i: Uint<'_>) -> Uint<'_> {
    (i * 11) >> 5
}

/// The point of one of the 27 cells around a place, the body of a fold.
fn cell(module: &mut Module, worley: Worley) -> FunctionRef {
    let b = &Builder::new(
        "worley_cell",
        "The point of one of the cells around a place.",
    );
    let index = b.uint_param("index");
    let nearest = Nearest::declare(b, Kept::of(worley), 1)[0];
    let cell = ["cell_x", "cell_y", "cell_z"].map(|name| b.int_param(name));
    let place = b.float_params(["x", "y", "z"]);
    let seed = b.uint_param("seed");
    let rows = third(index);
    let slices = third(rows);
    let offsets = [index - rows * 3, rows - slices * 3, slices];
    let cells = [0, 1, 2].map(|axis| cell[axis] + offsets[axis].to_int() - 1);
    let (shares, number) = random(worley, cells, seed);
    let square = b.sum((0..3).map(|axis| {
        let share = (shares[axis] + -0.5) * worley.jitter + 0.5;
        let at = offsets[axis].to_float() + -1.0 + share;
        (at - place[axis]).square()
    }));
    let number = number.unwrap_or_else(|| b.float(0.0));
    nearest.nearer(square, number, None).results(b, 0);
    b.finish(module)
}

/// The value at a place: cells and what lies beyond them.
fn value(module: &mut Module, worley: Worley) -> FunctionRef {
    let cell = cell(module, worley);
    let b = &Builder::new("worley_at", "The distance to random points in space.");
    let cells = ["cell_x", "cell_y", "cell_z"].map(|name| b.int_param(name));
    let at = b.float_params(["x", "y", "z"]);
    let seed = match worley.hash {
        Hash::Mipless => lattice_seed(b, worley.seed, 0x6a09_e667),
        Hash::Materialx => b.uint(jenkins::seed(worley.seed)),
    };
    let floors = at.map(Float::floor);
    let inner = [0, 1, 2].map(|axis| cells[axis] + floors[axis].to_int());
    let place = [0, 1, 2].map(|axis| at[axis] - floors[axis]);
    let before = Nearest::none(b, Kept::of(worley));
    let nearest = b.fold(&cell, b.uint(27), before, (inner, place, seed));
    b.result("value", nearest.value(worley));
    b.finish(module)
}

/// The filtered noise at a position in space, in cells.
pub(crate) fn filtered<'b>(
    lower: &mut Lower<'_, 'b>,
    position: &[Signal<'b>],
    worley: Worley,
) -> Signal<'b> {
    let (mode, b) = (lower.mode(), lower.b());
    let key = format!("worley in space {worley:?}");
    let function = lower.function(&key, |module| value(module, worley));
    let places: Vec<(Int<'b>, Float<'b>)> = position.iter().map(Signal::place).collect();
    let cells: Vec<Int<'b>> = places.iter().map(|(cell, _)| *cell).collect();
    let fractions: Vec<Float<'b>> = places.iter().map(|(_, fraction)| *fraction).collect();
    // Everything that moves the position, as if it were the surface's: half of the trace of its
    // covariance is the square of a round footprint of the same size.
    let trace = b.sum(position.iter().map(Signal::variance));
    let size = (trace * 0.5).sqrt();
    lower.source_detail(size, worley.wavenumber());
    let at = |lower: &Lower<'_, 'b>, [p, q]: [f32; 2]| {
        let moved: Vec<Float<'b>> = (position.iter().zip(&fractions))
            .map(|(axis, &fraction)| fraction + (axis.g[0] * p + axis.g[1] * q))
            .collect();
        lower.b().call(&function, (&cells, moved))[0]
    };
    if !mode.filters() {
        return Signal::certain(at(lower, [0.0; 2]));
    }
    let found: Vec<Float<'b>> = (NODES.iter()).map(|&[p, q, _]| at(lower, [p, q])).collect();

    // Deviations from the centre keep their digits.
    let [mut m1, mut m2, mut along, mut across] = [b.float(0.0); 4];
    for (&value, [p, q, weight]) in found.iter().zip(NODES) {
        let d = value - found[0];
        let part = d * weight;
        m1 += part;
        m2 += part * d;
        along += part * p;
        across += part * q;
    }
    let [slope, trust] = worley.slopes(size);
    let [centre, variance] = worley.moments();
    let mut signal = Signal::certain(centre + (found[0] - centre + m1) * slope);
    if !mode.spreads() {
        return signal;
    }
    let carries = matches!(mode, Mode::Local | Mode::Quad);
    let expected = worley.lost(size) * variance;
    let rest = if carries {
        // The slopes in whitened coordinates are the response itself.
        signal.g = Vec2([along, across]) * slope;
        let taps = m2 - m1.square();
        let local = taps * trust + expected * (1.0 - trust);
        (local - signal.g.norm2()).max(0.0)
    } else {
        expected
    };
    lower.algebra.attach_fresh(&mut signal, rest);
    signal
}
