//! A random number for each brick of a bond, filtered.
//!
//! Bricks with half of the joints around them cover the plane: the mean is ½ + Σ w (r − ½), with w
//! the share of the footprint that a brick holds. Narrow footprints sum the bricks that they reach,
//! wide ones the tiles of the bricks. Where that would be too many the sum fades to ½, whose share of
//! the variance is that of the numbers.

mod near;
mod wide;

use super::bond::{Bond, Brick};
use super::separable::{orders, phase, rest};
use super::taps::Taps;
use crate::noise::field::{Field, Spread};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::{Mode, Signal};

/// The variance of a uniform number in [0, 1].
const VARIANCE: f32 = 1.0 / 12.0;

/// Standard deviations along a coordinate, in unit cells, without what the coordinates share: above
/// the first the sum fades, at the second it has faded.
const ALONE: [f32; 2] = [1.1, 1.6];

/// The same for √det Σ, the area of the whole footprint, in bricks: 4π of it are averaged, and what the
/// mean of so many numbers has left of a deviation is 0.05 at the first and 0.04 at the second.
const BRICKS: [f32; 2] = [2.5, 5.0];

/// The most copies along a coordinate.
const MOST: f32 = 16.0;

/// What tells the bricks of a cell apart, times their numbers.
const BRICK: u32 = 0x85eb_ca6b;

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
    let tap = lower.function(&key, |module| near::tap(module, bond, fixed));
    let tiles = lower.function(&format!("{key} wide"), |module| {
        wide::function(module, bond, fixed)
    });
    let b = lower.b();
    let zero = b.f32(0.0);
    let [xx, xy, yy] = spread.covariance;
    let (both, cross) = (b.mul(xx, yy), b.square(xy));
    let area = b.sub(both, cross);
    let area = b.max(area, zero);
    let area = b.sqrt(area);
    let bricks = b.scale(area, bond.bricks().len() as f32);
    let kept = faded(b, bricks, BRICKS);
    let taps = Taps::of(b, spread.covariance);
    let (parts, is_wide) = wide::parts(b, bond, spread.covariance, &taps);
    let none = b.u32(0);
    let count = b.select(is_wide, none, taps.count);
    let mut captures = vec![place[0], place[1]];
    captures.extend(taps.captures());
    captures.push(kept);
    captures.extend([cells[0], cells[1], seed]);
    captures.extend(fixed.is_none().then_some(offset));
    let near = b.fold(&tap, count, &[zero; SUMS.len() + 1], &captures);
    let kept = b.select(is_wide, kept, zero);
    let mut arguments = vec![place[0], place[1], xx, xy, yy, parts[0], parts[1]];
    arguments.extend([cells[0], cells[1], seed, kept]);
    arguments.extend(fixed.is_none().then_some(offset));
    let far = b.call(&tiles, &arguments);
    // Of no nodes, everything is 0.
    let (one, least) = (b.f32(1.0), b.f32(1e-30));
    let weights = b.max(near[0], least);
    let inverse = b.div(one, weights);
    let sums: [Value; SUMS.len()] = std::array::from_fn(|i| {
        let near = b.mul(near[i + 1], inverse);
        b.add(near, far[i])
    });
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

/// What the bricks of a row of cells share of their numbers; `which` is the brick's number times
/// [`BRICK`].
fn row_hash(b: &mut Builder, cell: Value, which: Value, seed: Value) -> Value {
    let factor = b.u32(0x9e37_79b1);
    let y = b.cast_u(cell);
    let y = b.mul_u(y, factor);
    let y = b.add_u(y, which);
    let y = b.xor_u(y, seed);
    b.scramble(y)
}

/// The number of a brick less ½, from its cell along x and what its row shares.
fn random(b: &mut Builder, cell: Value, row: Value) -> Value {
    let x = b.cast_u(cell);
    let hash = b.xor_u(x, row);
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
        let which = b.u32((i as u32).wrapping_mul(BRICK));
        let row = row_hash(&mut b, cells[1], which, seed);
        let number = random(&mut b, cells[0], row);
        let part = b.mul(inside, number);
        sum = b.add(sum, part);
    }
    b.result("number", sum);
    b.finish(module)
}

/// The first whole number within `reach` of a place, and how many there are, at most [`MOST`].
fn within(b: &mut Builder, place: Value, reach: Value) -> [Value; 2] {
    let (low, high) = (b.sub(place, reach), b.add(place, reach));
    let (below, last) = (b.floor(low), b.floor(high));
    let first = b.offset(below, 1.0);
    let count = b.sub(last, below);
    [first, b.clamp(count, 0.0, MOST)]
}

/// 1 below the first number, 0 above the second.
fn faded(b: &mut Builder, x: Value, [from, to]: [f32; 2]) -> Value {
    let top = b.f32(to);
    let left = b.sub(top, x);
    let share = b.scale(left, 1.0 / (to - from));
    b.clamp(share, 0.0, 1.0)
}
