//! Random bricks under long footprints: bricks are taken apart into tiles of half a brick by a row, and
//! these into as many parts as the footprint's width asks for. The share of a footprint that a part holds
//! is the density of a Gaussian at its centre, of the footprint's covariance and the part's own. The
//! fourth cumulant of a part that this leaves out is 4 % of the density's peak at most, and the shares are
//! made to sum to 1.

use super::super::bond::Bond;
use super::super::taps::Taps;
use super::{ALONE, BRICK, SUMS, faded, random, row_hash, within};
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};

/// Along each coordinate, given the other one, half of a part is at most one over this many standard
/// deviations.
const NARROWEST: f32 = 0.6;

/// The most parts of a tile along a coordinate.
const MOST_PARTS: f32 = 4.0;

/// How many parts of each tile cost as much as a node of the integral over what the coordinates share.
const PARTS_A_NODE: f32 = 0.5;

/// How far a footprint and a tile reach together, in standard deviations.
const REACH: f32 = 3.3;

/// A tile, in bricks and rows.
const TILE: [f32; 2] = [0.5, 1.0];

/// Half of a tile, in unit cells.
fn half(bond: Bond) -> [f32; 2] {
    [0, 1].map(|k| 0.5 * TILE[k] / bond.cell()[k])
}

/// Standard deviations along a coordinate, in unit cells: above the first the sum fades, at the second it
/// has faded, since no more copies are summed.
const LONGEST: [f32; 2] = [1.8, 2.4];

/// Into how many parts tiles are taken apart along each coordinate, and whether to sum them: where that
/// costs less than the nodes, or where these fade.
pub(super) fn parts(
    b: &mut Builder,
    bond: Bond,
    [xx, xy, yy]: [Value; 3],
    taps: &Taps,
) -> ([Value; 2], Value) {
    let (both, cross) = (b.mul(xx, yy), b.square(xy));
    let area = b.sub(both, cross);
    let least = b.f32(1e-20);
    let area = b.max(area, least);
    let half = half(bond);
    // n h/√(det Σ/Σ₂₂), and the same of the other.
    let counts = [(half[0], yy), (half[1], xx)].map(|(half, other)| {
        let inverse = b.div(other, area);
        let inverse = b.sqrt(inverse);
        let needed = b.scale(inverse, NARROWEST * half);
        let minus = b.neg(needed);
        let down = b.floor(minus);
        let up = b.neg(down);
        let one = b.f32(1.0);
        b.max(up, one)
    });
    let most = b.f32(MOST_PARTS);
    let (along, across) = (b.le(counts[0], most), b.le(counts[1], most));
    let few = b.and(along, across);
    let parts = b.mul(counts[0], counts[1]);
    let nodes = b.float_u(taps.count);
    let nodes = b.scale(nodes, PARTS_A_NODE);
    let mut better = b.le(parts, nodes);
    let fading = b.f32(ALONE[0]);
    for sd in taps.sd {
        let fades = b.lt(fading, sd);
        better = b.or(better, fades);
    }
    (counts, b.and(few, better))
}

/// A function of x, y, Σ, the parts, the cells, the seed, how much is kept, and the offset where that is
/// not fixed: the sums, of weights that sum to what is kept.
pub(super) fn function(module: &mut Module, bond: Bond, fixed: Option<f32>) -> FunctionRef {
    let tile = tile(module, bond, fixed);
    let count = tiles(bond).len() as u32;
    let mut builder = Builder::new("brick_tiles", "Random bricks under a long footprint.");
    let b = &mut builder;
    let place = ["x", "y"].map(|name| b.param_f32(name));
    let [xx, xy, yy] = ["xx", "xy", "yy"].map(|name| b.param_f32(name));
    let parts = ["parts_x", "parts_y"].map(|name| b.param_f32(name));
    let cells = ["cell_x", "cell_y"].map(|name| b.param(name, Type::I32));
    let seed = b.param("seed", Type::U32);
    let mut kept = b.param_f32("kept");
    let offset = super::offset_parameter(b, fixed);
    let one = b.f32(1.0);
    let half = half(bond);
    let halves = [0, 1].map(|k| {
        let all = b.f32(half[k]);
        b.div(all, parts[k])
    });
    // Of a part, ⅓ of the square of half its size.
    let own = halves.map(|half| {
        let square = b.square(half);
        b.scale(square, 1.0 / 3.0)
    });
    let (vx, vy) = (b.add(xx, own[0]), b.add(yy, own[1]));
    let inverse_y = b.div(one, vy);
    let slope = b.mul(xy, inverse_y);
    let explained = b.mul(slope, xy);
    let left = b.sub(vx, explained);
    let left = b.max(left, own[0]);
    let inverse_x = b.div(one, left);
    let [sd_x, sd_y] = [left, vy].map(|v| b.sqrt(v));
    for sd in [sd_x, sd_y] {
        let share = faded(b, sd, LONGEST);
        kept = b.mul(kept, share);
    }
    let mut captures = vec![place[0], place[1], parts[0], parts[1], halves[0], halves[1]];
    captures.extend([sd_x, sd_y, slope, inverse_x, inverse_y]);
    captures.extend([cells[0], cells[1], seed]);
    captures.extend(fixed.is_none().then_some(offset));
    let (zero, none, all) = (b.f32(0.0), b.u32(0), b.u32(count));
    let some = b.lt(zero, kept);
    let count = b.select(some, all, none);
    let sums = b.fold(&tile, count, &[zero; SUMS.len()], &captures);
    let small = b.f32(1e-20);
    let weights = b.max(sums[7], small);
    let share = b.div(kept, weights);
    for (name, sum) in SUMS.into_iter().zip(sums) {
        let part = b.mul(sum, share);
        b.result(name, part);
    }
    builder.finish(module)
}

/// The centres of the tiles in unit cells, the number of the brick, and whether it is shifted.
fn tiles(bond: Bond) -> Vec<[f32; 4]> {
    let cell = bond.cell();
    let mut tiles = Vec::new();
    for (i, brick) in bond.bricks().iter().enumerate() {
        let counts = [0, 1].map(|k| (brick.size[k] / TILE[k]).round() as u32);
        for row in 0..counts[1] {
            for column in 0..counts[0] {
                let [x, y] = [(0, column), (1, row)].map(|(k, at)| {
                    let from = brick.centre[k] - 0.5 * brick.size[k];
                    (from + TILE[k] * (at as f32 + 0.5)) / cell[k]
                });
                let shift = if brick.shifted { 1.0 / cell[0] } else { 0.0 };
                tiles.push([x, y, i as f32, shift]);
            }
        }
    }
    tiles
}

/// The parts of one more tile, the body of a fold.
fn tile(module: &mut Module, bond: Bond, fixed: Option<f32>) -> FunctionRef {
    let part = part(module);
    let tiles = tiles(bond);
    let has_shift = tiles.iter().any(|tile| tile[3] != 0.0);
    let table = module.table("tiles", tiles.concat());
    let mut builder = Builder::new("tile_parts", "The parts of one more tile.");
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let state = SUMS.map(|name| b.param_f32(name));
    let place = ["x", "y"].map(|name| b.param_f32(name));
    let parts = ["parts_x", "parts_y"].map(|name| b.param_f32(name));
    let halves = ["half_x", "half_y"].map(|name| b.param_f32(name));
    let [sd_x, sd_y, slope] = ["sd_x", "sd_y", "slope"].map(|name| b.param_f32(name));
    let inverse = ["inverse_x", "inverse_y"].map(|name| b.param_f32(name));
    let cells = ["cell_x", "cell_y"].map(|name| b.param(name, Type::I32));
    let seed = b.param("seed", Type::U32);
    let offset = super::offset_parameter(b, fixed);
    let width = b.u32(4);
    let first = b.mul_u(index, width);
    let mut entry = |i: u32| {
        let i = b.u32(i);
        let at = b.add_u(first, i);
        b.load(table, at)
    };
    let mut centre = [entry(0), entry(1)];
    let brick = entry(2);
    if has_shift {
        let shift = entry(3);
        let shift = b.mul(shift, offset);
        centre[0] = b.add(centre[0], shift);
    }
    let brick = b.trunc_i(brick);
    let brick = b.cast_u(brick);
    let factor = b.u32(BRICK);
    let which = b.mul_u(brick, factor);
    // The first part, half of a part from the tile's corner.
    let half = half(bond);
    let from = [0, 1].map(|k| {
        let from = b.sub(place[k], centre[k]);
        let corner = b.offset(from, half[k]);
        b.sub(corner, halves[k])
    });
    let one = b.f32(1.0);
    let inverse_parts = b.div(one, parts[0]);
    let count = b.mul(parts[0], parts[1]);
    let count = b.trunc_i(count);
    let count = b.cast_u(count);
    let captures = [
        from[0],
        from[1],
        parts[0],
        inverse_parts,
        halves[0],
        halves[1],
        sd_x,
        sd_y,
        slope,
        inverse[0],
        inverse[1],
        cells[0],
        cells[1],
        which,
        seed,
    ];
    let sums = b.fold(&part, count, &state, &captures);
    for (name, sum) in SUMS.into_iter().zip(sums) {
        b.result(name, sum);
    }
    builder.finish(module)
}

/// The copies of one more part, the body of a fold.
fn part(module: &mut Module) -> FunctionRef {
    let row = row(module);
    let mut builder = Builder::new("part_copies", "The copies of one more part of a tile.");
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let state = SUMS.map(|name| b.param_f32(name));
    let corner = ["corner_x", "corner_y"].map(|name| b.param_f32(name));
    let [parts, inverse_parts] = ["parts_x", "inverse_parts"].map(|name| b.param_f32(name));
    let halves = ["half_x", "half_y"].map(|name| b.param_f32(name));
    let [sd_x, sd_y, slope] = ["sd_x", "sd_y", "slope"].map(|name| b.param_f32(name));
    let inverse = ["inverse_x", "inverse_y"].map(|name| b.param_f32(name));
    let cells = ["cell_x", "cell_y"].map(|name| b.param(name, Type::I32));
    let (which, seed) = (b.param("which", Type::U32), b.param("seed", Type::U32));
    // Half a part added before the division keeps whole quotients whole.
    let number = b.float_u(index);
    let raised = b.offset(number, 0.5);
    let up = b.mul(raised, inverse_parts);
    let up = b.floor(up);
    let before = b.mul(up, parts);
    let along = b.sub(number, before);
    let from = [(0, along), (1, up)].map(|(k, at)| {
        let twice = b.add(at, at);
        let shift = b.mul(twice, halves[k]);
        b.sub(corner[k], shift)
    });
    let reach = b.scale(sd_y, REACH);
    let [start, rows] = within(b, from[1], reach);
    let rows = b.trunc_i(rows);
    let rows = b.cast_u(rows);
    let captures = [
        from[0], from[1], start, sd_x, slope, inverse[0], inverse[1], cells[0], cells[1], which,
        seed,
    ];
    let sums = b.fold(&row, rows, &state, &captures);
    for (name, sum) in SUMS.into_iter().zip(sums) {
        b.result(name, sum);
    }
    builder.finish(module)
}

/// One more row of copies, the body of a fold.
fn row(module: &mut Module) -> FunctionRef {
    let copy = copy(module);
    let mut builder = Builder::new("tile_row", "One more row of copies.");
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let state = SUMS.map(|name| b.param_f32(name));
    let from = ["from_x", "from_y"].map(|name| b.param_f32(name));
    let [start, sd_x, slope] = ["start", "sd_x", "slope"].map(|name| b.param_f32(name));
    let inverse = ["inverse_x", "inverse_y"].map(|name| b.param_f32(name));
    let cells = ["cell_x", "cell_y"].map(|name| b.param(name, Type::I32));
    let (which, seed) = (b.param("which", Type::U32), b.param("seed", Type::U32));
    let step = b.float_u(index);
    let at = b.add(start, step);
    let whole = b.trunc_i(at);
    let cell = b.add_i(cells[1], whole);
    let hash = row_hash(b, cell, which, seed);
    let up = b.sub(from[1], at);
    // What is left of the reach, around the line that the footprint follows.
    let scaled = b.mul(up, inverse[1]);
    let used = b.mul(up, scaled);
    let all = b.f32(REACH * REACH);
    let rest = b.sub(all, used);
    let zero = b.f32(0.0);
    let rest = b.max(rest, zero);
    let rest = b.sqrt(rest);
    let reach = b.mul(rest, sd_x);
    let lean = b.mul(slope, up);
    let middle = b.sub(from[0], lean);
    let [first, count] = within(b, middle, reach);
    let count = b.trunc_i(count);
    let count = b.cast_u(count);
    let captures = [
        middle, first, used, scaled, slope, inverse[0], inverse[1], cells[0], hash,
    ];
    let sums = b.fold(&copy, count, &state, &captures);
    for (name, sum) in SUMS.into_iter().zip(sums) {
        b.result(name, sum);
    }
    builder.finish(module)
}

/// One more copy, the body of a fold.
fn copy(module: &mut Module) -> FunctionRef {
    let mut builder = Builder::new("tile_copy", "One more copy of a tile.");
    let b = &mut builder;
    let index = b.param("index", Type::U32);
    let state = SUMS.map(|name| b.param_f32(name));
    let [middle, first, used] = ["middle", "first", "used"].map(|name| b.param_f32(name));
    let [scaled, slope] = ["scaled", "slope"].map(|name| b.param_f32(name));
    let inverse = ["inverse_x", "inverse_y"].map(|name| b.param_f32(name));
    let cell = b.param("cell_x", Type::I32);
    let hash = b.param("row", Type::U32);
    let step = b.float_u(index);
    let at = b.add(first, step);
    let whole = b.trunc_i(at);
    let cell = b.add_i(cell, whole);
    let number = random(b, cell, hash);
    let beside = b.sub(middle, at);
    let across = b.mul(beside, inverse[0]);
    let more = b.mul(beside, across);
    let square = b.add(used, more);
    // Copies come and go where they have no weight.
    let exponent = b.scale(square, -0.5);
    let density = b.exp(exponent);
    let least = b.f32((-0.5 * REACH * REACH).exp());
    let weight = b.sub(density, least);
    let zero = b.f32(0.0);
    let weight = b.max(weight, zero);
    // Λ times the distance: (a, s − slope · a) with a = beside/left and s = up/Σ₂₂.
    let lean = b.mul(slope, across);
    let rise = b.sub(scaled, lean);
    let value = b.mul(weight, number);
    let steep = b.mul(density, number);
    let (fx, fy) = (b.mul(steep, across), b.mul(steep, rise));
    let (dx, dy) = (b.neg(fx), b.neg(fy));
    // Λ₁₁ = 1/left, Λ₁₂ = −slope/left, Λ₂₂ = 1/Σ₂₂ + slope²/left.
    let side = b.mul(slope, inverse[0]);
    let turned = b.mul(slope, side);
    let last = b.add(inverse[1], turned);
    let (xx, xy, yy) = (b.mul(across, across), b.mul(across, rise), b.square(rise));
    let (xx, xy, yy) = (b.sub(xx, inverse[0]), b.add(xy, side), b.sub(yy, last));
    let parts = [
        value,
        dx,
        dy,
        b.mul(steep, xx),
        b.mul(steep, xy),
        b.mul(steep, yy),
        b.mul(value, number),
        weight,
    ];
    for ((name, sum), part) in SUMS.into_iter().zip(state).zip(parts) {
        let sum = b.add(sum, part);
        b.result(name, sum);
    }
    builder.finish(module)
}
