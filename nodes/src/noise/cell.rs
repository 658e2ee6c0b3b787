//! One independent number of [0, 1) in every cell of a lattice, filtered by a Gaussian footprint.
//!
//! The weight of a cell is the probability of its box. Within a row of cells the other coordinate is
//! taken for Gaussian, with the mean and the variance that it has given the row: for footprints
//! whose axes are the lattice's that is exact, for others what errs is that a truncated normal's
//! shear is not normal.
//!
//! What is summed is any function of the numbers, or of the cells themselves: the [`Image`] that is
//! asked for.

pub(crate) mod line;
pub(crate) mod passed;
pub(crate) mod place;
pub(crate) mod space;
pub(crate) mod steps;

use super::components::Hash;
use super::field::Spread;
use super::jenkins;
use super::period::wrapped;
use super::things::{
    Filtered, Sums, VARIANCE, attach, channels, declared_ensemble, ensemble, named, weighted,
};
use line::Sums as LineSums;
use mipless_codegen::ir::{Builder, Float, FunctionRef, Int, Module, Scalar, Sym2, Uint, Vec2};
use mipless_codegen::moments::{Mode, Normal, Signal};
use mipless_codegen::{Image, Lower, pairs};
use passed::{Passed, passed};

/// How far a window reaches, in standard deviations; weights are normalised to their sum.
const REACH: f32 = 2.8;

/// The most rows or columns of a window; footprints that need more fade.
pub(crate) const MOST: f32 = 24.0;

/// No footprint is narrower, in squared cells.
const NARROWEST: f32 = 1e-12;

/// A coordinate that is spread by this variance, off the faces of cells where it does not spread at
/// all: a point on a face lies in one cell, a Gaussian of next to no width in two.
pub(crate) fn inside<'b>(coordinate: Float<'b>, variance: Float<'b>) -> Float<'b> {
    coordinate + variance.gt(0.0).select(0.0, 6.0 * NARROWEST.sqrt())
}

/// What the hashes of a row's cells share.
pub(crate) fn row_word<'b>(row: Int<'b>, seed: Uint<'b>, period: i32) -> Uint<'b> {
    wrapped(row, period).to_uint() * 0x9e37_79b1 + seed
}

/// The hash of a cell, given its row's word.
pub(crate) fn hash<'b>(column: Int<'b>, row: Uint<'b>, period: i32) -> Uint<'b> {
    (wrapped(column, period).to_uint() ^ row).scramble()
}

/// The number of [0, 1) in the leading bits of a hash.
pub(crate) fn uniform(hash: Uint<'_>) -> Float<'_> {
    (hash >> 8).to_float() * (1.0 / (1u32 << 24) as f32)
}

/// Which numbers the cells of a plane, or of a layer of space, have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Lattice {
    /// Selects them.
    pub(crate) seed: i32,
    /// After how many cells they repeat; 0 for never.
    pub(crate) period: i32,
    /// Which hash decides.
    pub(crate) hash: Hash,
}

impl Lattice {
    /// The number of a cell of the plane, given the scrambled seed.
    fn in_plane<'b>(self, [column, row]: [Int<'b>; 2], seed: Uint<'b>) -> Float<'b> {
        match self.hash {
            Hash::Mipless => number([column, row], seed, self.period),
            Hash::Materialx => {
                let place = [column, row].map(|cell| wrapped(cell, self.period).to_uint());
                jenkins::unit(jenkins::plane(place, seed))
            }
        }
    }

    /// The number of a cell of space, given what the cells of its layer share.
    fn in_layer<'b>(self, [column, row]: [Int<'b>; 2], layer: Uint<'b>) -> Float<'b> {
        match self.hash {
            Hash::Mipless => number([column, row], layer, self.period),
            Hash::Materialx => {
                let [x, y] = [column, row].map(|cell| wrapped(cell, self.period).to_uint());
                let seed = layer.literal(jenkins::seed(self.seed));
                jenkins::unit(jenkins::space([x, y, layer], seed))
            }
        }
    }

    /// What all cells share.
    fn scrambled(self, b: &Builder, salt: u32) -> Uint<'_> {
        match self.hash {
            Hash::Mipless => lattice_seed(b, self.seed, salt),
            Hash::Materialx => b.uint(jenkins::seed(self.seed)),
        }
    }
}

/// What the image that is summed is a function of.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Content {
    /// The numbers that cells of the plane have.
    InPlane(Lattice),
    /// Those that cells of a layer of space have.
    InLayer(Lattice),
    /// The cells themselves: the whole parts of the two coordinates.
    Wholes,
}

impl Content {
    /// The image of a cell, given what the others share with it.
    fn image<'b>(
        self,
        image: &Image,
        cell: [Int<'b>; 2],
        shared: Uint<'b>,
        parameters: &[Scalar<'b>],
    ) -> Vec<Float<'b>> {
        match self {
            Self::InPlane(lattice) => image.of(lattice.in_plane(cell, shared), parameters),
            Self::InLayer(lattice) => image.of(lattice.in_layer(cell, shared), parameters),
            Self::Wholes => image.of_cell(&cell, parameters),
        }
    }

    /// What all cells share.
    fn scrambled(self, b: &Builder, salt: u32) -> Uint<'_> {
        match self {
            Self::InPlane(lattice) | Self::InLayer(lattice) => lattice.scrambled(b, salt),
            Self::Wholes => b.uint(0),
        }
    }
}

/// The number of a cell, in [0, 1).
pub(crate) fn number<'b>([column, row]: [Int<'b>; 2], seed: Uint<'b>, period: i32) -> Float<'b> {
    uniform(hash(column, row_word(row, seed, period), period))
}

/// The scrambled seed of a lattice; `salt` separates kinds of noise.
pub(crate) fn lattice_seed(b: &Builder, seed: i32, salt: u32) -> Uint<'_> {
    b.uint(seed as u32 ^ salt).scramble()
}

/// The standard deviation of a variance, and its inverse.
pub(crate) fn deviation(variance: Float<'_>) -> [Float<'_>; 2] {
    let sd = (variance + NARROWEST).sqrt();
    [sd, 1.0 / sd]
}

/// Reports a footprint of this standard deviation, in cells.
fn report<'b>(lower: &mut Lower<'_, 'b>, sd: Float<'b>) {
    // The spectrum of a box has half its energy below a third of a cycle per cell.
    lower.source_footprint(sd * (1.0 / 3.0));
}

/// The probability that two independent places of a Gaussian spread along one axis lie in one cell:
/// E[max(1 − |t|, 0)] of their difference t, of standard deviation τ = σ√2.
pub(crate) fn coincidence(variance: Float<'_>) -> Float<'_> {
    let [sd, inverse] = deviation(variance + variance);
    let n = Normal::of(inverse);
    let inside = n.below + -0.5;
    // 2τ(φ(0) − φ(1/τ)).
    let lost = (0.398_942_3 - n.density) * sd;
    ((inside + inside) - (lost + lost)).clamp(0.0, 1.0)
}

/// The filtered cells at a position, for each component of the image that is asked for.
pub(crate) fn filtered<'b>(
    lower: &mut Lower<'_, 'b>,
    position: &[Signal<'b>],
    content: Content,
) -> Vec<Signal<'b>> {
    let mode = lower.mode();
    let spread = Spread::of(position);
    report(lower, spread.eigenvalues[0].sqrt());
    let (image, parameters) = lower.image();
    let key = format!("cells {mode:?} {content:?} {}", image.key());
    let function = lower.function(&key, |module| build(module, mode, content, &image));
    let widest = spread.covariance[0].max(spread.covariance[2]);
    let ensemble = ensemble(lower, &image, || fading(deviation(widest)[0], MOST).lt(1.0));
    let others = (parameters, ensemble);
    let results = place::called(lower, &function, (position, &spread), others);
    let (fields, rest) = results.split_at(results.len().min(3 * image.channels()));
    let mut signals: Vec<Signal<'b>> = (fields.chunks(3))
        .map(|field| place::field(field, None).at(lower, position))
        .collect();
    attach(lower, &image, &mut signals, rest);
    signals
}

/// The window of a standard deviation: where it starts, and how many cells it has.
fn window<'b>(mean: Float<'b>, sd: Float<'b>) -> [Float<'b>; 2] {
    around(mean, sd * REACH, MOST)
}

/// A window over `count` = ⌈2r⌉ + 1 cells, `most` at most, that starts at ⌊m − r⌋.
fn around<'b>(mean: Float<'b>, reach: Float<'b>, most: f32) -> [Float<'b>; 2] {
    let count = 1.0 - (reach * -2.0).floor();
    [(mean - reach).floor(), count.clamp(1.0, most)]
}

/// 1, falling to 0 as a footprint of this standard deviation fills a window of `most` cells.
fn fading(sd: Float<'_>, most: f32) -> Float<'_> {
    let largest = (most - 1.0) / (2.0 * REACH);
    (sd * (-4.0 / largest) + 4.0).clamp(0.0, 1.0)
}

/// How many cells a window has, or none of what has faded.
fn counted<'b>(cells: Float<'b>, fade: Float<'b>) -> Uint<'b> {
    fade.le(0.0).select(0u32, cells.to_int().to_uint())
}

passed! {
    /// What the cells of a row have in common: where its window starts, and the Gaussian in it.
    struct Row {
        start: Float,
        mean: Float,
        inverse_sd: Float,
    }
}

passed! {
    /// Which cells these are.
    struct RowCells {
        cell_x: Int,
        row: Int,
        seed: Uint,
    }
}

/// The cells of one row, the body of a fold over columns.
fn column(module: &mut Module, content: Content, image: &Image) -> FunctionRef {
    let b = &Builder::new("cell_column", "One cell of a row.");
    let index = b.uint_param("index");
    let sums = LineSums::declare(b, image.channels());
    let row = Row::declare(b);
    let centre = channels(b, "centre", image.channels());
    let cells = RowCells::declare(b);
    let parameters = image.declare(b);
    let place = row.start + index.to_float();
    let cell = [cells.cell_x + place.to_int(), cells.row];
    let edge = [place + 1.0 - row.mean, row.inverse_sd];
    let values = content
        .image(image, cell, cells.seed, &parameters)
        .into_iter();
    let d: Vec<Float<'_>> = values
        .zip(centre)
        .map(|(value, centre)| value - centre)
        .collect();
    sums.after(edge, &d).results(b);
    b.finish(module)
}

/// A row of cells, or a layer of rows, under a Gaussian.
struct Slice<'b> {
    /// Its probability.
    weight: Float<'b>,
    /// From the mean to the mean given the slice.
    moved: Float<'b>,
    /// The variance given the slice, and its share of the whole.
    within: Float<'b>,
    share: Float<'b>,
    /// φ at the lower edge less φ at the upper one.
    fall: Float<'b>,
}

impl<'b> Slice<'b> {
    /// Of the cells whose lower edge is at a distance from the mean: a truncated normal.
    fn of(low: Float<'b>, [sd, inverse]: [Float<'b>; 2]) -> Self {
        let high = low + 1.0;
        let [n0, n1] = [low, high].map(|edge| Normal::at(edge, inverse));
        let weight = (n1.below - n0.below).max(0.0);
        let guarded = weight.max(1e-6);
        let fall = n0.density - n1.density;
        let lean = fall / guarded;
        let change = (n0.z * n0.density - n1.z * n1.density) / guarded;
        let left = (change - lean.square() + 1.0).clamp(0.0, 1.0);
        let within = (left * sd.square()).min(VARIANCE);
        Self {
            weight,
            moved: (lean * sd).clamp(low, high),
            within,
            share: within * inverse.square(),
            fall,
        }
    }

    /// The derivative by the mean of a sum over the slice, of which the mean given the slice and the
    /// derivative by what the slice shifts, times by how much, are known: of the weight, and of the
    /// shift, which lags behind by dμ/dm − 1 with dμ/dm = var/σ².
    fn slope(&self, inverse: Float<'b>, first: Float<'b>, shifted: Float<'b>) -> Float<'b> {
        self.fall * inverse * first + (self.share + -1.0) * self.weight * shifted
    }
}

passed! {
    /// What the rows of a plane have in common: where their window starts, and the place.
    struct Rows {
        start: Float,
        x: Float,
        y: Float,
    }
}

passed! {
    /// Which cells these are, the Gaussian along y, and what x has by it and beyond it.
    struct RowsCells {
        cell_x: Int,
        cell_y: Int,
        seed: Uint,
        sd_y: Float,
        inverse_sd_y: Float,
        shear: Float,
        variance_across: Float,
    }
}

/// One row of cells, the body of a fold.
fn row(module: &mut Module, content: Content, image: &Image) -> FunctionRef {
    let column = column(module, content, image);
    let b = &Builder::new("cell_row", "One row of cells.");
    let index = b.uint_param("index");
    let count = image.channels();
    let sums = Sums::declare(b, count);
    let rows = Rows::declare(b);
    let centre = channels(b, "centre", count);
    let cells = RowsCells::declare(b);
    let parameters = image.declare(b);
    let place = rows.start + index.to_float();
    let slice = Slice::of(place - rows.y, [cells.sd_y, cells.inverse_sd_y]);

    // x given the row.
    let mean = rows.x + cells.shear * slice.moved;
    let variance = cells.variance_across + cells.shear.square() * slice.within;
    let [sd, inverse_sd] = deviation(variance);

    // The cells that count lie within an ellipse.
    let aside = (slice.moved * cells.inverse_sd_y).square();
    let left = (aside * (-1.0 / (REACH * REACH)) + 1.0).max(0.0).sqrt();
    let [start, columns] = around(mean, sd * REACH * left, MOST);
    let line = Row {
        start,
        mean,
        inverse_sd,
    };
    let of_row = RowCells {
        cell_x: cells.cell_x,
        row: cells.cell_y + place.to_int(),
        seed: cells.seed,
    };
    let before = LineSums::start([start - mean, inverse_sd], count);
    let captures = (line, &centre, of_row, &parameters);
    let of_row = b.fold(&column, columns.to_int().to_uint(), before, captures);
    let [first, second, slope] = of_row.averages();
    let slope: Vec<Float<'_>> = slope.iter().map(|&slope| slope * inverse_sd).collect();
    let weight = slice.weight;
    Sums {
        weight: sums.weight + weight,
        first: weighted(sums.first, weight, &first),
        second: weighted(sums.second, weight, &second),
        slope_x: weighted(sums.slope_x, weight, &slope),
        slope_y: (sums.slope_y.into_iter().zip(first).zip(slope))
            .map(|((sum, first), slope)| {
                sum + slice.slope(cells.inverse_sd_y, first, cells.shear * slope)
            })
            .collect(),
    }
    .results(b);
    b.finish(module)
}

/// The cells around a place of a plane.
struct Cells<'b> {
    /// The image of the number at the centre.
    centre: Vec<Float<'b>>,
    /// Where the place is counted from.
    origin: [Int<'b>; 2],
    seed: Uint<'b>,
    /// How much has not faded.
    fade: Float<'b>,
    /// What the image reads of the graph's inputs.
    parameters: Vec<Scalar<'b>>,
}

/// Sums over the cells of a plane, relative to what is at the centre: means of d and of its products,
/// and the slopes of the means of d.
struct Plane<'b> {
    first: Vec<Float<'b>>,
    second: Vec<Float<'b>>,
    slopes: Vec<Vec2<'b>>,
}

impl<'b> Plane<'b> {
    /// Of a Gaussian at a place, from the cells there: its Σ and det Σ, none of which is a difference.
    fn of(
        row: &FunctionRef,
        [x, y]: [Float<'b>; 2],
        (Sym2([s_xx, s_xy, s_yy]), determinant): (Sym2<'b>, Float<'b>),
        cells: &Cells<'b>,
    ) -> Self {
        let b = x.builder();
        let raised = s_yy + NARROWEST;
        let [sd_y, inverse_sd_y] = deviation(s_yy);
        let [start, count] = window(y, sd_y);
        let rows = Rows { start, x, y };
        let of_rows = RowsCells {
            cell_x: cells.origin[0],
            cell_y: cells.origin[1],
            seed: cells.seed,
            sd_y,
            inverse_sd_y,
            shear: s_xy / raised,
            // det Σ/Σ₂₂, of what is raised.
            variance_across: ((determinant + s_xx * NARROWEST) / raised).min(s_xx),
        };
        let before = Sums::zero(b, cells.centre.len());
        let captures = (rows, &cells.centre, of_rows, &cells.parameters);
        let sums = b.fold(row, counted(count, cells.fade), before, captures);
        let scale = 1.0 / sums.weight.max(1e-6);
        let scaled = |sums: Vec<Float<'b>>| sums.into_iter().map(|sum| sum * scale).collect();
        let slopes = sums.slope_x.into_iter().zip(sums.slope_y);
        Self {
            first: scaled(sums.first),
            second: scaled(sums.second),
            slopes: slopes.map(|(x, y)| Vec2([x, y]) * scale).collect(),
        }
    }
}

fn build(module: &mut Module, mode: Mode, content: Content, image: &Image) -> FunctionRef {
    let row = (mode.filters()).then(|| row(module, content, image));
    let b = &Builder::new("cells", "Filtered random cells.");
    let (origin, at) = place::declared::<2>(b);
    let parameters = image.declare(b);
    let seed = content.scrambled(b, 0xbb67_ae85);
    let inner = [0, 1].map(|axis| origin[axis] + at[axis].floor().to_int());
    let centre = content.image(image, inner, seed, &parameters);
    let Some(row) = row else {
        b.results(named(&[("mean", centre.len())]), centre);
        return b.finish(module);
    };
    let ensemble = declared_ensemble(b, image);
    let Spread {
        covariance,
        eigenvalues,
    } = place::declared_spread(b);

    // Windows that would be too large fade.
    let widest = covariance[0].max(covariance[2]);
    let [sd, _] = deviation(widest);
    let cells = Cells {
        centre,
        origin,
        seed,
        fade: fading(sd, MOST),
        parameters,
    };
    let determinant = eigenvalues[0] * eigenvalues[1];
    let at = [inside(at[0], covariance[0]), inside(at[1], covariance[2])];
    let plane = Plane::of(&row, at, (covariance, determinant), &cells);
    let [along, across] = eigenvalues.map(coincidence);
    let linear = pairs(plane.slopes.len())
        .map(|(i, k)| plane.slopes[i].dot(covariance.times(plane.slopes[k])));
    let filtered = Filtered {
        linear: linear.collect(),
        centre: cells.centre,
        first: plane.first,
        second: plane.second,
        slopes: plane.slopes.iter().map(|slopes| slopes.to_vec()).collect(),
        fade: cells.fade,
        same: along * across,
    };
    filtered.results(b, mode, ensemble.as_ref());
    b.finish(module)
}
