//! Random bricks under long footprints and wide ones: bricks are taken apart into tiles of a brick, or half
//! of one, by a row, and these into as many parts as the footprint's width asks for. The share of a footprint that a part holds
//! is the density of a Gaussian at its centre, of the footprint's covariance and the part's own. The
//! fourth cumulant of a part that this leaves out is 4 % of the density's peak at most, and the shares are
//! made to sum to 1.

use super::super::bond::{Bond, Brick};
use super::super::taps::Taps;
use super::{
    ALONE, BRICK, Summed, declared, declared_cells, faded, offset_parameter, row_hash, sums, within,
};
use mipless_codegen::ir::{Bool, Builder, Float, FunctionRef, Module, Sym2};
use mipless_codegen::{Image, pairs};

/// Along each coordinate, given the other one, half of a part is at most one over this many standard
/// deviations.
const NARROWEST: f32 = 0.6;

/// The most parts of half a brick along a coordinate.
const MOST_PARTS: f32 = 4.0;

/// How many parts of each tile cost as much as a node of the integral over what the coordinates share. One
/// alone never does: of next to no footprint no part is a Gaussian.
const PARTS_A_NODE: f32 = 0.5;

/// How far a footprint and a tile reach together, in standard deviations.
const REACH: f32 = 3.3;

/// A tile, in bricks and rows: half a brick where some bricks are not made of whole ones.
fn size(bond: Bond) -> [f32; 2] {
    let whole = |brick: &Brick| brick.size[0].fract() == 0.0;
    [
        if bond.bricks().iter().all(whole) {
            1.0
        } else {
            0.5
        },
        1.0,
    ]
}

/// Half of a tile, in unit cells.
fn half(bond: Bond) -> [f32; 2] {
    [0, 1].map(|k| 0.5 * size(bond)[k] / bond.cell()[k])
}

/// Standard deviations along a coordinate, in unit cells: above the first the sum fades, at the second it
/// has faded, since no more copies are summed.
const LONGEST: [f32; 2] = [3.6, 4.8];

/// Into how many parts tiles are taken apart along each coordinate, and whether to sum them: where that
/// costs less than the nodes, or where these fade.
pub(super) fn parts<'b>(
    bond: Bond,
    covariance: Sym2<'b>,
    taps: &Taps<'b>,
) -> ([Float<'b>; 2], Bool<'b>) {
    let [xx, xy, yy] = *covariance;
    let area = (xx * yy - xy.square()).max(1e-20);
    let half = half(bond);
    // n h/√(det Σ/Σ₂₂), and the same of the other.
    let counts = [(half[0], yy), (half[1], xx)].map(|(half, other)| {
        let needed = (other / area).sqrt() * (NARROWEST * half);
        needed.ceil().max(1.0)
    });
    // Of tiles of whole bricks twice as many.
    let few = counts[0].le(2.0 * MOST_PARTS * size(bond)[0]) & counts[1].le(MOST_PARTS);
    let mut better = (counts[0] * counts[1]).le(taps.count.to_float() * PARTS_A_NODE);
    for sd in taps.nodes.sd {
        better = better | sd.gt(ALONE[0]);
    }
    (counts, few & better)
}

/// A function of x, y, Σ, the parts, the cells, the seed, how much is kept, and the offset where that is
/// not fixed: the sums, of weights that sum to what is kept.
pub(super) fn function(
    module: &mut Module,
    bond: Bond,
    fixed: Option<f32>,
    image: &Image,
) -> FunctionRef {
    let tile = tile(module, bond, fixed, image);
    let count = tiles(bond).len() as u32;
    let b = &Builder::new("brick_tiles", "Random bricks under a long footprint.");
    let place = b.float_params(["x", "y"]);
    let [xx, xy, yy] = b.float_params(["xx", "xy", "yy"]);
    let parts = b.float_params(["parts_x", "parts_y"]);
    let cells = declared_cells(b);
    let seed = b.uint_param("seed");
    let kept = b.float_param("kept");
    let offset = offset_parameter(b, fixed);
    let summed = Summed::declare(b, image);
    let half = half(bond);
    let halves = [0, 1].map(|k| half[k] / parts[k]);
    // Of a part, ⅓ of the square of half its size.
    let own = halves.map(|half| half.square() * (1.0 / 3.0));
    let (vx, vy) = (xx + own[0], yy + own[1]);
    let inverse_y = 1.0 / vy;
    let slope = xy * inverse_y;
    let left = (vx - slope * xy).max(own[0]);
    let inverse_x = 1.0 / left;
    let sds = [left, vy].map(Float::sqrt);
    let kept = kept * faded(sds[0], LONGEST) * faded(sds[1], LONGEST);
    let shape = (place, parts, halves, sds, slope, [inverse_x, inverse_y]);
    let live = fixed.is_none().then_some(offset);
    let count = kept.gt(0.0).select(count, 0u32);
    let names = sums(image);
    let none = vec![b.float(0.0); names.len()];
    let sums = b.fold(&tile, count, none, (shape, cells, seed, live, &summed));
    let share = kept / sums[sums.len() - 1].max(1e-20);
    b.results(names, sums.into_iter().map(|sum| sum * share));
    b.finish(module)
}

/// The centres of the tiles in unit cells, the number of the brick, and whether it is shifted.
fn tiles(bond: Bond) -> Vec<[f32; 4]> {
    let (cell, tile) = (bond.cell(), size(bond));
    let mut tiles = Vec::new();
    for (i, brick) in bond.bricks().iter().enumerate() {
        let counts = [0, 1].map(|k| (brick.size[k] / tile[k]).round() as u32);
        for row in 0..counts[1] {
            for column in 0..counts[0] {
                let [x, y] = [(0, column), (1, row)].map(|(k, at)| {
                    let from = brick.centre[k] - 0.5 * brick.size[k];
                    (from + tile[k] * (at as f32 + 0.5)) / cell[k]
                });
                let shift = if brick.shifted { 1.0 / cell[0] } else { 0.0 };
                tiles.push([x, y, i as f32, shift]);
            }
        }
    }
    tiles
}

/// The parts of one more tile, the body of a fold.
fn tile(module: &mut Module, bond: Bond, fixed: Option<f32>, image: &Image) -> FunctionRef {
    let part = part(module, image);
    let tiles = tiles(bond);
    let has_shift = tiles.iter().any(|tile| tile[3] != 0.0);
    let table = module.table("tiles", tiles.concat());
    let b = &Builder::new("tile_parts", "The parts of one more tile.");
    let index = b.uint_param("index");
    let names = sums(image);
    let state = declared(b, &names);
    let place = b.float_params(["x", "y"]);
    let parts = b.float_params(["parts_x", "parts_y"]);
    let halves = b.float_params(["half_x", "half_y"]);
    let [sd_x, sd_y, slope] = b.float_params(["sd_x", "sd_y", "slope"]);
    let inverse = b.float_params(["inverse_x", "inverse_y"]);
    let cells = declared_cells(b);
    let seed = b.uint_param("seed");
    let offset = offset_parameter(b, fixed);
    let summed = Summed::declare(b, image);
    let entry = |i: u32| b.load(table, index * 4 + i);
    let mut centre = [entry(0), entry(1)];
    if has_shift {
        centre[0] += entry(3) * offset;
    }
    let which = entry(2).to_int().to_uint() * BRICK;
    // The first part, half of a part from the tile's corner.
    let half = half(bond);
    let from = [0, 1].map(|k| place[k] - centre[k] + half[k] - halves[k]);
    let count = (parts[0] * parts[1]).to_int().to_uint();
    let grid = (from, parts[0], 1.0 / parts[0], halves);
    let captures = (
        grid,
        [sd_x, sd_y, slope],
        inverse,
        cells,
        which,
        seed,
        &summed,
    );
    let sums = b.fold(&part, count, state, captures);
    b.results(names, sums);
    b.finish(module)
}

/// The copies of one more part of a tile, the body of a fold.
fn part(module: &mut Module, image: &Image) -> FunctionRef {
    let row = row(module, image);
    let b = &Builder::new("part_copies", "The copies of one more part of a tile.");
    let index = b.uint_param("index");
    let names = sums(image);
    let state = declared(b, &names);
    let corner = b.float_params(["corner_x", "corner_y"]);
    let [parts, inverse_parts] = b.float_params(["parts_x", "inverse_parts"]);
    let halves = b.float_params(["half_x", "half_y"]);
    let [sd_x, sd_y, slope] = b.float_params(["sd_x", "sd_y", "slope"]);
    let inverse = b.float_params(["inverse_x", "inverse_y"]);
    let cells = declared_cells(b);
    let [which, seed] = ["which", "seed"].map(|name| b.uint_param(name));
    let summed = Summed::declare(b, image);
    // Half a part added before the division keeps whole quotients whole.
    let number = index.to_float();
    let up = ((number + 0.5) * inverse_parts).floor();
    let along = number - up * parts;
    let from = [(0, along), (1, up)].map(|(k, at)| corner[k] - (at + at) * halves[k]);
    let [start, rows] = within(from[1], sd_y * REACH);
    let captures = (
        from,
        [start, sd_x, slope],
        inverse,
        cells,
        which,
        seed,
        &summed,
    );
    let sums = b.fold(&row, rows.to_int().to_uint(), state, captures);
    b.results(names, sums);
    b.finish(module)
}

/// One more row of copies, the body of a fold.
fn row(module: &mut Module, image: &Image) -> FunctionRef {
    let copy = copy(module, image);
    let b = &Builder::new("tile_row", "One more row of copies.");
    let index = b.uint_param("index");
    let names = sums(image);
    let state = declared(b, &names);
    let from = b.float_params(["from_x", "from_y"]);
    let [start, sd_x, slope] = b.float_params(["start", "sd_x", "slope"]);
    let inverse = b.float_params(["inverse_x", "inverse_y"]);
    let cells = declared_cells(b);
    let [which, seed] = ["which", "seed"].map(|name| b.uint_param(name));
    let summed = Summed::declare(b, image);
    let at = start + index.to_float();
    let hash = row_hash(cells[1] + at.to_int(), which, seed);
    let up = from[1] - at;
    // What is left of the reach, around the line that the footprint follows.
    let scaled = up * inverse[1];
    let used = up * scaled;
    let reach = (REACH * REACH - used).max(0.0).sqrt() * sd_x;
    let middle = from[0] - slope * up;
    let [first, count] = within(middle, reach);
    let line = [middle, first, used, scaled, slope];
    let captures = (line, inverse, cells[0], hash, &summed);
    let sums = b.fold(&copy, count.to_int().to_uint(), state, captures);
    b.results(names, sums);
    b.finish(module)
}

/// One more copy, the body of a fold.
fn copy(module: &mut Module, image: &Image) -> FunctionRef {
    let b = &Builder::new("tile_copy", "One more copy of a tile.");
    let index = b.uint_param("index");
    let names = sums(image);
    let state = declared(b, &names);
    let [middle, first, used] = b.float_params(["middle", "first", "used"]);
    let [scaled, slope] = b.float_params(["scaled", "slope"]);
    let inverse = b.float_params(["inverse_x", "inverse_y"]);
    let cell = b.int_param("cell_x");
    let hash = b.uint_param("row");
    let summed = Summed::declare(b, image);
    let at = first + index.to_float();
    let numbers = summed.of(cell + at.to_int(), hash);
    let beside = middle - at;
    let across = beside * inverse[0];
    // Copies come and go where they have no weight.
    let density = ((used + beside * across) * -0.5).exp();
    let weight = (density - (-0.5 * REACH * REACH).exp()).max(0.0);
    // Λ times the distance: (a, s − slope · a) with a = beside/left and s = up/Σ₂₂.
    let rise = scaled - slope * across;
    let both: Vec<[Float<'_>; 2]> = (numbers.iter())
        .map(|&number| [weight * number, density * number])
        .collect();
    // Λ₁₁ = 1/left, Λ₁₂ = −slope/left, Λ₂₂ = 1/Σ₂₂ + slope²/left.
    let side = slope * inverse[0];
    let last = inverse[1] + slope * side;
    let mut parts = Vec::new();
    for &[value, steep] in &both {
        parts.extend([
            value,
            -(steep * across),
            -(steep * rise),
            steep * (across * across - inverse[0]),
            steep * (across * rise + side),
            steep * (rise.square() - last),
        ]);
    }
    parts.extend(pairs(numbers.len()).map(|(i, k)| both[i][0] * numbers[k]));
    parts.push(weight);
    b.sums(names, state, parts);
    b.finish(module)
}
