//! What follows the numbers of regions, under footprints that hold many of them: summed over the points.
//!
//! A region lies around its point, and has about the area and the spread of a cell: of a Gaussian footprint
//! it holds what the density is at the point, of the footprint's covariance and the region's own.
//! Shares are made to sum to 1. What is missed are the sizes of the regions: of the deviation that
//! the mean of so many numbers has, 0.23 from three quarters of a cell on (simulated: 150 footprints
//! of 4000 places each).

use super::shape::Worley;
use super::taps::random;
use crate::noise::cell::passed::{Passed, passed};
use crate::noise::things::{Sums, channels, weighted};
use mipless_codegen::ir::{Builder, Float, FunctionRef, Int, Module, Scalar, Sym2, Uint, Vec2};
use mipless_codegen::{Image, pairs};

/// The variance of a region, in cells: that of a square is 1/12, and others were worse.
const REGION: f32 = 0.08;

/// How far points count, in standard deviations.
const REACH: f32 = 3.0;

/// The most rows or columns.
const MOST: f32 = 26.0;

/// 1, falling to 0 as a footprint of this standard deviation along an axis fills the largest window.
pub(super) fn fading(sd: Float<'_>) -> Float<'_> {
    const LARGEST: f32 = (MOST - 2.0) / (2.0 * REACH);
    (sd * (-4.0 / LARGEST) + 4.0).clamp(0.0, 1.0)
}

passed! {
    /// The Gaussian, the region's own spread added: where it is, x given y, and y.
    struct Footprint {
        x: Float,
        y: Float,
        lean: Float,
        sd_across: Float,
        inverse_across: Float,
        inverse_y: Float,
    }
}

passed! {
    /// Which cells these are.
    struct Cells {
        cell_x: Int,
        cell_y: Int,
        seed: Uint,
    }
}

/// The first cell of those that reach to both sides of a place, and how many they are.
fn window<'b>(middle: Float<'b>, reach: Float<'b>) -> [Float<'b>; 2] {
    let start = (middle - reach).floor();
    let count = (middle + reach).floor() - start + 1.0;
    [start, count.clamp(1.0, MOST)]
}

/// Sums over the points around a place, relative to the image at the centre; none unless it is asked for.
pub(super) fn summed<'b>(
    row: &FunctionRef,
    ([cell_x, cell_y], [x, y]): ([Int<'b>; 2], [Float<'b>; 2]),
    Sym2([xx, xy, yy]): Sym2<'b>,
    seed: Uint<'b>,
    (centre, parameters): (&[Float<'b>], &[Scalar<'b>]),
    is_asked: mipless_codegen::ir::Bool<'b>,
) -> Sums<'b> {
    let b = x.builder();
    let [xx, yy] = [xx, yy].map(|variance| variance + REGION);
    let inverse_y = 1.0 / yy;
    let lean = xy * inverse_y;
    let across = (xx - lean * xy).max(REGION);
    let footprint = Footprint {
        x,
        y,
        lean,
        sd_across: across.sqrt(),
        inverse_across: 1.0 / across,
        inverse_y,
    };
    let [start, count] = window(y, yy.sqrt() * REACH);
    let cells = Cells {
        cell_x,
        cell_y,
        seed,
    };
    let count = is_asked.select(count.to_int().to_uint(), 0u32);
    let captures = (start, footprint, cells, centre, parameters);
    b.fold(row, count, Sums::zero(b, centre.len()), captures)
}

/// The points of one more row of cells, the body of a fold.
pub(super) fn row(module: &mut Module, worley: Worley, image: &Image) -> FunctionRef {
    let column = column(module, worley, image);
    let b = &Builder::new("region_row", "The regions of one more row of cells.");
    let index = b.uint_param("index");
    let sums = Sums::declare(b, image.channels());
    let start = b.float_param("start");
    let footprint = Footprint::declare(b);
    let cells = Cells::declare(b);
    let centre = channels(b, "centre", image.channels());
    let parameters = image.declare(b);
    let row = start + index.to_float();
    // What the footprint leaves of the row, from its middle, and what points are beside it.
    let up = row + 0.5 - footprint.y;
    let left = (REACH * REACH - up.square() * footprint.inverse_y).max(0.0);
    let beside = footprint.lean.abs() * 0.5;
    let middle = footprint.x + footprint.lean * up;
    let [first, count] = window(middle, left.sqrt() * footprint.sd_across + beside);
    let captures = (first, row, footprint, cells, &centre, &parameters);
    let sums = b.fold(&column, count.to_int().to_uint(), sums, captures);
    sums.results(b);
    b.finish(module)
}

/// One more region, the body of a fold.
fn column(module: &mut Module, worley: Worley, image: &Image) -> FunctionRef {
    let b = &Builder::new("region", "One more region.");
    let index = b.uint_param("index");
    let sums = Sums::declare(b, image.channels());
    let [column, row] = b.float_params(["first_column", "row"]);
    let footprint = Footprint::declare(b);
    let cells = Cells::declare(b);
    let centre = channels(b, "centre", image.channels());
    let parameters = image.declare(b);
    let place = [column + index.to_float(), row];
    let cell = [
        cells.cell_x + place[0].to_int(),
        cells.cell_y + place[1].to_int(),
    ];
    let (shares, number) = random(worley, cell, cells.seed);
    let at = [0, 1].map(|axis| place[axis] + ((shares[axis] + -0.5) * worley.jitter + 0.5));
    let [aside, up] = [at[0] - footprint.x, at[1] - footprint.y];
    // Λd of the distance d, and dᵀΛd.
    let across = aside - footprint.lean * up;
    let along_x = across * footprint.inverse_across;
    let along = Vec2([along_x, up * footprint.inverse_y - footprint.lean * along_x]);
    let square = across * along_x + up.square() * footprint.inverse_y;
    let density = (square * -0.5).exp();
    // Points come and go where they have no weight.
    let weight = (density - (-0.5 * REACH * REACH).exp()).max(0.0);
    let values = image.of(number, &parameters).into_iter();
    let d: Vec<Float<'_>> = values
        .zip(&centre)
        .map(|(value, &centre)| value - centre)
        .collect();
    let products: Vec<Float<'_>> = pairs(d.len()).map(|(i, k)| d[i] * d[k]).collect();
    let counts = weight.gt(0.0).select(density, 0.0);
    Sums {
        weight: sums.weight + weight,
        slope_x: weighted(sums.slope_x, counts * along[0], &d),
        slope_y: weighted(sums.slope_y, counts * along[1], &d),
        first: weighted(sums.first, weight, &d),
        second: weighted(sums.second, weight, &products),
    }
    .results(b);
    b.finish(module)
}
