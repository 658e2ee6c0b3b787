//! A node by points inside the footprint, where its closed form is measured to be wrong: what
//! follows it stays closed.
//!
//! Seven points of equal weight, the centre and a hexagon of radius √(7/3) standard deviations, have
//! the mean and the covariance of the footprint, so that whatever is linear in it is exact. The
//! hexagon turns from pixel to pixel, which makes noise of what would be a moiré. Mean, linear
//! response and the rest of the variance of the points are the node's signal. In the bands where that
//! still misses the tolerance, a sunflower of [`MORE`] points takes the hexagon's place: of an edge
//! seven points leave .063 of its jump (root mean square over places and directions), 32 leave .021.
//!
//! An output is closed in the other bands alone: in a function of its own, which is called where it is
//! read. What follows a node that is no output reads what it has in common with other nodes, so that it
//! stays where it is.
//!
//! Where a footprint holds so much of the texture that its true mean hardly varies from place to
//! place, seven points say less than the mean of the texture itself: they are drawn to it
//! ([`super::drawn`]).

use super::bands::Bands;
use super::drawn::{Drawn, bounded};
use super::period::Periods;
use super::place::scattered;
use super::torus;
use super::{Arguments, Bundle, Compiler, Lower, Method, value_results};
use crate::float::Float as _;
use crate::ir::{Bool, Builder, Float, FunctionRef, Module, Uint, Vec2};
use crate::moments::{Algebra, Mode, PARTS, Signal};
use std::f64::consts::{FRAC_PI_3, TAU};

/// How many points there are.
pub(super) const POINTS: usize = 7;
/// How many points there are where these are too few.
pub(super) const MORE: usize = 32;
/// How many points there are where a map is tried.
const MANY: usize = 256;
/// The golden section.
const GOLDEN: f64 = 0.618_033_988_749_895;
/// How many turns of the hexagon there are, and of the sunflower.
const TURNS: u32 = 64;

/// How a node is sampled.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sampling {
    /// How far the points are drawn to the mean of the texture.
    pub(super) drawn: Drawn,
    /// The bits of the bands where the node is sampled.
    pub(super) within: u32,
    /// The bits of the bands where there are more points.
    pub(super) finer: u32,
    /// The shares of `drawn` where there are.
    pub(super) lost_of_more: [f32; Bands::COUNT],
}

impl Sampling {
    /// Takes more points in the bands of these bits, as far as it samples there.
    pub(super) fn take_more(&mut self, bits: u32) {
        self.finer |= bits & self.within;
        for (band, lost) in self.drawn.lost.iter_mut().enumerate() {
            if self.finer >> band & 1 == 1 {
                *lost = self.lost_of_more[band];
            }
        }
    }

    /// Samples in the bands of these bits alone.
    pub(super) fn keep(&mut self, bits: u32) {
        self.within &= bits;
        self.finer &= bits;
    }
}

impl<'g, 'b> Lower<'g, 'b> {
    /// How a node is to be sampled, if it is: by `auto` alone, in what has the pixel's footprint.
    pub(super) fn sampling(&self, index: usize) -> Option<&'g Sampling> {
        let compiler = self.compiler;
        let applies = compiler.options.method == Method::Auto
            && self.algebra.mode.spreads()
            && !self.measures
            && !self.in_rule;
        let sampling = compiler.facts.sampled.get(&index);
        sampling.filter(|_| applies)
    }

    /// The node by points inside the footprint in the bands where it is to be, else `closed`.
    pub(super) fn sampled(
        &mut self,
        index: usize,
        closed: &[Signal<'b>],
        sampling: &Sampling,
    ) -> Bundle<'b> {
        let compiler = self.compiler;
        let band = sampling.drawn.bands.of(&self.arguments);
        let within = Bands::within(band, sampling.within);
        let lost = self.lost(&sampling.drawn, band);
        let turn = self.arguments.footprint.hashed(0x51ed_270b) >> (32 - TURNS.ilog2());
        let arguments = self.arguments.clone();
        let b = self.b();
        let rows = match sampling.finer {
            0 => Rows {
                count: b.uint(POINTS as u32),
                weight: b.float(1.0 / POINTS as f32),
                name: "sampled_places",
                places,
                first: turn * POINTS as u32,
            },
            finer => {
                let more = Bands::within(band, finer);
                let after = TURNS * POINTS as u32;
                Rows {
                    count: more.select(MORE as u32, POINTS as u32),
                    weight: more.select(1.0 / MORE as f32, 1.0 / POINTS as f32),
                    name: "finer_places",
                    places: finer_places,
                    first: more.select(turn * MORE as u32 + after, turn * POINTS as u32),
                }
            }
        };
        let points = self.points(index, (closed.len(), &arguments, None), within, rows);
        let points: Vec<Signal<'b>> = (points.into_iter().zip(closed).enumerate())
            .map(|(i, (signal, closed))| {
                let far = sampling.drawn.far.of(i, closed.flat_mean(), |x| b.float(x));
                let mean = signal.mean + lost * (far - signal.mean);
                Signal {
                    mean: bounded(mean, closed.range),
                    ..signal
                }
            })
            .collect();
        let everywhere = within.as_constant() == Some(true);
        // Elsewhere a map of it may be read, which is no closed form.
        let is_closed = !compiler.facts.repeated.contains_key(&index);
        let is_last = compiler.facts.live[index] == 1 && compiler.is_output(index);
        let closed = &if is_last && is_closed && !everywhere {
            self.closed_elsewhere(index, closed, within)
        } else {
            closed.to_vec()
        };
        instead(closed, &points, within)
    }

    /// A node that repeats by so many points that its signal is nearly right, where the footprint is
    /// `within` what is asked for, else `closed`: what is tried where in the end a map is read. Under
    /// footprints that are wider than a period, of size `size`, the points are those of a period. All
    /// are looked up in the period that the map is made of, so that what does not repeat is found out.
    pub(super) fn averaged(
        &mut self,
        index: usize,
        closed: &[Signal<'b>],
        (within, size): (Bool<'b>, Float<'b>),
        periods: Periods,
    ) -> Bundle<'b> {
        let sd = self.compiler.options.filter.sd();
        let longest = periods
            .map(|[x, y]| x.hypot(y))
            .into_iter()
            .fold(0.0, f64::max);
        let is_wide = (size * sd).gt(longest as f32);
        let mut arguments = self.arguments.clone();
        let footprint = &mut arguments.footprint;
        for (axis, of_footprint) in [&mut footprint.right, &mut footprint.down]
            .into_iter()
            .enumerate()
        {
            // Points are moved by so many standard deviations of the filter.
            for (to, from) in of_footprint.iter_mut().zip(periods[axis]) {
                *to = is_wide.select((from / f64::from(sd)) as f32, *to);
            }
        }
        let first = is_wide.select(MANY as u32, 0u32);
        let b = self.b();
        let rows = Rows {
            count: b.uint(MANY as u32),
            weight: b.float(1.0 / MANY as f32),
            name: "many_places",
            places: many_places,
            first,
        };
        let of = (closed.len(), &arguments, Some(periods));
        let mut points = self.points(index, of, within, rows);
        for point in &mut points {
            let flat = point.private + point.g.norm2();
            point.private = is_wide.select(flat, point.private);
            point.g = Vec2(point.g.0.map(|x| is_wide.select(0.0, x)));
        }
        instead(closed, &points, within)
    }

    /// The mean, the linear response and the variance of the node's components over points, whose
    /// places a table holds from a row on; anything where the footprint is not `within` what is asked
    /// for.
    fn points(
        &mut self,
        index: usize,
        (components, arguments, periods): (usize, &Arguments<'b>, Option<Periods>),
        within: Bool<'b>,
        Rows {
            count,
            weight,
            name,
            places,
            first,
        }: Rows<'b>,
    ) -> Vec<Signal<'b>> {
        let compiler = self.compiler;
        let sample = self.function(&format!("sample of {index} by {name}"), |module| {
            let point = match periods {
                Some(periods) => torus::function(compiler, module, index, periods),
                None => point_function(compiler, module, index),
            };
            let table = module.table(name, places());
            sample_function(compiler, module, (&point, periods), (index, table))
        });
        let b = self.b();
        let start = vec![b.float(0.0); Sums::COUNT * components];
        let points = within.select(count, 0u32);
        let sums = b.fold(&sample, points, start, (first, arguments.clone()));
        (sums.chunks(Sums::COUNT))
            .map(|sums| {
                let sums = Sums::of(sums);
                let apart = weight * sums.apart;
                let g = Vec2([weight * sums.along[0], weight * sums.along[1]]);
                let variance = weight * sums.squares - apart.square();
                Signal {
                    g,
                    private: (variance - g.norm2()).max(0.0),
                    ..Signal::certain(sums.centre + apart)
                }
            })
            .collect()
    }
}

/// Signals where the footprint is within what is asked for, else the closed ones.
fn instead<'b>(closed: &[Signal<'b>], points: &[Signal<'b>], within: Bool<'b>) -> Bundle<'b> {
    let everywhere = within.as_constant() == Some(true);
    (closed.iter().zip(points))
        .map(|(closed, points)| {
            let points = points.clone().with_range(closed.range);
            if everywhere {
                points
            } else {
                closed.select(within, &points).with_range(closed.range)
            }
        })
        .collect()
}

impl<'a> Compiler<'a> {
    /// Whether a node is an output.
    fn is_output(&self, index: usize) -> bool {
        let mut outputs = self.graph.outputs.iter();
        outputs.any(|output| output.node.index() == index)
    }
}

impl<'b> Lower<'_, 'b> {
    /// The closed form of a node, where the condition does not hold: nothing is evaluated elsewhere.
    fn closed_elsewhere(
        &mut self,
        index: usize,
        closed: &[Signal<'b>],
        unless: Bool<'b>,
    ) -> Bundle<'b> {
        let (compiler, mode) = (self.compiler, self.algebra.mode);
        let function = self.function(&format!("closed {index} {mode:?}"), |module| {
            closed_function(compiler, module, (index, mode))
        });
        let b = self.b();
        let none = vec![b.float(0.0); PARTS * closed.len()];
        let turns = unless.select(0u32, 1u32);
        let parts = b.fold(&function, turns, none, self.arguments.clone());
        let signals = parts.as_chunks().0.iter().zip(closed);
        signals
            .map(|(&parts, closed)| Signal::of_parts(parts).with_range(closed.range))
            .collect()
    }
}

/// The closed form of a node, as the body of a fold of one turn at most.
fn closed_function(
    compiler: &Compiler<'_>,
    module: &mut Module,
    (index, mode): (usize, Mode),
) -> FunctionRef {
    let graph = compiler.graph;
    let node = &graph.nodes[index];
    let name = super::identifier(&node.name);
    let doc = "A part of the texture in closed form.";
    let b = &compiler.builder(format!("{name}_closed"), doc);
    b.uint_param("index");
    let names: Vec<String> = (0..PARTS * node.ty.components())
        .map(|i| format!("part_{i}"))
        .collect();
    for name in &names {
        b.float_param(name);
    }
    let arguments = Arguments::declare(b, graph);
    let mut lower = Lower::with(compiler, module, Algebra::new(b, mode), arguments);
    lower.closes = Some(index);
    let bundle = lower.run_alone(index);
    let parts = bundle.iter().flat_map(|signal| {
        let mut flat = signal.flat();
        let symbols: Vec<_> = flat.shared.iter().map(|&(symbol, _)| symbol).collect();
        for symbol in symbols {
            flat.retire(symbol);
        }
        flat.parts()
    });
    b.results(names, parts);
    b.finish(module)
}

/// Points in a table: so many, from a row on.
struct Rows<'b> {
    count: Uint<'b>,
    /// One over the count.
    weight: Float<'b>,
    /// The table, and what fills it.
    name: &'static str,
    places: fn() -> Vec<f32>,
    first: Uint<'b>,
}

/// What is summed over the points for one component: the value at the centre, and of the values'
/// differences from it the sum, that of the squares and those with the place.
struct Sums<'b> {
    centre: Float<'b>,
    apart: Float<'b>,
    squares: Float<'b>,
    along: [Float<'b>; 2],
}

impl<'b> Sums<'b> {
    const COUNT: usize = 5;

    fn of(sums: &[Float<'b>]) -> Self {
        let [centre, apart, squares, x, y] = sums else {
            panic!("{} sums a component", Self::COUNT)
        };
        Self {
            centre: *centre,
            apart: *apart,
            squares: *squares,
            along: [*x, *y],
        }
    }
}

/// The node at a point.
fn point_function(compiler: &Compiler<'_>, module: &mut Module, index: usize) -> FunctionRef {
    let graph = compiler.graph;
    let name = super::identifier(&graph.nodes[index].name);
    let b = &compiler.builder(format!("{name}_at"), "A part of the texture at a point.");
    let arguments = Arguments::declare(b, graph);
    let mut lower = Lower::with(compiler, module, Algebra::new(b, Mode::Point), arguments);
    let bundle = lower.run_alone(index);
    value_results(b, &bundle);
    b.finish(module)
}

/// Where a place lies in its period.
fn within_period<'b>(place: &Arguments<'b>, periods: Periods) -> [Float<'b>; 2] {
    let footprint = &place.footprint;
    let at = [0, 1].map(|axis| footprint.cell[axis].to_float() + footprint.fraction[axis]);
    torus::inverse(periods).map(|row| {
        let [of_u, of_v] = row.map(|x| x as f32);
        let place = of_u * at[0] + of_v * at[1];
        place - place.floor()
    })
}

/// The points of every turn: places in standard deviations, to 12 significant bits, so that they are
/// the same in f32 and f64.
fn places() -> Vec<f32> {
    let radius = (POINTS as f64 / 3.0).sqrt();
    let mut places = Vec::new();
    for turn in 0..TURNS {
        places.extend([0.0, 0.0]);
        for corner in 0..POINTS - 1 {
            let turn = TAU / 6.0 * f64::from(turn) / f64::from(TURNS);
            let angle = turn + FRAC_PI_3 * corner as f64;
            places.extend([angle.cos(), angle.sin()].map(|x| ((radius * x) as f32).high()));
        }
    }
    places
}

/// Points of a sunflower (Vogel 1979), at the radii at which a Gaussian has equal shares between them.
fn sunflower(count: usize) -> impl Iterator<Item = [f64; 2]> {
    (0..count).map(move |i| {
        let inside = (i as f64 + 0.5) / count as f64;
        let radius = (-2.0 * inside.ln()).sqrt();
        let angle = TAU * (i as f64 * GOLDEN).fract();
        [angle.cos(), angle.sin()].map(|x| radius * x)
    })
}

/// Points moved and stretched so that their mean is 0 and their covariance 1, by the factor of Cholesky.
fn whitened(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mean =
        |f: &dyn Fn(&[f64; 2]) -> f64| points.iter().map(f).sum::<f64>() / points.len() as f64;
    let [x, y] = [mean(&|p| p[0]), mean(&|p| p[1])];
    let xx = mean(&|p| (p[0] - x).powi(2));
    let xy = mean(&|p| (p[0] - x) * (p[1] - y));
    let yy = mean(&|p| (p[1] - y).powi(2));
    let along = xx.sqrt();
    let across = (yy - xy * xy / xx).sqrt();
    let of = |p: &[f64; 2]| {
        let first = (p[0] - x) / along;
        [first, (p[1] - y - xy / along * first) / across]
    };
    points.iter().map(of).collect()
}

/// The points of every turn of the hexagon, then those of every turn of the sunflower.
fn finer_places() -> Vec<f32> {
    let mut places = places();
    let points = whitened(&sunflower(MORE).collect::<Vec<_>>());
    for turn in 0..TURNS {
        let (sin, cos) = (TAU * f64::from(turn) / f64::from(TURNS)).sin_cos();
        for [x, y] in &points {
            places.extend([cos * x - sin * y, sin * x + cos * y].map(|x| (x as f32).high()));
        }
    }
    places
}

/// Many points, in standard deviations: a sunflower's; then as many of a unit square about 0.
fn many_places() -> Vec<f32> {
    let mut places = Vec::with_capacity(4 * MANY);
    for point in sunflower(MANY) {
        places.extend(point.map(|x| (x as f32).high()));
    }
    for i in 0..MANY {
        places.extend(scattered(i).map(|x| ((x - 0.5) as f32).high()));
    }
    places
}

/// One more point: a turn of the fold.
fn sample_function(
    compiler: &Compiler<'_>,
    module: &mut Module,
    (point, periods): (&FunctionRef, Option<Periods>),
    (index, table): (usize, u32),
) -> FunctionRef {
    let count = point.results.len();
    let name = super::identifier(&compiler.graph.nodes[index].name);
    let b = &Builder::new(
        format!("{name}_sample"),
        "One more point inside the footprint.",
    );
    let index = b.uint_param("index");
    let state: Vec<Float<'_>> = (0..Sums::COUNT * count)
        .map(|i| b.float_param(format!("state_{i}")))
        .collect();
    let turn = b.uint_param("turn");
    let arguments = Arguments::declare(b, compiler.graph);
    let at = (turn + index) * 2u32;
    let place = [0u32, 1].map(|axis| b.load(table, at + axis));
    let sd = compiler.options.filter.sd();
    let moved = arguments.moved(place.map(|x| x * sd)).at_point();
    let values = match periods {
        Some(periods) => b.call(point, within_period(&moved, periods)),
        None => b.call(point, moved),
    };
    let first = index.equals(0u32);
    for (i, (&value, sums)) in values.iter().zip(state.chunks(Sums::COUNT)).enumerate() {
        let sums = Sums::of(sums);
        let centre = first.select(value, sums.centre);
        let apart = value - centre;
        let along = [0, 1].map(|axis| sums.along[axis] + apart * place[axis]);
        let next = [
            centre,
            sums.apart + apart,
            sums.squares + apart.square(),
            along[0],
            along[1],
        ];
        for (j, value) in next.into_iter().enumerate() {
            b.result(format!("state_{}", Sums::COUNT * i + j), value);
        }
    }
    b.finish(module)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_have_the_mean_and_the_covariance_of_the_footprint() {
        let (few, more) = (places(), finer_places());
        let turns = few
            .chunks(2 * POINTS)
            .chain(more[few.len()..].chunks(2 * MORE));
        assert_eq!(turns.clone().count(), 2 * TURNS as usize);
        for turn in turns {
            let points: Vec<[f64; 2]> = (turn.chunks(2))
                .map(|p| [f64::from(p[0]), f64::from(p[1])])
                .collect();
            let mean = |f: &dyn Fn(&[f64; 2]) -> f64| {
                points.iter().map(f).sum::<f64>() / points.len() as f64
            };
            for (moment, right) in [
                (mean(&|p| p[0]), 0.0),
                (mean(&|p| p[1]), 0.0),
                (mean(&|p| p[0] * p[0]), 1.0),
                (mean(&|p| p[1] * p[1]), 1.0),
                (mean(&|p| p[0] * p[1]), 0.0),
            ] {
                assert!((moment - right).abs() < 1e-3, "{moment} for {right}");
            }
        }
    }
}
