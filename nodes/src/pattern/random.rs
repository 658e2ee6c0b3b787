//! A random number for each brick of a bond, filtered.
//!
//! Bricks with half of the joints around them cover the plane: the mean is ½ + Σ w (r − ½), with w
//! the share of the footprint that a brick holds. Rows and columns within 3.8 σ are summed. Where
//! that would be too many the sum fades to ½, whose share of the variance is that of the numbers.

use super::bond::{Bond, Brick};
use super::pulse::Axis;
use super::separable::{orders, phase, rest};
use super::taps::{Taps, by_place, joined};
use crate::noise::field::{Field, Spread};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::{Mode, Normal, Signal};

/// The variance of a uniform number in [0, 1].
const VARIANCE: f32 = 1.0 / 12.0;

/// Standard deviations along a coordinate, in unit cells, without what the coordinates share: above
/// the first the sum fades, at the second it has faded.
const ALONE: [f32; 2] = [1.1, 1.6];

/// The same for √det Σ, the area of the whole footprint.
const AREA: [f32; 2] = [0.5, 1.0];

/// How far a footprint reaches, in standard deviations.
const REACH: f32 = 3.8;

/// The most copies along a coordinate.
const MOST: f32 = 16.0;

/// Sums of w(r − ½) and derivatives, and of w(r − ½)² and w.
const SUMS: [&str; 8] = ["value", "dx", "dy", "dxx", "dxy", "dyy", "square", "weight"];

/// A random number in [0, 1] of the brick at a position in unit cells; `offset` as of the bond,
/// `seed` chooses among walls.
pub(crate) fn numbered(
    lower: &mut Lower<'_>,
    position: &[Signal; 2],
    bond: Bond,
    offset: Value,
    seed: i32,
) -> Signal {
    let mode = lower.mode();
    let b = lower.b();
    let place = [0, 1].map(|i| phase(b, &position[i]));
    let cells = [0, 1].map(|i| match position[i].cell {
        Some(cell) => cell,
        None => {
            let whole = b.floor(position[i].mean);
            b.trunc_i(whole)
        }
    });
    let seed = b.u32(seed as u32);
    let certain = position.iter().all(|axis| axis.is_certain(b));
    let sharp = mode == Mode::Point || certain;
    let spread = Spread::of(b, position);
    let fixed = b.as_constant(offset);
    let key = format!("random {bond:?} {fixed:?}");
    lower.algebra.bent = true;
    if sharp {
        let function = lower.function(&format!("{key} point"), |module| {
            point_function(module, bond, fixed)
        });
        let b = lower.b();
        let mut arguments = vec![place[0], place[1], cells[0], cells[1], seed];
        arguments.extend(fixed.is_none().then_some(offset));
        let value = b.call(&function, &arguments)[0];
        return Signal::certain(b, value).with_range([0.0, 1.0]);
    }
    let tap = lower.function(&key, |module| tap(module, bond, fixed));
    let b = lower.b();
    let taps = Taps::of(b, spread.covariance);
    let zero = b.f32(0.0);
    let mut captures = vec![place[0], place[1]];
    captures.extend(taps.captures());
    let [xx, xy, yy] = spread.covariance;
    let (both, cross) = (b.mul(xx, yy), b.square(xy));
    let area = b.sub(both, cross);
    let area = b.max(area, zero);
    let area = b.sqrt(area);
    captures.push(faded(b, area, AREA));
    captures.extend([cells[0], cells[1], seed]);
    captures.extend(fixed.is_none().then_some(offset));
    let sums = b.fold(&tap, taps.count, &[zero; SUMS.len() + 1], &captures);
    let one = b.f32(1.0);
    let inverse = b.div(one, sums[0]);
    let sums: [Value; SUMS.len()] = std::array::from_fn(|i| b.mul(sums[i + 1], inverse));
    let orders = orders(mode);
    let at = |i: usize| if i < orders { sums[i] } else { zero };
    let centred = b.clamp(sums[0], -0.5, 0.5);
    let mut field = Field {
        mean: b.offset(centred, 0.5),
        gradient: [at(1), at(2)],
        hessian: [at(3), at(4), at(5)],
        rest: zero,
    };
    if mode.spreads() {
        let lost = b.sub(one, sums[7]);
        let lost = b.max(lost, zero);
        let lost = b.scale(lost, VARIANCE);
        let square = b.add(sums[6], lost);
        let own = b.square(centred);
        let variance = b.sub(square, own);
        field.rest = rest(b, &mut field, &spread, variance);
    }
    field.at(lower, position).with_range([0.0, 1.0])
}

/// The number of a brick less ½: of its unit cell, and its place there.
fn number(b: &mut Builder, cells: [Value; 2], brick: u32, seed: Value) -> Value {
    let factor = b.u32(0x9e37_79b1);
    let [x, y] = cells.map(|cell| b.cast_u(cell));
    let y = b.mul_u(y, factor);
    let which = b.u32(brick.wrapping_mul(0x85eb_ca6b));
    let y = b.add_u(y, which);
    let y = b.xor_u(y, seed);
    let y = b.scramble(y);
    let hash = b.xor_u(x, y);
    let hash = b.scramble(hash);
    let shift = b.u32(8);
    let leading = b.shr_u(hash, shift);
    let real = b.float_u(leading);
    let real = b.scale(real, 1.0 / (1u32 << 24) as f32);
    b.offset(real, -0.5)
}

/// The brick's centre and size in unit cells.
fn in_cells(b: &mut Builder, bond: Bond, brick: &Brick, offset: Value) -> ([Value; 2], [f32; 2]) {
    let cell = bond.cell();
    let centre = brick.place(b, offset);
    let centre = [0, 1].map(|i| b.scale(centre[i], 1.0 / cell[i]));
    (centre, [0, 1].map(|i| brick.size[i] / cell[i]))
}

fn offset_parameter(b: &mut Builder, fixed: Option<f32>) -> Value {
    match fixed {
        Some(x) => b.f32(x),
        None => b.param_f32("offset"),
    }
}

/// The number at a place.
fn point_function(module: &mut Module, bond: Bond, fixed: Option<f32>) -> FunctionRef {
    let mut b = Builder::new("brick_number", "The random number of the brick at a place.");
    let place = [b.param_f32("x"), b.param_f32("y")];
    let cells = [b.param("cell_x", Type::I32), b.param("cell_y", Type::I32)];
    let seed = b.param("seed", Type::U32);
    let offset = offset_parameter(&mut b, fixed);
    let mut sum = b.f32(0.5);
    for (i, brick) in bond.bricks().iter().enumerate() {
        let (centre, size) = in_cells(&mut b, bond, brick, offset);
        let (zero, one) = (b.f32(0.0), b.f32(1.0));
        let mut inside = one;
        // The copy of the brick whose centre is next.
        let cells = [0, 1].map(|k| {
            let from = b.sub(place[k], centre[k]);
            let rounded = b.offset(from, 0.5);
            let rounded = b.floor(rounded);
            let from = b.sub(from, rounded);
            // Half open, so that a place belongs to one brick.
            let (low, high) = (b.f32(-0.5 * size[k]), b.f32(0.5 * size[k]));
            let (after, before) = (b.le(low, from), b.lt(from, high));
            let both = b.and(after, before);
            inside = b.select(both, inside, zero);
            let whole = b.trunc_i(rounded);
            b.add_i(cells[k], whole)
        });
        let number = number(&mut b, cells, i as u32, seed);
        let part = b.mul(inside, number);
        sum = b.add(sum, part);
    }
    b.result("number", sum);
    b.finish(module)
}

/// The share of a Gaussian between two places, and its derivatives by the mean, each times as many σ.
fn share(b: &mut Builder, low: Value, high: Value, inverse: Value) -> [Value; 4] {
    let (n, m) = (Normal::at(b, low, inverse), Normal::at(b, high, inverse));
    let value = b.sub(n.below, m.below);
    let slope = b.sub(n.density, m.density);
    let (p, q) = (b.mul(n.z, n.density), b.mul(m.z, m.density));
    let (steep_p, steep_q) = (b.mul(n.z, p), b.mul(m.z, q));
    let third = b.sub(steep_p, steep_q);
    [value, slope, b.sub(q, p), b.sub(third, slope)]
}

/// The first copy of a brick that the footprint reaches, from the mean's distance from a brick, and
/// how many there are.
fn window(b: &mut Builder, from: Value, half: Value, sd: Value) -> [Value; 2] {
    let reach = b.scale(sd, REACH);
    let reach = b.add(reach, half);
    let (low, high) = (b.sub(from, reach), b.add(from, reach));
    let (below, last) = (b.floor(low), b.floor(high));
    let start = b.offset(below, 1.0);
    let count = b.sub(last, below);
    [start, b.clamp(count, 0.0, MOST)]
}

/// Names of the sums over a row: of w(r − ½) and its derivatives, of w(r − ½)² and its first, and of
/// w.
const LINE: [&str; 7] = [
    "value",
    "slope",
    "bend",
    "third",
    "square",
    "square_slope",
    "weight",
];

/// The copies of one brick along a row, the body of a fold.
fn column(module: &mut Module) -> FunctionRef {
    let mut b = Builder::new("brick_column", "One more brick of a row.");
    let index = b.param("index", Type::U32);
    let state = LINE.map(|name| b.param_f32(name));
    let [from, half, start, inverse] =
        ["from", "half", "start", "inverse"].map(|name| b.param_f32(name));
    let cell = b.param("cell_x", Type::I32);
    let row = b.param("row", Type::U32);
    let step = b.float_u(index);
    let copy = b.add(start, step);
    let whole = b.trunc_i(copy);
    let cell = b.add_i(cell, whole);
    let hash = b.cast_u(cell);
    let hash = b.xor_u(hash, row);
    let hash = b.scramble(hash);
    let shift = b.u32(8);
    let leading = b.shr_u(hash, shift);
    let real = b.float_u(leading);
    let real = b.scale(real, 1.0 / (1u32 << 24) as f32);
    let number = b.offset(real, -0.5);
    let distance = b.sub(from, copy);
    let (low, high) = (b.add(distance, half), b.sub(distance, half));
    let [w, slope, bend, third] = share(&mut b, low, high, inverse);
    let (value, steep) = (b.mul(w, number), b.mul(slope, number));
    let parts = [
        value,
        steep,
        b.mul(bend, number),
        b.mul(third, number),
        b.mul(value, number),
        b.mul(steep, number),
        w,
    ];
    for ((name, sum), part) in LINE.into_iter().zip(state).zip(parts) {
        let sum = b.add(sum, part);
        b.result(name, sum);
    }
    b.finish(module)
}

/// The rows of copies of one brick, the body of a fold.
fn row(module: &mut Module) -> FunctionRef {
    let column = column(module);
    let mut b = Builder::new("brick_row", "One more row of bricks.");
    let index = b.param("index", Type::U32);
    let state = SUMS.map(|name| b.param_f32(name));
    let [
        from_x,
        from_y,
        half_x,
        half_y,
        start_x,
        start_y,
        count,
        inverse_x,
        inverse_y,
        correlation,
    ] = [
        "from_x",
        "from_y",
        "half_x",
        "half_y",
        "start_x",
        "start_y",
        "count",
        "inverse_x",
        "inverse_y",
        "correlation",
    ]
    .map(|name| b.param_f32(name));
    let cells = [b.param("cell_x", Type::I32), b.param("cell_y", Type::I32)];
    let (which, seed) = (b.param("which", Type::U32), b.param("seed", Type::U32));
    let step = b.float_u(index);
    let copy = b.add(start_y, step);
    let whole = b.trunc_i(copy);
    let cell = b.add_i(cells[1], whole);
    // As of `number`.
    let factor = b.u32(0x9e37_79b1);
    let hash = b.cast_u(cell);
    let hash = b.mul_u(hash, factor);
    let hash = b.add_u(hash, which);
    let hash = b.xor_u(hash, seed);
    let hash = b.scramble(hash);
    let distance = b.sub(from_y, copy);
    let (low, high) = (b.add(distance, half_y), b.sub(distance, half_y));
    let y = share(&mut b, low, high, inverse_y);
    let zero = b.f32(0.0);
    let count = b.trunc_i(count);
    let count = b.cast_u(count);
    let captures = [from_x, half_x, start_x, inverse_x, cells[0], hash];
    let line = b.fold(&column, count, &[zero; LINE.len()], &captures);
    let x = [0, 1, 2, 3].map(|i| line[i]);
    let mut parts = joined(&mut b, x, y, correlation).to_vec();
    let joint = b.mul(correlation, y[1]);
    parts.push(b.dot(&[line[4], line[5]], &[y[0], joint]));
    parts.push(b.mul(y[0], line[6]));
    for ((name, sum), part) in SUMS.into_iter().zip(state).zip(parts) {
        let sum = b.add(sum, part);
        b.result(name, sum);
    }
    b.finish(module)
}

/// 1 below the first number, 0 above the second.
fn faded(b: &mut Builder, x: Value, [from, to]: [f32; 2]) -> Value {
    let top = b.f32(to);
    let left = b.sub(top, x);
    let share = b.scale(left, 1.0 / (to - from));
    b.clamp(share, 0.0, 1.0)
}

/// One node of the integral over what both coordinates share.
fn tap(module: &mut Module, bond: Bond, fixed: Option<f32>) -> FunctionRef {
    let row = row(module);
    let doc = "Random bricks at one place of the footprint, averaged over what is left of it.";
    let mut b = Builder::new("brick_numbers", doc);
    let index = b.param("index", Type::U32);
    let total = b.param_f32("weights");
    let state = SUMS.map(|name| b.param_f32(format!("sum_{name}")));
    let place = [b.param_f32("x"), b.param_f32("y")];
    let captures = Taps::NAMES.map(|name| b.param_f32(name));
    let [.., correlation] = captures;
    let kept = b.param_f32("kept");
    let cells = [b.param("cell_x", Type::I32), b.param("cell_y", Type::I32)];
    let seed = b.param("seed", Type::U32);
    let offset = offset_parameter(&mut b, fixed);
    let (axes, weight) = Taps::node(&mut b, index, place, captures);
    let one = b.f32(1.0);
    let inverse = axes.map(|Axis { sd, .. }| b.div(one, sd));
    let zero = b.f32(0.0);
    let (fx, fy) = (
        faded(&mut b, axes[0].sd, ALONE),
        faded(&mut b, axes[1].sd, ALONE),
    );
    let fade = b.mul(fx, fy);
    let fade = b.mul(fade, kept);
    let gone = b.le(fade, zero);
    let mut sums = [zero; SUMS.len()];
    for (i, brick) in bond.bricks().iter().enumerate() {
        let (centre, size) = in_cells(&mut b, bond, brick, offset);
        let from = [0, 1].map(|k| b.sub(axes[k].mean, centre[k]));
        let half = size.map(|size| b.f32(0.5 * size));
        let [[start_x, count_x], [start_y, count_y]] =
            [0, 1].map(|k| window(&mut b, from[k], half[k], axes[k].sd));
        // What has faded is not summed.
        let count_y = b.select(gone, zero, count_y);
        let which = b.u32((i as u32).wrapping_mul(0x85eb_ca6b));
        let captures = [
            from[0],
            from[1],
            half[0],
            half[1],
            start_x,
            start_y,
            count_x,
            inverse[0],
            inverse[1],
            correlation,
            cells[0],
            cells[1],
            which,
            seed,
        ];
        let rows = b.trunc_i(count_y);
        let rows = b.cast_u(rows);
        let parts = b.fold(&row, rows, &[zero; SUMS.len()], &captures);
        for (sum, part) in sums.iter_mut().zip(parts) {
            *sum = b.add(*sum, part);
        }
    }
    by_place(&mut b, &mut sums[..6], axes.map(|axis| axis.sd));
    let weighted = b.mul(weight, fade);
    let total = b.add(total, weight);
    b.result("weights", total);
    for ((name, sum), part) in SUMS.into_iter().zip(state).zip(sums) {
        let part = b.mul(weighted, part);
        let sum = b.add(sum, part);
        b.result(format!("sum_{name}"), sum);
    }
    b.finish(module)
}
