//! The figures of a tiling one by one: rows that are within reach of the footprint, and of each row
//! the columns.

use super::{REACH, Tiling};
use crate::pattern::measure::{Measure, NAMES};
use crate::pattern::region::{Outline, Whitening, disc_function};
use crate::pattern::touch::Touch;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};

/// The form of a figure.
#[derive(Clone, Debug)]
pub(super) enum Shape {
    /// A disc of a radius.
    Disc(f64),
    /// A polygon around its origin.
    Polygon(Outline),
}

/// One of the figures of a site.
pub(super) struct Figure {
    /// The form at size 1.
    pub(super) shape: Shape,
    /// From its origin to the farthest point, at size 1.
    pub(super) reach: f64,
    /// Where its origin is from the site, at size 0.
    pub(super) at: [f64; 2],
    /// By how much the origin is higher at size 1.
    pub(super) rise: f64,
}

/// The size of figures inside a function.
#[derive(Clone, Copy)]
pub(super) enum Size {
    /// Known when the graph is compiled.
    Known(f32),
    /// A parameter.
    Live(Value),
}

impl Size {
    /// The size, or the next parameter.
    pub(super) fn declare(b: &mut Builder, known: Option<f32>) -> Self {
        match known {
            Some(size) => Self::Known(size),
            None => Self::Live(b.param_f32("size")),
        }
    }

    /// The number that a function needs for [`Self::declare`].
    pub(super) fn captures(self) -> Option<Value> {
        match self {
            Self::Known(_) => None,
            Self::Live(size) => Some(size),
        }
    }

    /// What is so long at size 1.
    pub(super) fn times(self, b: &mut Builder, length: f64) -> Value {
        match self {
            Self::Known(size) => b.f32((f64::from(size) * length) as f32),
            Self::Live(size) => b.scale(size, length as f32),
        }
    }
}

/// The figures of one more row, the body of a fold.
pub(super) fn row_function(
    module: &mut Module,
    tiling: &Tiling,
    known: Option<f32>,
) -> FunctionRef {
    let lattice = tiling.lattice;
    let functions: Vec<FunctionRef> = (tiling.figures.iter())
        .map(|figure| figure_function(module, &figure.shape, known))
        .collect();
    let mut b = Builder::new("tiling_row", "One more row of a tiling.");
    let index = b.param("index", Type::U32);
    let state = NAMES.map(|name| b.param_f32(name));
    let place = [b.param_f32("x"), b.param_f32("y")];
    let [first, slope, sd] = ["first", "slope", "sd"].map(|name| b.param_f32(name));
    let whitening = Whitening::declare(&mut b);
    let covariance = ["xx", "xy", "yy"].map(|name| b.param_f32(name));
    let size = Size::declare(&mut b, known);
    let number = b.float_u(index);
    let row = b.add(first, number);
    let height = b.scale(row, lattice.row() as f32);
    let height = b.offset(height, lattice.origin() as f32);
    let up = b.sub(height, place[1]);
    let mut from = b.offset(place[0], -lattice.origin() as f32);
    if lattice.alternates() {
        // Odd rows are shifted by half a cell.
        let half = b.scale(row, 0.5);
        let even = b.floor(half);
        let shift = b.sub(half, even);
        from = b.sub(from, shift);
    }
    let mut sums = state;
    for (figure, function) in tiling.figures.iter().zip(&functions) {
        let [dx, dy] = figure.at.map(|x| x as f32);
        let rise = size.times(&mut b, figure.rise);
        let up = b.offset(up, dy);
        let up = b.add(up, rise);
        let from = b.offset(from, -dx);
        let reach = (size, figure.reach);
        let [start, count] = columns(&mut b, (from, up), reach, (covariance, slope, sd));
        let mut captures = vec![start, from, up];
        captures.extend(whitening.captures());
        captures.extend(covariance);
        captures.extend(size.captures());
        let zero = b.f32(0.0);
        let parts = b.fold(function, count, &[zero; 6], &captures);
        sums = std::array::from_fn(|i| b.add(sums[i], parts[i]));
    }
    for (name, sum) in NAMES.into_iter().zip(sums) {
        b.result(name, sum);
    }
    b.finish(module)
}

/// The first column of a row and how many, as u32: those around the line that the footprint follows,
/// or all that it covers, if that is less. The row is higher than the mean by `up`, and the mean lies
/// at `from`.
fn columns(
    b: &mut Builder,
    (from, up): (Value, Value),
    (size, reach): (Size, f64),
    ([xx, xy, _], slope, sd): ([Value; 3], Value, Value),
) -> [Value; 2] {
    let zero = b.f32(0.0);
    let along = b.mul(slope, xy);
    let left = b.sub(xx, along);
    let left = b.max(left, zero);
    let left = b.sqrt(left);
    let left = b.scale(left, REACH);
    let steep = b.abs(slope);
    let steep = b.offset(steep, 1.0);
    let reach = size.times(b, reach);
    let steep = b.mul(steep, reach);
    let narrow = b.add(left, steep);
    let wide = b.sqrt(xx);
    let wide = b.scale(wide, REACH);
    let wide = b.add(wide, reach);
    let follows = b.lt(narrow, wide);
    let extent = b.min(narrow, wide);
    let limit = b.scale(sd, REACH);
    let back = b.neg(limit);
    let shift = b.max(up, back);
    let shift = b.min(shift, limit);
    let shift = b.mul(slope, shift);
    let shift = b.select(follows, shift, zero);
    let middle = b.add(from, shift);
    let (low, high) = (b.sub(middle, extent), b.add(middle, extent));
    let (below, last) = (b.floor(low), b.floor(high));
    let start = b.offset(below, 1.0);
    let count = b.sub(last, below);
    let count = b.clamp(count, 0.0, 16.0);
    let count = b.trunc_i(count);
    [start, b.cast_u(count)]
}

/// One more figure of a row, the body of a fold.
fn figure_function(module: &mut Module, shape: &Shape, known: Option<f32>) -> FunctionRef {
    let own = match shape {
        Shape::Polygon(outline) => outline.function(module),
        Shape::Disc(_) => disc_function(module),
    };
    let mut b = Builder::new("tiling_figure", "One more figure of a row.");
    let index = b.param("index", Type::U32);
    let state = NAMES.map(|name| b.param_f32(name));
    let [start, from, up] = ["start", "from", "up"].map(|name| b.param_f32(name));
    let whitening = Whitening::declare(&mut b);
    let covariance = ["xx", "xy", "yy"].map(|name| b.param_f32(name));
    let size = Size::declare(&mut b, known);
    let number = b.float_u(index);
    let column = b.add(start, number);
    let across = b.sub(column, from);
    let measure: Measure = match shape {
        Shape::Polygon(outline) => {
            let (zero, one) = (b.f32(0.0), size.times(&mut b, 1.0));
            let axes = [[across, up], [one, zero], [zero, one], [zero, zero]];
            let edges = outline.distances();
            let edges = edges.map(|distance| size.times(&mut b, f64::from(distance)));
            let square = b.dot(&[across, up], &[across, up]);
            let touch = Touch::between(&mut b, square, edges, covariance);
            outline.measure(&mut b, &own, (&whitening, touch), axes)
        }
        Shape::Disc(radius) => {
            let radius = size.times(&mut b, *radius);
            let mut arguments = vec![across, up, radius];
            arguments.extend(covariance);
            let results = b.call(&own, &arguments);
            std::array::from_fn(|i| results[i])
        }
    };
    for ((name, sum), part) in NAMES.into_iter().zip(state).zip(measure) {
        let sum = b.add(sum, part);
        b.result(name, sum);
    }
    b.finish(module)
}
