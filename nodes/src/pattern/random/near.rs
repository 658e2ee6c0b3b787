//! Random bricks under narrow footprints: the share of a footprint that a brick holds is a product of
//! two, one a coordinate, at each node of the integral over what the coordinates share. Bricks that no
//! footprint reaches are not summed.

use super::super::bits;
use super::super::bond::{Bond, Rows};
use super::super::pulse::Derivatives;
use super::super::taps::{Nodes, by_place, joined};
use super::{
    ALONE, BRICK, ORDERS, Summed, declared, declared_cells, faded, in_cells, names,
    offset_parameter, row_hash, sums, within,
};
use mipless_codegen::ir::{Bool, Builder, Float, FunctionRef, Module};
use mipless_codegen::moments::Normal;
use mipless_codegen::{Image, pairs};

/// How far a footprint reaches, in standard deviations.
const REACH: f32 = 3.8;

/// The share of a Gaussian between two places, and its derivatives by the mean, each times as many σ.
fn share<'b>(low: Float<'b>, high: Float<'b>, inverse: Float<'b>) -> Derivatives<'b> {
    let [n, m] = [low, high].map(|place| Normal::at(place, inverse));
    let slope = n.density - m.density;
    let (p, q) = (n.z * n.density, m.z * m.density);
    [n.below - m.below, slope, q - p, n.z * p - m.z * q - slope]
}

/// The first copy of a brick that the footprint reaches, from the mean's distance from a brick, and
/// how many there are.
fn window<'b>(from: Float<'b>, half: Float<'b>, sd: Float<'b>) -> [Float<'b>; 2] {
    within(from, sd * REACH + half)
}

/// The derivatives of a mean along a row.
const ALONG: [&str; 4] = ["value", "slope", "bend", "third"];

/// Names of the sums over a row: of w(r − ½) and its derivatives, of w(r − ½)² and its first, and of
/// w.
fn line(image: &Image) -> Vec<String> {
    names(image, &ALONG, &["square", "square_slope"])
}

/// The copies of one brick along a row, the body of a fold.
fn column(module: &mut Module, image: &Image) -> FunctionRef {
    let b = &Builder::new("brick_column", "One more brick of a row.");
    let index = b.uint_param("index");
    let names = line(image);
    let state = declared(b, &names);
    let [from, half, start, inverse] = b.float_params(["from", "half", "start", "inverse"]);
    let cell = b.int_param("cell_x");
    let row = b.uint_param("row");
    let summed = Summed::declare(b, image);
    let copy = start + index.to_float();
    let numbers = summed.of(cell + copy.to_int(), row);
    let distance = from - copy;
    let [w, slope, bend, third] = share(distance + half, distance - half, inverse);
    let values: Vec<[Float<'_>; 2]> = (numbers.iter())
        .map(|&number| [w * number, slope * number])
        .collect();
    let mut parts = Vec::new();
    for (&number, &[value, steep]) in numbers.iter().zip(&values) {
        parts.extend([value, steep, bend * number, third * number]);
    }
    for order in 0..2 {
        parts.extend(pairs(numbers.len()).map(|(i, k)| values[i][order] * numbers[k]));
    }
    parts.push(w);
    b.sums(names, state, parts);
    b.finish(module)
}

/// The rows of copies of one brick, the body of a fold.
fn row(module: &mut Module, image: &Image) -> FunctionRef {
    let column = column(module, image);
    let b = &Builder::new("brick_row", "One more row of bricks.");
    let index = b.uint_param("index");
    let names = sums(image);
    let state = declared(b, &names);
    let [from_x, from_y] = b.float_params(["from_x", "from_y"]);
    let [half_x, half_y] = b.float_params(["half_x", "half_y"]);
    let [start_x, start_y] = b.float_params(["start_x", "start_y"]);
    let count = b.float_param("count");
    let [inverse_x, inverse_y] = b.float_params(["inverse_x", "inverse_y"]);
    let correlation = b.float_param("correlation");
    let cells = declared_cells(b);
    let [which, seed] = ["which", "seed"].map(|name| b.uint_param(name));
    let summed = Summed::declare(b, image);
    let copy = start_y + index.to_float();
    let hash = row_hash(cells[1] + copy.to_int(), which, seed);
    let distance = from_y - copy;
    let y = share(distance + half_y, distance - half_y, inverse_y);
    let none = vec![b.float(0.0); line(image).len()];
    let captures = (
        [from_x, half_x, start_x, inverse_x],
        cells[0],
        hash,
        &summed,
    );
    let line = b.fold(&column, count.to_int().to_uint(), none, captures);
    let (of_each, others) = line.split_at(ALONG.len() * image.channels());
    let mut parts = Vec::new();
    for &[x0, x1, x2, x3] in of_each.as_chunks().0 {
        parts.extend(joined([x0, x1, x2, x3], y, correlation));
    }
    let (squares, others) = others.split_at(others.len() / 2);
    for (&square, &square_slope) in squares.iter().zip(others) {
        parts.push(square * y[0] + square_slope * (correlation * y[1]));
    }
    parts.push(y[0] * others[squares.len()]);
    b.sums(names, state, parts);
    b.finish(module)
}

/// One node of the integral over what both coordinates share.
pub(super) fn tap(
    module: &mut Module,
    bond: Bond,
    fixed: Option<f32>,
    image: &Image,
) -> FunctionRef {
    let brick = brick(module, bond, fixed, image);
    let doc = "Random bricks at one place of the footprint, averaged over what is left of it.";
    let b = &Builder::new("brick_numbers", doc);
    let index = b.uint_param("index");
    let total = b.float_param("weights");
    let names = sums(image).into_iter();
    let names: Vec<String> = names.map(|name| format!("sum_{name}")).collect();
    let state = declared(b, &names);
    let place = b.float_params(["x", "y"]);
    let nodes = Nodes::declare(b);
    let kept = b.float_param("kept");
    let cells = declared_cells(b);
    let seed = b.uint_param("seed");
    let offset = offset_parameter(b, fixed);
    let summed = Summed::declare(b, image);
    let (axes, weight) = nodes.at(index, place);
    let (means, sds) = (axes.map(|axis| axis.mean), axes.map(|axis| axis.sd));
    let fade = faded(sds[0], ALONE) * faded(sds[1], ALONE) * kept;
    let left = fade.gt(0.0);
    let near: Vec<Bool<'_>> = (bond.bricks().iter())
        .map(|brick| {
            let (centre, size) = in_cells(bond, brick, offset);
            // What has faded is not summed.
            [0, 1].into_iter().fold(left, |near, k| {
                let half = b.float(0.5 * size[k]);
                let [_, count] = window(means[k] - centre[k], half, sds[k]);
                near & count.gt(0.0)
            })
        })
        .collect();
    let [touched, count] = bits::set(b, &near);
    let none = vec![b.float(0.0); names.len()];
    let live = fixed.is_none().then_some(offset);
    let captures = (means, sds, nodes.correlation, cells, seed, live, &summed);
    let (_, mut sums) = b.fold(&brick, count, (touched, none), captures);
    for of_one in sums.chunks_mut(ORDERS.len()).take(image.channels()) {
        by_place(of_one, sds);
    }
    let weighted = weight * fade;
    b.result("weights", total + weight);
    for ((name, sum), part) in names.into_iter().zip(state).zip(sums) {
        b.result(name, sum + weighted * part);
    }
    b.finish(module)
}

/// The copies of one more brick of those whose bits are set, the body of a fold.
fn brick(module: &mut Module, bond: Bond, fixed: Option<f32>, image: &Image) -> FunctionRef {
    let row = row(module, image);
    let rows = Rows::of(module, bond);
    let b = &Builder::new("brick_copies", "The copies of one more brick within reach.");
    b.uint_param("index");
    let touched = b.uint_param("touched");
    let names = sums(image);
    let state = declared(b, &names);
    let means = b.float_params(["x", "y"]);
    let sds = b.float_params(["sd_x", "sd_y"]);
    let correlation = b.float_param("correlation");
    let cells = declared_cells(b);
    let seed = b.uint_param("seed");
    let offset = offset_parameter(b, fixed);
    let summed = Summed::declare(b, image);
    let [which, left] = bits::lowest(touched);
    let (centre, size) = rows.brick(which, offset);
    let cell = bond.cell();
    let from = [0, 1].map(|k| means[k] - centre[k] * (1.0 / cell[k]));
    let half = [0, 1].map(|k| size[k] * (0.5 / cell[k]));
    let inverse = sds.map(|sd| 1.0 / sd);
    let [[start_x, count_x], [start_y, count_y]] = [0, 1].map(|k| window(from[k], half[k], sds[k]));
    let place = (
        from,
        half,
        [start_x, start_y],
        count_x,
        inverse,
        correlation,
    );
    let captures = (place, cells, which * BRICK, seed, &summed);
    let sums = b.fold(&row, count_y.to_int().to_uint(), state, captures);
    b.result("touched", left);
    b.results(names, sums);
    b.finish(module)
}
