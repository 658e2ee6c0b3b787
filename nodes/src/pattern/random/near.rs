//! Random bricks under narrow footprints: the share of a footprint that a brick holds is a product of
//! two, one a coordinate, at each node of the integral over what the coordinates share. Bricks that no
//! footprint reaches are not summed.

use super::super::bits;
use super::super::bond::{Bond, Rows};
use super::super::pulse::Axis;
use super::super::taps::{Taps, by_place, joined};
use super::{ALONE, BRICK, SUMS, faded, in_cells, offset_parameter, random, row_hash, within};
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::Normal;

/// How far a footprint reaches, in standard deviations.
const REACH: f32 = 3.8;

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
    within(b, from, reach)
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
    let number = random(&mut b, cell, row);
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
    let hash = row_hash(&mut b, cell, which, seed);
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

/// One node of the integral over what both coordinates share.
pub(super) fn tap(module: &mut Module, bond: Bond, fixed: Option<f32>) -> FunctionRef {
    let brick = brick(module, bond, fixed);
    let doc = "Random bricks at one place of the footprint, averaged over what is left of it.";
    let mut builder = Builder::new("brick_numbers", doc);
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let total = b.param_f32("weights");
    let state = SUMS.map(|name| b.param_f32(format!("sum_{name}")));
    let place = [b.param_f32("x"), b.param_f32("y")];
    let captures = Taps::NAMES.map(|name| b.param_f32(name));
    let [.., correlation] = captures;
    let kept = b.param_f32("kept");
    let cells = [b.param("cell_x", Type::I32), b.param("cell_y", Type::I32)];
    let seed = b.param("seed", Type::U32);
    let offset = offset_parameter(b, fixed);
    let (axes, weight) = Taps::node(b, index, place, captures);
    let zero = b.f32(0.0);
    let (fx, fy) = (faded(b, axes[0].sd, ALONE), faded(b, axes[1].sd, ALONE));
    let fade = b.mul(fx, fy);
    let fade = b.mul(fade, kept);
    let left = b.lt(zero, fade);
    let near: Vec<Value> = (bond.bricks().iter())
        .map(|brick| {
            let (centre, size) = in_cells(b, bond, brick, offset);
            // What has faded is not summed.
            let mut near = left;
            for k in [0, 1] {
                let from = b.sub(axes[k].mean, centre[k]);
                let half = b.f32(0.5 * size[k]);
                let [_, count] = window(b, from, half, axes[k].sd);
                let some = b.lt(zero, count);
                near = b.and(near, some);
            }
            near
        })
        .collect();
    let [touched, count] = bits::set(b, &near);
    let mut state_of = vec![touched];
    state_of.resize(1 + SUMS.len(), zero);
    let mut captures = vec![
        axes[0].mean,
        axes[1].mean,
        axes[0].sd,
        axes[1].sd,
        correlation,
    ];
    captures.extend([cells[0], cells[1], seed]);
    captures.extend(fixed.is_none().then_some(offset));
    let mut sums = b.fold(&brick, count, &state_of, &captures).split_off(1);
    by_place(b, &mut sums[..6], axes.map(|axis| axis.sd));
    let weighted = b.mul(weight, fade);
    let total = b.add(total, weight);
    b.result("weights", total);
    for ((name, sum), part) in SUMS.into_iter().zip(state).zip(sums) {
        let part = b.mul(weighted, part);
        let sum = b.add(sum, part);
        b.result(format!("sum_{name}"), sum);
    }
    builder.finish(module)
}

/// The copies of one more brick of those whose bits are set, the body of a fold.
fn brick(module: &mut Module, bond: Bond, fixed: Option<f32>) -> FunctionRef {
    let row = row(module);
    let rows = Rows::of(module, bond);
    let mut builder = Builder::new("brick_copies", "The copies of one more brick within reach.");
    let b = &mut builder;
    b.param("index", Type::U32);
    let touched = b.param("touched", Type::U32);
    let state = SUMS.map(|name| b.param_f32(name));
    let [x, y, sd_x, sd_y, correlation] =
        ["x", "y", "sd_x", "sd_y", "correlation"].map(|name| b.param_f32(name));
    let cells = [b.param("cell_x", Type::I32), b.param("cell_y", Type::I32)];
    let seed = b.param("seed", Type::U32);
    let offset = offset_parameter(b, fixed);
    let axes = [(x, sd_x), (y, sd_y)].map(|(mean, sd)| Axis { mean, sd });
    let [which, left] = bits::lowest(b, touched);
    let (centre, size) = rows.brick(b, which, offset);
    let cell = bond.cell();
    let centre = [0, 1].map(|k| b.scale(centre[k], 1.0 / cell[k]));
    let half = [0, 1].map(|k| b.scale(size[k], 0.5 / cell[k]));
    let one = b.f32(1.0);
    let inverse = axes.map(|Axis { sd, .. }| b.div(one, sd));
    let from = [0, 1].map(|k| b.sub(axes[k].mean, centre[k]));
    let [[start_x, count_x], [start_y, count_y]] =
        [0, 1].map(|k| window(b, from[k], half[k], axes[k].sd));
    let factor = b.u32(BRICK);
    let which = b.mul_u(which, factor);
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
    let sums = b.fold(&row, rows, &state, &captures);
    b.result("touched", left);
    for (name, sum) in SUMS.into_iter().zip(sums) {
        b.result(name, sum);
    }
    builder.finish(module)
}
