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
use mipless_codegen::ir::{Builder, FunctionRef, Module, Value};
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
type Place = [Value; 2];

/// Whether a place lies inside a figure.
type Inside = Box<dyn Fn(&mut Builder, Place) -> Value>;

/// What repeats, and where.
pub(crate) struct Tiling {
    /// Names what the figures and their series depend on, beyond lattice and size.
    key: String,
    lattice: Lattice,
    /// The factor of all figures, which may be known only when the shader runs.
    size: Value,
    /// The figures of a site, which are disjoint.
    figures: Vec<Figure>,
    /// How far figures reach above and below their row, at any size.
    extent: f64,
    harmonics: Harmonics,
    /// The least standard deviation of the minor axis for which these suffice, in cells.
    thinnest: f32,
    inside: Inside,
    /// Whether the figures are 0 and the rest is 1.
    holes: bool,
}

/// The tiling at a position in unit cells.
pub(crate) fn tiled(lower: &mut Lower<'_>, position: &[Signal; 2], tiling: &Tiling) -> Signal {
    let height = tiling.lattice.height() as f32;
    let mode = lower.mode();
    let b = lower.b();
    let place = [0, 1].map(|i| phase(b, &position[i]));
    let place = [place[0], b.scale(place[1], height)];
    let certain = position.iter().all(|axis| axis.is_certain(b));
    if mode == Mode::Point || certain {
        let inside = (tiling.inside)(b, place);
        let [within, beyond] = if tiling.holes { [0.0, 1.0] } else { [1.0, 0.0] };
        let (within, beyond) = (b.f32(within), b.f32(beyond));
        let value = b.select(inside, within, beyond);
        let signal = Signal::certain(b, value);
        return finished_signal(lower, signal, true);
    }
    // In cells, without the integer parts, of which nothing depends.
    let by = b.f32(height);
    let flat = [0, 1].map(|i| Signal {
        mean: place[i],
        cell: None,
        ..position[i].clone()
    });
    let tall = flat[1].scale(b, by);
    let flat = [
        flat[0].clone(),
        Signal {
            mean: place[1],
            ..tall
        },
    ];
    let spread = Spread::of(b, &flat);
    let known = b.as_constant(tiling.size);
    let key = format!("tiling {:?} {} {known:?}", tiling.lattice, tiling.key);
    let function = lower.function(&key, |module| tiling_function(module, tiling, known));
    let b = lower.b();
    let mut arguments = place.to_vec();
    arguments.extend(spread.covariance);
    arguments.extend(spread.eigenvalues);
    arguments.extend(known.is_none().then_some(tiling.size));
    let results = b.call(&function, &arguments);
    let mut measure: Measure = std::array::from_fn(|i| results[i]);
    if tiling.holes {
        measure = measure.map(|part| b.neg(part));
        measure[0] = b.offset(measure[0], 1.0);
    }
    let field = sharp(lower, measure, &spread);
    let signal = field.at(lower, &flat);
    finished_signal(lower, signal, true)
}

/// The measure of all figures: x, y, Σ and its eigenvalues, and the size if it is not known.
fn tiling_function(module: &mut Module, tiling: &Tiling, known: Option<f32>) -> FunctionRef {
    let (lattice, harmonics) = (tiling.lattice, &tiling.harmonics);
    let kept = module.table("kept_harmonics", harmonics.kept());
    let series = harmonics.function(module);
    let row = row_function(module, tiling, known);
    let mut b = Builder::new("tiling", "The share of a footprint that lies in figures.");
    let place = [b.param_f32("x"), b.param_f32("y")];
    let covariance = ["xx", "xy", "yy"].map(|name| b.param_f32(name));
    let [more, less] = ["more", "less"].map(|name| b.param_f32(name));
    let size = Size::declare(&mut b, known);
    let zero = b.f32(0.0);
    let (crossover, longest) = (b.f32(CROSSOVER * CROSSOVER), b.f32(LONGEST * LONGEST));
    let (thin, short) = (b.lt(less, crossover), b.lt(more, longest));
    let single = b.and(thin, short);

    // Σ + (s² − λ₂) along the minor axis, with s from 0 where the major axis is 0.7 of the longest to
    // the thinnest where it is all of it.
    let [xx, xy, yy] = covariance;
    let length = b.sqrt(more);
    let share = b.scale(length, 1.0 / (0.3 * LONGEST));
    let share = b.offset(share, -0.7 / 0.3);
    let share = b.clamp(share, 0.0, 1.0);
    let target = b.scale(share, tiling.thinnest);
    let target = b.square(target);
    let lack = b.sub(target, less);
    let lack = b.max(lack, zero);
    let span = b.sub(more, less);
    let span = b.offset(span, 1e-12);
    let share = b.div(lack, span);
    let round = b.lt(span, lack);
    let share = b.select(round, zero, share);
    let both = b.select(round, lack, zero);
    // λ₁ − Σ is (λ₁ − λ₂) times the projector on the minor axis.
    let widened = [(xx, true), (xy, false), (yy, true)].map(|(v, diagonal)| {
        let (other, even) = if diagonal {
            (b.sub(more, v), both)
        } else {
            (b.neg(v), zero)
        };
        let part = b.mul(share, other);
        let sum = b.add(v, part);
        b.add(sum, even)
    });
    // One by one: rows within reach of the footprint.
    let [_, xy, yy] = widened;
    let raised = b.offset(yy, 1e-12);
    let sd = b.sqrt(raised);
    let extent = b.scale(sd, REACH);
    let extent = b.offset(extent, tiling.extent as f32);
    let step = lattice.row() as f32;
    let from = b.offset(place[1], -lattice.origin() as f32);
    let (low, high) = (b.sub(from, extent), b.add(from, extent));
    let (low, high) = (b.scale(low, 1.0 / step), b.scale(high, 1.0 / step));
    let (below, last) = (b.floor(low), b.floor(high));
    let first = b.offset(below, 1.0);
    let rows = b.sub(last, below);
    let rows = b.clamp(rows, 0.0, 16.0);
    let rows = b.select(single, rows, zero);
    let rows = b.trunc_i(rows);
    let rows = b.cast_u(rows);
    let whitening = Whitening::of(&mut b, widened);
    let slope = b.div(xy, raised);
    let mut captures = vec![place[0], place[1], first, slope, sd];
    captures.extend(whitening.captures());
    captures.extend(widened);
    captures.extend(size.captures());
    let near = b.fold(&row, rows, &[zero; 6], &captures);
    let near: Measure = std::array::from_fn(|i| near[i]);

    // All at once, where Σ is wide enough or has been made so.
    // The widened minor axis is at least this, wherever the series is read.
    let minor = b.max(less, target);
    let sd = b.sqrt(minor);
    let row = kept_row(&mut b, sd);
    let count = b.load(kept, row);
    let count = b.trunc_i(count);
    let count = b.cast_u(count);
    let none = b.u32(0);
    let count = b.select(single, none, count);
    let mut captures = place.to_vec();
    captures.extend(widened);
    captures.extend(size.captures());
    let start = harmonics.mean(&mut b, size);
    let far = b.fold(
        &series,
        count,
        &[start, zero, zero, zero, zero, zero],
        &captures,
    );
    for (i, name) in NAMES.into_iter().enumerate() {
        let value = b.select(single, near[i], far[i]);
        b.result(name, value);
    }
    b.finish(module)
}
