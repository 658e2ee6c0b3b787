//! Figures that stand at the sites of a lattice.
//!
//! Footprints whose minor axis is below [`CROSSOVER`] and whose major axis is below [`LONGEST`] sum
//! the exact measures of the figures near them (`rows`). For all others the figures are a Fourier
//! series of the lattice (`series`), damped by e^{−2π²kᵀΣk}, exact for any covariance that is wide
//! enough for the highest frequency of the table: beyond 0.69/σ everything is below 2e-4. A footprint
//! that is longer and thinner than that is widened, gradually from 0.7 of that length.
//!
//! What stands there is a [`Tile`], whose series is integrated when the graph is compiled, or the
//! [`hatch`], whose series is a closed form of a size that may be known only when the shader runs.

pub(crate) mod hatch;
mod lattice;
mod rows;
mod series;
mod tile;

pub(crate) use lattice::Lattice;
pub(crate) use tile::Tile;

use super::figure::sharp;
use super::measure::{Measure, NAMES};
use super::region::Whitening;
use super::separable::{finished_signal, phase};
use crate::noise::field::Spread;
use mipless_codegen::Lower;
use mipless_codegen::ir::{Bool, Builder, Float, FunctionRef, Module, Sym2};
use mipless_codegen::moments::{Mode, Signal};
use rows::{Figure, Size, row_function};
use series::{Harmonics, kept_row};

/// Standard deviations of the minor axis from which the series is used, in cells.
const CROSSOVER: f32 = 0.16;

/// The longest major axis over which figures are summed one by one, in cells.
const LONGEST: f32 = 1.3;

/// The highest frequency of a series by the least standard deviation of the minor axis, in cells.
fn highest(thinnest: f32) -> f64 {
    0.688 / f64::from(thinnest)
}

/// How far a footprint reaches, in standard deviations.
const REACH: f32 = 3.6;

/// A place in the unit cell, in cells.
type Place<'b> = [Float<'b>; 2];

/// Whether a place lies inside a figure.
type Inside<'b> = Box<dyn Fn(Place<'b>) -> Bool<'b> + 'b>;

/// What repeats, and where.
pub(crate) struct Tiling<'b> {
    /// Names what the figures and their series depend on, beyond lattice and size.
    key: String,
    lattice: Lattice,
    /// The factor of all figures, which may be known only when the shader runs.
    size: Float<'b>,
    /// The figures of a site, which are disjoint.
    figures: Vec<Figure>,
    /// How far figures reach above and below their row, at any size.
    extent: f64,
    harmonics: Harmonics,
    /// The least standard deviation of the minor axis for which these suffice, in cells.
    thinnest: f32,
    inside: Inside<'b>,
    /// Whether the figures are 0 and the rest is 1.
    holes: bool,
}

/// The tiling at a position in unit cells.
pub(crate) fn tiled<'b>(
    lower: &mut Lower<'_, 'b>,
    position: &[Signal<'b>; 2],
    tiling: &Tiling<'b>,
) -> Signal<'b> {
    let height = tiling.lattice.height() as f32;
    let [x, y] = [phase(&position[0]), phase(&position[1]) * height];
    if lower.mode() == Mode::Point || position.iter().all(Signal::is_certain) {
        let inside = (tiling.inside)([x, y]);
        let [within, beyond] = if tiling.holes { [0.0, 1.0] } else { [1.0, 0.0] };
        let signal = Signal::certain(inside.select(within, beyond));
        return finished_signal(lower, signal, true);
    }
    // In cells, without the integer parts, of which nothing depends.
    let plain = |signal: &Signal<'b>, mean: Float<'b>| Signal {
        mean,
        cell: None,
        ..signal.clone()
    };
    let tall = plain(&position[1], phase(&position[1])) * height;
    let flat = [plain(&position[0], x), plain(&tall, y)];
    let spread = Spread::of(&flat);
    let known = tiling.size.as_constant();
    let key = format!("tiling {:?} {} {known:?}", tiling.lattice, tiling.key);
    let function = lower.function(&key, |module| tiling_function(module, tiling, known));
    let size = known.is_none().then_some(tiling.size);
    let arguments = ([x, y], spread.covariance, spread.eigenvalues, size);
    let results = lower.b().call(&function, arguments);
    let mut measure: Measure<'b> = results.try_into().expect("a measure");
    if tiling.holes {
        measure = measure.map(|part| -part);
        measure[0] += 1.0;
    }
    let signal = sharp(lower.mode(), measure, &spread).at(lower, &flat);
    finished_signal(lower, signal, true)
}

/// The measure of all figures: x, y, Σ and its eigenvalues, and the size if it is not known.
fn tiling_function(module: &mut Module, tiling: &Tiling<'_>, known: Option<f32>) -> FunctionRef {
    let (lattice, harmonics) = (tiling.lattice, &tiling.harmonics);
    let kept = module.table("kept_harmonics", harmonics.kept());
    let series = harmonics.function(module);
    let row = row_function(module, lattice, &tiling.figures, known);
    let b = &Builder::new("tiling", "The share of a footprint that lies in figures.");
    let place = b.float_params(["x", "y"]);
    let covariance = Sym2(b.float_params(["xx", "xy", "yy"]));
    let [more, less] = b.float_params(["more", "less"]);
    let size = Size::declare(b, known);
    let single = less.lt(CROSSOVER * CROSSOVER) & more.lt(LONGEST * LONGEST);

    // Σ + (s² − λ₂) along the minor axis, with s from 0 where the major axis is 0.7 of the longest to
    // the thinnest where it is all of it.
    let share = (more.sqrt() * (1.0 / (0.3 * LONGEST)) + -0.7 / 0.3).clamp(0.0, 1.0);
    let target = (share * tiling.thinnest).square();
    let lack = (target - less).max(0.0);
    let span = more - less + 1e-12;
    let round = span.lt(lack);
    let share = round.select(0.0, lack / span);
    let both = round.select(lack, 0.0);
    // λ₁ − Σ is (λ₁ − λ₂) times the projector on the minor axis.
    let [xx, xy, yy] = *covariance;
    let [xx, yy] = [xx, yy].map(|v| v + share * (more - v) + both);
    let xy = xy + share * -xy;
    let widened = Sym2([xx, xy, yy]);

    // One by one: rows within reach of the footprint.
    let raised = yy + 1e-12;
    let sd = raised.sqrt();
    let extent = sd * REACH + tiling.extent as f32;
    let from = place[1] + -lattice.origin() as f32;
    let step = 1.0 / lattice.row() as f32;
    let below = ((from - extent) * step).floor();
    let last = ((from + extent) * step).floor();
    let most = if lattice.row() < 0.6 { 32.0 } else { 16.0 };
    let rows = (last - below).clamp(0.0, most);
    let rows = single.select(rows, 0.0).to_int().to_uint();
    let whitening = Whitening::of(widened);
    let line = [below + 1.0, xy / raised, sd];
    let none = [b.float(0.0); 6];
    let near = b.fold(&row, rows, none, (place, line, whitening, widened, size));

    // All at once, where Σ is wide enough or has been made so.
    // The widened minor axis is at least this, wherever the series is read.
    let minor = less.max(target).sqrt();
    let count = b.load(kept, kept_row(minor)).to_int().to_uint();
    let count = single.select(0, count);
    let mut start = none;
    start[0] = harmonics.mean(b, size);
    let far = b.fold(&series, count, start, (place, widened, size));
    for (i, name) in NAMES.into_iter().enumerate() {
        b.result(name, single.select(near[i], far[i]));
    }
    b.finish(module)
}
