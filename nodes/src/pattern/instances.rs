//! Figures in the cells of a lattice, each cell with its own: scattered ones of any place and size, or tiles
//! of Truchet's that lie one way or another. They are filtered by a Gaussian footprint, as is any function
//! of their numbers.
//!
//! A figure does not leave its cell, so that none lies over another: the mean is the sum over the figures
//! of their measures times what their numbers give, and what is left of the footprint is the ground, whose
//! number is 0.

mod cell;

pub(crate) use cell::{Kind, Scatter};

use super::disc;
use super::measure::Measure;
use super::region::Whitening;
use super::touch::Touch;
use crate::noise::cell::passed::{Passed, passed};
use crate::noise::cell::{coincidence, deviation, hash, lattice_seed, place, row_word};
use crate::noise::field::Spread;
use crate::noise::things::{
    Filtered, VARIANCE, attach, channels, declared_ensemble, ensemble, named,
};
use cell::{Instance, axes};
use mipless_codegen::ir::{
    Builder, Float, FunctionRef, Int, Module, Scalar, Scalars, Sym2, Uint, Vec2,
};
use mipless_codegen::moments::Signal;
use mipless_codegen::{Ensemble, Image, Lower, pairs};
use std::f32::consts::TAU;

/// How far a footprint reaches, in standard deviations.
const REACH: f32 = 3.2;

/// The most rows or columns of cells that are summed; footprints that need more fade.
const MOST: f32 = 24.0;

/// From how many radii of a figure the minor axis is on, the figure is its area and its covariance.
const ROUND: f32 = 1.0;

/// The filtered figures at a position, for each component of the image that is asked for.
pub(crate) fn filtered<'b>(
    lower: &mut Lower<'_, 'b>,
    position: &[Signal<'b>],
    scatter: &Scatter,
) -> Vec<Signal<'b>> {
    let mode = lower.mode();
    let spread = Spread::of(position);
    // As of cells: a figure is at most as large.
    lower.source_footprint(spread.eigenvalues[0].sqrt() * (1.0 / 3.0));
    let (image, parameters) = lower.image();
    let outline = scatter.outline();
    let shape = mode.filters().then(|| match &outline {
        None => lower.function("disc", disc::function),
        Some(outline) => lower.function(&format!("outline {outline:?}"), |module| {
            outline.function(module)
        }),
    });
    let key = format!("scatter {mode:?} {scatter:?} {}", image.key());
    let function = lower.function(&key, |module| {
        let row = shape.map(|shape| row(module, scatter, &image, &shape));
        let b = &Builder::new("scatter", "Filtered figures of cells.");
        build(b, scatter, &image, row.as_ref(), mode);
        b.finish(module)
    });
    let b = lower.b();
    let ensemble = ensemble(lower, &image, || b.literal(true));
    let results = place::called(
        lower,
        &function,
        (position, &spread),
        (parameters, ensemble),
    );
    let (fields, rest) = results.split_at(results.len().min(3 * image.channels()));
    let mut signals: Vec<Signal<'b>> = if mode.filters() {
        (fields.chunks(3))
            .map(|field| place::field(field, None).at(lower, position))
            .collect()
    } else {
        fields.iter().map(|&value| Signal::certain(value)).collect()
    };
    attach(lower, &image, &mut signals, rest);
    signals
}

passed! {
    /// The footprint: where it is, in cells from where cells are counted, Σ + what divides, and what x has
    /// beyond its row.
    struct Footprint {
        x: Float,
        y: Float,
        xx: Float,
        xy: Float,
        yy: Float,
        minor: Float,
        shear: Float,
        /// How far it reaches along y, and along x from where a y is.
        tall: Float,
        reach: Float,
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

/// Sums over figures: of d, what they are less the ground, of its products, and of both slopes of d.
#[derive(Clone, Debug)]
struct Sums<'b> {
    first: Vec<Float<'b>>,
    second: Vec<Float<'b>>,
    slopes: [Vec<Float<'b>>; 2],
}

impl<'b> Sums<'b> {
    fn zero(b: &'b Builder, channels: usize) -> Self {
        let zero = vec![b.float(0.0); channels];
        Self {
            second: vec![b.float(0.0); pairs(channels).count()],
            slopes: [zero.clone(), zero.clone()],
            first: zero,
        }
    }

    fn names(count: usize) -> Vec<String> {
        named(&[
            ("first", count),
            ("second", pairs(count).count()),
            ("slope_x", count),
            ("slope_y", count),
        ])
    }

    fn declare(b: &'b Builder, channels: usize) -> Self {
        let mut names = Self::names(channels).into_iter();
        let mut next = || names.next().expect("a name for each part");
        Self::zero(b, channels).replaced(&mut || b.float_param(next()).into())
    }

    fn results(&self, b: &'b Builder) {
        b.results(Self::names(self.first.len()), self.scalars());
    }
}

impl<'b> Scalars<'b> for Sums<'b> {
    fn each(&self, visit: &mut dyn FnMut(Scalar<'b>)) {
        [&self.first, &self.second].each(visit);
        self.slopes.each(visit);
    }

    fn replaced(self, next: &mut dyn FnMut() -> Scalar<'b>) -> Self {
        let [first, second] = [self.first, self.second].replaced(next);
        Self {
            first,
            second,
            slopes: self.slopes.replaced(next),
        }
    }
}

/// The measure of a cell's figure and its derivatives by the mean, from which the cell's corner is at an
/// offset.
fn measure<'b>(
    scatter: &Scatter,
    shape: &FunctionRef,
    instance: &Instance<'b>,
    corner: [Float<'b>; 2],
    footprint: &Footprint<'b>,
) -> [Float<'b>; 3] {
    let b = footprint.x.builder();
    let covariance = Sym2([footprint.xx, footprint.xy, footprint.yy]);
    let outline = scatter.outline();
    let square = instance.size.square();
    let is_wide = (!scatter.is_tiled()).then(|| footprint.minor.gt(square * (ROUND * ROUND)));
    let mut sum = [b.float(0.0); 3];
    for [origin, along] in instance.frames(scatter.kind) {
        let offset = [0, 1].map(|k| corner[k] + origin[k]);
        // What is exact is not summed where it is not wanted: there the figure is far away.
        let aside = match is_wide {
            Some(is_wide) => [offset[0] + is_wide.select(1e6, b.float(0.0)), offset[1]],
            None => offset,
        };
        let exact: Measure<'b> = match &outline {
            None => b
                .call(shape, (aside, instance.size, covariance))
                .try_into()
                .expect("a measure"),
            Some(outline) => {
                let edges = scatter.distances(outline);
                let edges = edges.map(|distance| instance.size * distance);
                let touch = Touch::between(Vec2(aside).norm2(), edges, covariance);
                let whitening = Whitening::of(covariance);
                outline.measure(shape, (&whitening, touch), axes(aside, along))
            }
        };
        let wide = is_wide.map(|is_wide| (is_wide, blurred(scatter, square, offset, footprint)));
        for (i, sum) in sum.iter_mut().enumerate() {
            *sum += match wide {
                Some((is_wide, blurred)) => is_wide.select(blurred[i], exact[i]),
                None => exact[i],
            };
        }
    }
    sum.map(|value| instance.is_there.select(value, 0.0))
}

/// The same of a figure that is small against the footprint, by its area and its covariance:
/// A N(d; Σ + v I).
fn blurred<'b>(
    scatter: &Scatter,
    square: Float<'b>,
    offset: [Float<'b>; 2],
    footprint: &Footprint<'b>,
) -> [Float<'b>; 3] {
    let [area, variance] = scatter.moments().map(|x| x as f32);
    let own = square * variance;
    let [xx, xy, yy] = [footprint.xx + own, footprint.xy, footprint.yy + own];
    let determinant = (xx * yy - xy.square()).max(1e-12);
    let inverse = Sym2([yy, -xy, xx]) * (1.0 / determinant);
    let pulled = inverse.times(Vec2(offset));
    let exponent = (Vec2(offset).dot(pulled) * -0.5).max(-80.0);
    let density = exponent.exp() / (determinant.sqrt() * TAU);
    let whole = density * square * area;
    // By the mean, which moves against the offset.
    [whole, whole * pulled[0], whole * pulled[1]]
}

/// One cell of a row, the body of a fold over columns.
fn column(
    module: &mut Module,
    scatter: &Scatter,
    image: &Image,
    shape: &FunctionRef,
) -> FunctionRef {
    let b = &Builder::new("scatter_column", "One cell of a row.");
    let index = b.uint_param("index");
    let count = image.channels();
    let mut sums = Sums::declare(b, count);
    let [start, row] = b.float_params(["start", "row_place"]);
    let footprint = Footprint::declare(b);
    let cells = Cells::declare(b);
    let ground = channels(b, "ground", count);
    let parameters = image.declare(b);
    let column = start + index.to_float();
    let word = hash(
        cells.cell_x + column.to_int(),
        row_word(cells.cell_y + row.to_int(), cells.seed, scatter.period),
        scatter.period,
    );
    let instance = Instance::of(scatter, word);
    let corner = [column - footprint.x, row - footprint.y];
    let [weight, dx, dy] = measure(scatter, shape, &instance, corner, &footprint);
    let d: Vec<Float<'_>> = image
        .of(instance.number, &parameters)
        .into_iter()
        .zip(&ground)
        .map(|(value, &ground)| value - ground)
        .collect();
    for (i, &d) in d.iter().enumerate() {
        sums.first[i] += weight * d;
        sums.slopes[0][i] += dx * d;
        sums.slopes[1][i] += dy * d;
    }
    for (at, (i, k)) in pairs(count).enumerate() {
        sums.second[at] += weight * d[i] * d[k];
    }
    sums.results(b);
    b.finish(module)
}

/// One row of cells, the body of a fold.
fn row(module: &mut Module, scatter: &Scatter, image: &Image, shape: &FunctionRef) -> FunctionRef {
    let column = column(module, scatter, image, shape);
    let b = &Builder::new("scatter_row", "One row of cells.");
    let index = b.uint_param("index");
    let count = image.channels();
    let sums = Sums::declare(b, count);
    let first = b.float_param("first_row");
    let footprint = Footprint::declare(b);
    let cells = Cells::declare(b);
    let ground = channels(b, "ground", count);
    let parameters = image.declare(b);
    let row = first + index.to_float();
    // x given what the footprint has of the row.
    let low = row.max(footprint.y - footprint.tall);
    let high = (row + 1.0).min(footprint.y + footprint.tall);
    let mean = footprint.x + footprint.shear * ((low + high) * 0.5 - footprint.y);
    let half = (high - low).max(0.0) * 0.5;
    let [start, columns] = around(mean, footprint.reach + footprint.shear.abs() * half);
    let captures = (start, row, footprint, cells, &ground, &parameters);
    let sums = b.fold(&column, columns.to_int().to_uint(), sums, captures);
    sums.results(b);
    b.finish(module)
}

/// The cells within a distance: where they start, and how many there are.
fn around<'b>(mean: Float<'b>, reach: Float<'b>) -> [Float<'b>; 2] {
    let start = (mean - reach).floor();
    let count = (mean + reach).floor() - start + 1.0;
    [start, count.clamp(1.0, MOST)]
}

/// 1 below the first number, 0 above the second.
fn falling(x: Float<'_>, [from, to]: [f32; 2]) -> Float<'_> {
    ((to - x) * (1.0 / (to - from))).clamp(0.0, 1.0)
}

/// How much of a footprint has not faded: of this deviation along an axis, and of this width.
fn fading<'b>(sd: Float<'b>, width: Float<'b>, widths: [f32; 2]) -> Float<'b> {
    let longest = (MOST - 2.0) / (2.0 * REACH);
    falling(sd, [longest * (5.0 / 6.0), longest]).min(falling(width, widths))
}

/// What an image is over the figures and the ground.
fn over_all<'b>(
    scatter: &Scatter,
    ground: &[Float<'b>],
    figures: Option<&Ensemble<'b>>,
) -> Ensemble<'b> {
    let covered = scatter.coverage() as f32;
    let b = ground[0].builder();
    let own = Ensemble {
        means: vec![b.float(if scatter.is_mask { 1.0 } else { 0.5 })],
        covariance: vec![b.float(if scatter.is_mask { 0.0 } else { VARIANCE })],
    };
    let figures = figures.unwrap_or(&own);
    let mixed =
        |inside: Float<'b>, outside: Float<'b>| inside * covered + outside * (1.0 - covered);
    let means: Vec<Float<'b>> = (figures.means.iter().zip(ground))
        .map(|(&mean, &ground)| mixed(mean, ground))
        .collect();
    let covariance = pairs(means.len()).enumerate().map(|(at, (i, k))| {
        let inside = figures.covariance[at] + figures.means[i] * figures.means[k];
        mixed(inside, ground[i] * ground[k]) - means[i] * means[k]
    });
    Ensemble {
        covariance: covariance.collect(),
        means,
    }
}

/// The function of a mode: the figure of one cell at a point, else the sums over rows.
fn build(
    b: &Builder,
    scatter: &Scatter,
    image: &Image,
    row: Option<&FunctionRef>,
    mode: mipless_codegen::moments::Mode,
) {
    let (origin, at) = place::declared::<2>(b);
    let parameters = image.declare(b);
    let seed = lattice_seed(b, scatter.seed, 0x3c6e_f372);
    let ground = image.of(b.float(0.0), &parameters);
    let Some(row) = row else {
        let inner = at.map(Float::floor);
        let cell = [0, 1].map(|axis| origin[axis] + inner[axis].to_int());
        let word = hash(
            cell[0],
            row_word(cell[1], seed, scatter.period),
            scatter.period,
        );
        let instance = Instance::of(scatter, word);
        let corner = [0, 1].map(|axis| inner[axis] - at[axis]);
        let inside = instance.holds(scatter, corner);
        let number = inside.select(instance.number, 0.0);
        let values = image.of(number, &parameters);
        b.results(named(&[("mean", values.len())]), values);
        return;
    };
    let figures = declared_ensemble(b, image);
    let Spread {
        covariance,
        eigenvalues,
    } = place::declared_spread(b);
    let [xx, xy, yy] = *covariance;
    let [sd, _] = deviation(xx.max(yy));
    let width = (eigenvalues[0] * eigenvalues[1]).max(0.0).sqrt().sqrt();
    let fade = fading(sd, width, scatter.widths());
    let [sd_y, _] = deviation(yy);
    let shear = xy / (yy + 1e-12);
    // det Σ/Σ₂₂, none of which is a difference.
    let across = (eigenvalues[0] * eigenvalues[1] / (yy + 1e-12)).min(xx);
    let footprint = Footprint {
        x: at[0],
        y: at[1],
        xx,
        xy,
        yy,
        minor: eigenvalues[1],
        shear,
        tall: sd_y * REACH,
        reach: across.max(0.0).sqrt() * REACH,
    };
    let cells = Cells {
        cell_x: origin[0],
        cell_y: origin[1],
        seed,
    };
    let [first, rows] = around(at[1], footprint.tall);
    let rows = fade.le(0.0).select(0u32, rows.to_int().to_uint());
    let none = Sums::zero(b, ground.len());
    let sums = b.fold(
        row,
        rows,
        none,
        (first, footprint, cells, &ground, &parameters),
    );
    let slopes: Vec<Vec2<'_>> = (sums.slopes[0].iter().zip(&sums.slopes[1]))
        .map(|(&x, &y)| Vec2([x, y]))
        .collect();
    let linear = pairs(slopes.len()).map(|(i, k)| slopes[i].dot(covariance.times(slopes[k])));
    let [along, aside] = eigenvalues.map(coincidence);
    let filtered = Filtered {
        linear: linear.collect(),
        first: sums.first,
        second: sums.second,
        slopes: slopes.iter().map(|slope| slope.to_vec()).collect(),
        fade,
        same: along * aside,
        centre: ground.clone(),
    };
    let over_all = over_all(scatter, &ground, figures.as_ref());
    filtered.results(b, mode, Some(&over_all));
}
