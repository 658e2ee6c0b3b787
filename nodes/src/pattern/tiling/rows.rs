//! The figures of a tiling one by one: rows that are within reach of the footprint, and of each row
//! the columns.

use super::REACH;
use super::lattice::Lattice;
use crate::pattern::disc;
use crate::pattern::measure::{Measure, NAMES};
use crate::pattern::region::{Outline, Whitening};
use crate::pattern::touch::Touch;
use mipless_codegen::ir::{Builder, Float, FunctionRef, Module, Scalar, Scalars, Sym2, Uint};

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
pub(super) enum Size<'b> {
    /// Known when the graph is compiled.
    Known(f32),
    /// A parameter.
    Live(Float<'b>),
}

impl<'b> Size<'b> {
    /// The size, or the next parameter.
    pub(super) fn declare(b: &'b Builder, known: Option<f32>) -> Self {
        match known {
            Some(size) => Self::Known(size),
            None => Self::Live(b.float_param("size")),
        }
    }

    /// What is so long at size 1.
    pub(super) fn times(self, b: &'b Builder, length: f64) -> Float<'b> {
        match self {
            Self::Known(size) => b.float((f64::from(size) * length) as f32),
            Self::Live(size) => size * length as f32,
        }
    }
}

/// What a function takes for [`Size::declare`].
impl<'b> Scalars<'b> for Size<'b> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        if let Self::Live(size) = self {
            size.each(visit);
        }
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        match self {
            Self::Known(size) => Self::Known(size),
            Self::Live(size) => Self::Live(size.replaced(next)),
        }
    }
}

/// The figures of one more row, the body of a fold.
pub(super) fn row_function(
    module: &mut Module,
    lattice: Lattice,
    figures: &[Figure],
    known: Option<f32>,
) -> FunctionRef {
    let functions: Vec<FunctionRef> = (figures.iter())
        .map(|figure| figure_function(module, &figure.shape, known))
        .collect();
    let b = &Builder::new("tiling_row", "One more row of a tiling.");
    let index = b.uint_param("index");
    let mut sums = b.float_params(NAMES);
    let [x, y] = b.float_params(["x", "y"]);
    let [first, slope, sd] = b.float_params(["first", "slope", "sd"]);
    let whitening = Whitening::declare(b);
    let covariance = Sym2(b.float_params(["xx", "xy", "yy"]));
    let size = Size::declare(b, known);
    let row = first + index.to_float();
    let up = row * lattice.row() as f32 + lattice.origin() as f32 - y;
    let mut from = x + -lattice.origin() as f32;
    if lattice.alternates() {
        // Odd rows are shifted by half a cell.
        let half = row * 0.5;
        from -= half - half.floor();
    }
    for (figure, function) in figures.iter().zip(&functions) {
        let [dx, dy] = figure.at.map(|x| x as f32);
        let up = up + dy + size.times(b, figure.rise);
        let from = from + -dx;
        let reach = size.times(b, figure.reach);
        let (start, count) = columns((from, up), reach, (covariance, slope, sd));
        let captures = ([start, from, up], whitening, covariance, size);
        let parts = b.fold(function, count, [b.float(0.0); 6], captures);
        sums = std::array::from_fn(|i| sums[i] + parts[i]);
    }
    b.results(NAMES, sums);
    b.finish(module)
}

/// The first column of a row and how many: those around the line that the footprint follows, or all
/// that it covers, if that is less. The row is higher than the mean by `up`, and the mean lies at
/// `from`; a figure is within `reach` of its site.
fn columns<'b>(
    (from, up): (Float<'b>, Float<'b>),
    reach: Float<'b>,
    (covariance, slope, sd): (Sym2<'b>, Float<'b>, Float<'b>),
) -> (Float<'b>, Uint<'b>) {
    let [xx, xy, _] = *covariance;
    let left = (xx - slope * xy).max(0.0).sqrt() * REACH;
    let narrow = left + (slope.abs() + 1.0) * reach;
    let wide = xx.sqrt() * REACH + reach;
    let extent = narrow.min(wide);
    let limit = sd * REACH;
    let shift = slope * up.clamp(-limit, limit);
    let middle = from + narrow.lt(wide).select(shift, 0.0);
    let below = (middle - extent).floor();
    let last = (middle + extent).floor();
    let count = (last - below).clamp(0.0, 16.0);
    (below + 1.0, count.to_int().to_uint())
}

/// One more figure of a row, the body of a fold.
fn figure_function(module: &mut Module, shape: &Shape, known: Option<f32>) -> FunctionRef {
    let own = match shape {
        Shape::Polygon(outline) => outline.function(module),
        Shape::Disc(_) => disc::function(module),
    };
    let b = &Builder::new("tiling_figure", "One more figure of a row.");
    let index = b.uint_param("index");
    let state = b.float_params(NAMES);
    let [start, from, up] = b.float_params(["start", "from", "up"]);
    let whitening = Whitening::declare(b);
    let covariance = Sym2(b.float_params(["xx", "xy", "yy"]));
    let size = Size::declare(b, known);
    let across = start + index.to_float() - from;
    let measure: Measure<'_> = match shape {
        Shape::Polygon(outline) => {
            let (zero, one) = (b.float(0.0), size.times(b, 1.0));
            let axes = [[across, up], [one, zero], [zero, one], [zero, zero]];
            let edges = outline.distances();
            let edges = edges.map(|distance| size.times(b, f64::from(distance)));
            let touch = Touch::between(across * across + up * up, edges, covariance);
            outline.measure(&own, (&whitening, touch), axes)
        }
        Shape::Disc(radius) => {
            let radius = size.times(b, *radius);
            let results = b.call(&own, ([across, up, radius], covariance));
            results.try_into().expect("a measure")
        }
    };
    b.sums(NAMES, state, measure);
    b.finish(module)
}
