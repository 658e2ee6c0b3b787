//! A figure in every cell of a square or triangular lattice.
//!
//! Footprints whose minor axis is below [`CROSSOVER`] and whose major axis is below [`LONGEST`] sum
//! the exact measures of the figures near them. For all others the figures are a Fourier series of
//! the lattice, damped by e^{−2π²kᵀΣk}, exact for any covariance, of which everything beyond |k| =
//! [`HIGHEST`] is below 2e-4; a footprint that is longer and thinner is widened to the
//! crossover, gradually from 0.7 of that length.

use super::figure::sharp;
use super::region::{Measure, NAMES, Outline, Whitening, disc_function};
use super::separable::{finished_signal, phase};
use super::touch::Touch;
use crate::noise::field::Spread;
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, FunctionRef, Module, Type, Value};
use mipless_codegen::moments::{Mode, Signal};
use std::f64::consts::{PI, TAU};

/// Standard deviations of the minor axis from which the series is used, in cells.
const CROSSOVER: f32 = 0.16;

/// The longest major axis over which figures are summed one by one, in cells.
const LONGEST: f32 = 1.3;

/// The highest frequency of the series, in cycles per cell.
const HIGHEST: f64 = 4.3;

/// How far a footprint reaches, in standard deviations.
const REACH: f32 = 3.6;

/// The distance of rows of a triangular lattice, as MaterialX has it.
const ROW: f64 = 0.866_025;

/// What stands in a cell, around its centre.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Tile {
    /// A disc of a radius.
    Disc(f64),
    /// A polygon, symmetric in both axes, by half of its width at each of these heights, from the
    /// axis up; the last is its top.
    Polygon(Vec<[f64; 2]>),
}

impl Tile {
    /// Half of the width at a height.
    fn half_width(&self, y: f64) -> f64 {
        match self {
            Self::Disc(radius) => (radius * radius - y * y).max(0.0).sqrt(),
            Self::Polygon(sides) => {
                for pair in sides.windows(2) {
                    let [[low, wide], [high, narrow]] = [pair[0], pair[1]];
                    if y <= high {
                        let share = if high > low {
                            (y - low) / (high - low)
                        } else {
                            0.0
                        };
                        return wide + share * (narrow - wide);
                    }
                }
                0.0
            }
        }
    }

    /// The heights between which the half width is smooth.
    fn heights(&self) -> Vec<f64> {
        match self {
            Self::Disc(radius) => vec![0.0, *radius],
            Self::Polygon(sides) => sides.iter().map(|side| side[0]).collect(),
        }
    }

    /// From the centre to the farthest point.
    fn reach(&self) -> f64 {
        match self {
            Self::Disc(radius) => *radius,
            Self::Polygon(sides) => sides.iter().map(|[y, x]| x.hypot(*y)).fold(0.0, f64::max),
        }
    }

    /// ∫∫ cos 2π(kx + ly): four times a quadrant's, over heights that crowd at the top of a disc.
    fn transform(&self, k: f64, l: f64) -> f64 {
        const STEPS: usize = 400;
        let mut sum = 0.0;
        for pair in self.heights().windows(2) {
            let (low, span) = (pair[0], pair[1] - pair[0]);
            for i in 0..STEPS {
                // y = sin θ of the span.
                let angle = 0.5 * PI * (i as f64 + 0.5) / STEPS as f64;
                let y = low + span * angle.sin();
                let width = self.half_width(y);
                let across = if k == 0.0 {
                    width
                } else {
                    (TAU * k * width).sin() / (TAU * k)
                };
                let weight = span * angle.cos() * 0.5 * PI / STEPS as f64;
                sum += 4.0 * weight * across * (TAU * l * y).cos();
            }
        }
        sum
    }

    /// Counter-clockwise corners.
    fn outline(&self) -> Option<Outline> {
        let Self::Polygon(sides) = self else {
            return None;
        };
        let corner = |x: f64, y: f64| [x as f32, y as f32, 0.0];
        // Up along the right, down along the left, and the same below; the axis has no corner.
        let half: Vec<[f64; 2]> = sides.iter().copied().filter(|[y, _]| *y > 0.0).collect();
        let mut vertices: Vec<[f32; 3]> = half.iter().map(|&[y, x]| corner(x, y)).collect();
        vertices.extend(
            half.iter()
                .rev()
                .filter(|s| s[1] > 0.0)
                .map(|&[y, x]| corner(-x, y)),
        );
        vertices.extend(half.iter().map(|&[y, x]| corner(-x, -y)));
        vertices.extend(
            half.iter()
                .rev()
                .filter(|s| s[1] > 0.0)
                .map(|&[y, x]| corner(x, -y)),
        );
        Some(Outline { vertices })
    }
}

/// Where the cells are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lattice {
    /// Figures stand in the middle of unit squares.
    Square,
    /// Figures stand at the origin and in rows that are half a cell apart.
    Triangular,
}

impl Lattice {
    /// The height of the unit cell, which is 1 wide.
    pub(crate) const fn height(self) -> f64 {
        match self {
            Self::Square => 1.0,
            Self::Triangular => 2.0 * ROW,
        }
    }

    /// From a row to the next.
    const fn row(self) -> f64 {
        match self {
            Self::Square => 1.0,
            Self::Triangular => ROW,
        }
    }

    /// The first figure.
    const fn origin(self) -> f64 {
        match self {
            Self::Square => 0.5,
            Self::Triangular => 0.0,
        }
    }

    /// (k, l, amplitude) of half of the harmonics, the lowest first, and the mean.
    fn harmonics(self, tile: &Tile) -> (f64, Vec<[f64; 3]>) {
        let area = self.row();
        let most = HIGHEST as i32 + 1;
        let mut rows = Vec::new();
        for m in 0..=most {
            for n in -2 * most..=2 * most {
                let (k, l) = (f64::from(m), f64::from(n) / self.height());
                let first = m > 0 || n > 0;
                let between = self == Self::Triangular && (m + n) % 2 != 0;
                if !first || between || k.hypot(l) > HIGHEST {
                    continue;
                }
                let turned = TAU * self.origin() * f64::from(m + n);
                let amplitude = 2.0 * turned.cos() * tile.transform(k, l) / area;
                rows.push([k, l, amplitude]);
            }
        }
        rows.sort_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1])));
        (tile.transform(0.0, 0.0) / area, rows)
    }
}

/// The tiling at a position in unit cells.
pub(crate) fn tiled(
    lower: &mut Lower<'_>,
    position: &[Signal; 2],
    lattice: Lattice,
    tile: &Tile,
) -> Signal {
    let height = lattice.height() as f32;
    let mode = lower.mode();
    let b = lower.b();
    let place = [0, 1].map(|i| phase(b, &position[i]));
    let place = [place[0], b.scale(place[1], height)];
    let certain = position.iter().all(|axis| axis.is_certain(b));
    if mode == Mode::Point || certain {
        let value = point(lower.b(), lattice, tile, place);
        let signal = Signal::certain(lower.b(), value);
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
    let key = format!("tiling {lattice:?} {tile:?}");
    let function = lower.function(&key, |module| tiling_function(module, lattice, tile));
    let b = lower.b();
    let mut arguments = place.to_vec();
    arguments.extend(spread.covariance);
    arguments.extend(spread.eigenvalues);
    let results = b.call(&function, &arguments);
    let measure: Measure = std::array::from_fn(|i| results[i]);
    let field = sharp(lower, measure, &spread);
    let signal = field.at(lower, &flat);
    finished_signal(lower, signal, true)
}

/// 1 inside a figure, 0 elsewhere: of each row next to the place, the nearest.
fn point(b: &mut Builder, lattice: Lattice, tile: &Tile, [x, y]: [Value; 2]) -> Value {
    let (zero, one) = (b.f32(0.0), b.f32(1.0));
    let outline = tile.outline();
    let rows = match lattice {
        Lattice::Square => vec![(0.5, 0.5)],
        Lattice::Triangular => vec![(0.0, 0.0), (0.5, ROW), (0.0, 2.0 * ROW)],
    };
    let mut inside = b.bool(false);
    for (shift, height) in rows {
        let from = b.offset(x, -shift as f32);
        let rounded = b.offset(from, 0.5);
        let rounded = b.floor(rounded);
        let dx = b.sub(from, rounded);
        let dy = b.offset(y, -height as f32);
        let this = match (&outline, tile) {
            (Some(outline), _) => {
                let back = [b.neg(dx), b.neg(dy)];
                outline.holds(b, [back, [one, zero], [zero, one], [zero, zero]])
            }
            (None, Tile::Disc(radius)) => {
                let distance = b.dot(&[dx, dy], &[dx, dy]);
                let reach = b.f32((radius * radius) as f32);
                b.lt(distance, reach)
            }
            (None, Tile::Polygon(_)) => unreachable!("a polygon has an outline"),
        };
        inside = b.or(inside, this);
    }
    b.select(inside, one, zero)
}

/// The measure of all figures: x, y, Σ and its eigenvalues.
fn tiling_function(module: &mut Module, lattice: Lattice, tile: &Tile) -> FunctionRef {
    let (mean, rows) = lattice.harmonics(tile);
    let kept = kept_harmonics(&rows);
    let kept = module.table("kept_harmonics", kept);
    let flat = rows.iter().flatten().map(|&x| x as f32).collect();
    let series = harmonic_function(module, flat);
    let row = row_function(module, lattice, tile);
    let mut b = Builder::new("tiling", "The share of a footprint that lies in figures.");
    let place = [b.param_f32("x"), b.param_f32("y")];
    let covariance = ["xx", "xy", "yy"].map(|name| b.param_f32(name));
    let [more, less] = ["more", "less"].map(|name| b.param_f32(name));
    let zero = b.f32(0.0);
    let (crossover, longest) = (b.f32(CROSSOVER * CROSSOVER), b.f32(LONGEST * LONGEST));
    let (thin, short) = (b.lt(less, crossover), b.lt(more, longest));
    let single = b.and(thin, short);

    // Σ + (s² − λ₂) along the minor axis, with s from 0 where the major axis is 0.7 of the longest to
    // the crossover where it is all of it.
    let [xx, xy, yy] = covariance;
    let length = b.sqrt(more);
    let share = b.scale(length, 1.0 / (0.3 * LONGEST));
    let share = b.offset(share, -0.7 / 0.3);
    let share = b.clamp(share, 0.0, 1.0);
    let target = b.scale(share, CROSSOVER);
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
    let reach = tile.reach() as f32;
    let raised = b.offset(yy, 1e-12);
    let sd = b.sqrt(raised);
    let extent = b.scale(sd, REACH);
    let extent = b.offset(extent, reach);
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
    let near = b.fold(&row, rows, &[zero; 6], &captures);
    let near: Measure = std::array::from_fn(|i| near[i]);

    // All at once, where Σ is wide enough or has been made so.
    // The widened minor axis is at least this, wherever the series is read.
    let minor = b.max(less, target);
    let sd = b.sqrt(minor);
    let size = b.scale(sd, STEPS as f32);
    let size = b.clamp(size, 0.0, (MOST_KEPT - 1) as f32);
    let size = b.trunc_i(size);
    let size = b.cast_u(size);
    let count = b.load(kept, size);
    let count = b.trunc_i(count);
    let count = b.cast_u(count);
    let none = b.u32(0);
    let count = b.select(single, none, count);
    let mut captures = place.to_vec();
    captures.extend(widened);
    let start = b.f32(mean as f32);
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

/// Rows of the table of harmonics for a standard deviation of 1.
const STEPS: usize = 32;

/// Rows of that table.
const MOST_KEPT: usize = 48;

/// How many of the lowest harmonics a footprint of at least i/32 cells leaves: the others are damped
/// to less than 5e-5 of 1.
fn kept_harmonics(rows: &[[f64; 3]]) -> Vec<f32> {
    let count = |i: usize| {
        let variance = (i as f64 / STEPS as f64).powi(2);
        let left = |row: &[f64; 3]| {
            let damping = (-2.0 * PI * PI * variance * row[0].hypot(row[1]).powi(2)).exp();
            row[2].abs() * damping > 5e-5
        };
        rows.iter().rposition(left).map_or(0, |last| last + 1) as f32
    };
    (0..MOST_KEPT).map(count).collect()
}

/// One more harmonic, the body of a fold.
fn harmonic_function(module: &mut Module, rows: Vec<f32>) -> FunctionRef {
    let table = module.table("harmonics", rows);
    let mut b = Builder::new("tiling_harmonic", "One more harmonic of a tiling.");
    let index = b.param("index", Type::U32);
    let state = NAMES.map(|name| b.param_f32(name));
    let place = [b.param_f32("x"), b.param_f32("y")];
    let [xx, xy, yy] = ["xx", "xy", "yy"].map(|name| b.param_f32(name));
    let three = b.u32(3);
    let first = b.mul_u(index, three);
    let [k, l, amplitude] = [0u32, 1, 2].map(|i| {
        let shift = b.u32(i);
        let at = b.add_u(first, shift);
        b.load(table, at)
    });
    let (px, py) = (b.dot(&[xx, xy], &[k, l]), b.dot(&[xy, yy], &[k, l]));
    let form = b.dot(&[k, l], &[px, py]);
    let exponent = b.scale(form, (-2.0 * PI * PI) as f32);
    let exponent = b.clamp(exponent, -80.0, 0.0);
    let damping = b.exp(exponent);
    let amplitude = b.mul(amplitude, damping);
    let turns = b.dot(&[k, l], &place);
    let raised = b.offset(turns, 0.5);
    let whole = b.floor(raised);
    let turns = b.sub(turns, whole);
    let [cosine, sine] = b.circle(turns);
    let value = b.mul(amplitude, cosine);
    let slope = b.mul(amplitude, sine);
    let slope = b.scale(slope, -TAU as f32);
    let bend = b.scale(value, (-TAU * TAU) as f32);
    let (kk, kl, ll) = (b.square(k), b.mul(k, l), b.square(l));
    let parts = [
        value,
        b.mul(slope, k),
        b.mul(slope, l),
        b.mul(bend, kk),
        b.mul(bend, kl),
        b.mul(bend, ll),
    ];
    for ((name, sum), part) in NAMES.into_iter().zip(state).zip(parts) {
        let sum = b.add(sum, part);
        b.result(name, sum);
    }
    b.finish(module)
}

/// The figures of one more row, the body of a fold.
fn row_function(module: &mut Module, lattice: Lattice, tile: &Tile) -> FunctionRef {
    let figure = figure_function(module, tile);
    let mut b = Builder::new("tiling_row", "One more row of a tiling.");
    let index = b.param("index", Type::U32);
    let state = NAMES.map(|name| b.param_f32(name));
    let place = [b.param_f32("x"), b.param_f32("y")];
    let [first, slope, sd] = ["first", "slope", "sd"].map(|name| b.param_f32(name));
    let whitening = Whitening::declare(&mut b);
    let covariance = ["xx", "xy", "yy"].map(|name| b.param_f32(name));
    let number = b.float_u(index);
    let row = b.add(first, number);
    let height = b.scale(row, lattice.row() as f32);
    let height = b.offset(height, lattice.origin() as f32);
    let up = b.sub(height, place[1]);
    let mut from = b.offset(place[0], -lattice.origin() as f32);
    if lattice == Lattice::Triangular {
        // Odd rows are shifted by half a cell.
        let half = b.scale(row, 0.5);
        let even = b.floor(half);
        let shift = b.sub(half, even);
        from = b.sub(from, shift);
    }
    // Columns: around the line that the footprint follows, or all that it covers, if that is less.
    let reach = tile.reach() as f32;
    let zero = b.f32(0.0);
    let [xx, xy, _] = covariance;
    let along = b.mul(slope, xy);
    let left = b.sub(xx, along);
    let left = b.max(left, zero);
    let left = b.sqrt(left);
    let left = b.scale(left, REACH);
    let steep = b.abs(slope);
    let steep = b.offset(steep, 1.0);
    let steep = b.scale(steep, reach);
    let narrow = b.add(left, steep);
    let wide = b.sqrt(xx);
    let wide = b.scale(wide, REACH);
    let wide = b.offset(wide, reach);
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
    let count = b.cast_u(count);
    let mut captures = vec![start, from, up];
    captures.extend(whitening.captures());
    captures.extend(covariance);
    let sums = b.fold(&figure, count, &[zero; 6], &captures);
    for ((name, sum), part) in NAMES.into_iter().zip(state).zip(sums) {
        let sum = b.add(sum, part);
        b.result(name, sum);
    }
    b.finish(module)
}

/// One more figure of a row, the body of a fold.
fn figure_function(module: &mut Module, tile: &Tile) -> FunctionRef {
    let outline = tile.outline();
    let own = match &outline {
        Some(outline) => outline.function(module),
        None => disc_function(module),
    };
    let mut b = Builder::new("tiling_figure", "One more figure of a row.");
    let index = b.param("index", Type::U32);
    let state = NAMES.map(|name| b.param_f32(name));
    let [start, from, up] = ["start", "from", "up"].map(|name| b.param_f32(name));
    let whitening = Whitening::declare(&mut b);
    let covariance = ["xx", "xy", "yy"].map(|name| b.param_f32(name));
    let number = b.float_u(index);
    let column = b.add(start, number);
    let across = b.sub(column, from);
    let measure: Measure = match (&outline, tile) {
        (Some(outline), _) => {
            let (zero, one) = (b.f32(0.0), b.f32(1.0));
            let axes = [[across, up], [one, zero], [zero, one], [zero, zero]];
            let edges = outline.distances().map(|distance| b.f32(distance));
            let square = b.dot(&[across, up], &[across, up]);
            let touch = Touch::between(&mut b, square, edges, covariance);
            outline.measure(&mut b, &own, (&whitening, touch), axes)
        }
        (None, Tile::Disc(radius)) => {
            let radius = b.f32(*radius as f32);
            let mut arguments = vec![across, up, radius];
            arguments.extend(covariance);
            let results = b.call(&own, &arguments);
            std::array::from_fn(|i| results[i])
        }
        (None, Tile::Polygon(_)) => unreachable!("a polygon has an outline"),
    };
    for ((name, sum), part) in NAMES.into_iter().zip(state).zip(measure) {
        let sum = b.add(sum, part);
        b.result(name, sum);
    }
    b.finish(module)
}
