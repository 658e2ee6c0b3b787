//! Functions of two signals by tables: an isotropic σ-pyramid over the plane, baked in f64.
//!
//! Level l holds E[T] under an isotropic Gaussian on a grid of at most σ_l/2, read linearly in
//! position and in σ. A covariance Σ is read by five taps along its major axis: with s² =
//! max(λ₂, λ₁/25), Σ ≈ s² I + (λ₁ − s²) v vᵀ, which blurs the minor axis too far and keeps the
//! major variance (MATH §5; DESIGN §7); of a map that repeats, a long footprint is read place by place
//! ([`long`]). So any correlation of the two signals is filtered, where
//! Grenier et al. 2022 tabulate axis-aligned ones alone.
//!
//! Where second-order coefficients are carried, the mean is that of four parts of the footprint, by
//! [`split`].
//!
//! Slopes are stored as σ E[∂T] and what is left of the variance as its root; all components of a
//! texel are packed into one number. Below the finest σ the function itself is the other end.

mod bake;
mod long;
mod pack;
mod read;
mod split;

use super::branch::Branch;
use super::{Algebra, Mode, Signal, position};
use crate::ir::{Float, FunctionRef, Module, Numbers, Sym2, Vec2};
use pack::Packing;
use std::sync::{Arc, LazyLock};

/// A function of two numbers, sampled over a domain; one vector a component, rows first.
pub(crate) type Grid = Arc<LazyLock<Vec<Vec<f32>>, Box<dyn Fn() -> Vec<Vec<f32>> + Send + Sync>>>;

/// Samples along each side of the domain: 2 a finest σ.
pub(crate) const SIDE: usize = 1024;

/// The finest σ, in domains. Below it the function itself is read.
const FINEST: f64 = 1.0 / 512.0;
/// σ of the level after it.
const SECOND: f64 = 1.0 / 128.0;
/// How many levels; the coarsest σ is one domain, over which a period is gone.
const LEVELS: usize = 16;
/// The most intervals of texels along a side.
const MOST: usize = 256;

/// σ of a level, in domains.
fn sigma(level: usize) -> f64 {
    match level {
        0 => FINEST,
        _ => SECOND * ((level - 1) as f64 / 2.0).exp2(),
    }
}

/// How many intervals of texels a level has along a side: σ/2 each, at least two of them.
fn intervals(level: usize) -> usize {
    ((2.0 / sigma(level)).ceil() as usize).clamp(2, MOST)
}

/// The places that a map is defined on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    /// The smallest and the largest first and second number. Beyond them the map is constant, or
    /// repeats.
    pub bounds: [[f32; 2]; 2],
    /// Whether it repeats.
    pub periodic: bool,
    /// At how many places along each axis the function is evaluated for one of the [`SIDE`] samples:
    /// more than 1 where it has detail that they would miss.
    pub detail: usize,
}

impl Domain {
    /// Samples along each side.
    pub const SAMPLES: usize = SIDE;

    fn widths(&self) -> [f32; 2] {
        self.bounds.map(|[low, high]| high - low)
    }

    /// Where row `row` of the places is, [`SIDE`] times the detail of them each way: first numbers,
    /// then the second numbers.
    pub(crate) fn row(&self, row: usize) -> [Vec<f32>; 2] {
        let side = SIDE * self.detail;
        let at = |axis: usize, i: usize| {
            let [low, high] = self.bounds[axis].map(f64::from);
            (low + (high - low) * (i as f64 + 0.5) / side as f64) as f32
        };
        [
            (0..side).map(|i| at(0, i)).collect(),
            vec![at(1, row); side],
        ]
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Moment {
    Mean,
    SlopeX,
    SlopeY,
    Distortion,
}

const MOMENTS: [(Moment, &str); 4] = [
    (Moment::Mean, "mean"),
    (Moment::SlopeX, "slope_x"),
    (Moment::SlopeY, "slope_y"),
    (Moment::Distortion, "distortion"),
];

/// A function of two numbers with moments that are baked when their tables are first read; tables
/// that nothing reads are pruned with the module.
#[derive(Clone, Debug)]
pub(crate) struct Map {
    /// Gives the components of two numbers.
    function: FunctionRef,
    branch: Branch,
    domain: Domain,
    /// The least and largest value of each component.
    ranges: Vec<[f32; 2]>,
    packing: Packing,
    /// The table of counts and offsets of the levels.
    levels: u32,
    tables: [u32; 4],
    /// The functions that read a moment's level at a place.
    readers: [FunctionRef; 4],
    /// Of a map that repeats, the function that reads one more place along a long footprint.
    step: Option<FunctionRef>,
}

impl Map {
    /// `function` takes two numbers and gives up to four components within `ranges`; `grid` holds
    /// it sampled over the domain.
    pub(crate) fn new(
        module: &mut Module,
        name: &str,
        function: FunctionRef,
        domain: Domain,
        ranges: Vec<[f32; 2]>,
        grid: &Grid,
    ) -> Self {
        let packing = Packing::new(ranges.len());
        let levels = module.table("map_levels", layout(&packing));
        let total = packing.header() + (0..LEVELS).map(texels).sum::<usize>();
        let periodic = domain.periodic;
        let (of_means, of_spreads, tried) = (Arc::clone(grid), Arc::clone(grid), Arc::clone(grid));
        let means = move || bake::means(&of_means, periodic, &packing);
        let spreads = LazyLock::new(move || bake::spreads(&of_spreads, periodic, &packing));
        let baked = Arc::new((LazyLock::new(means), spreads));
        let errors = {
            let baked = Arc::clone(&baked);
            LazyLock::new(move || bake::errors(&tried, &baked.0, &baked.1, periodic, &packing))
        };
        let errors = Arc::new(errors);
        let tables = MOMENTS.map(|(moment, suffix)| {
            let (baked, errors) = (Arc::clone(&baked), Arc::clone(&errors));
            let table = move || match moment {
                Moment::Mean => baked.0.clone(),
                _ => baked.1[moment as usize - 1].clone(),
            };
            let error = move |_: &[f32]| errors[moment as usize];
            let numbers = Numbers::lazy(total, table).with_error(error);
            module.push_table(format!("{name}_{suffix}"), numbers)
        });
        let readers = MOMENTS.map(|(moment, suffix)| {
            let table = tables[moment as usize];
            read::bilinear(module, &format!("{name}_{suffix}_at"), table, &packing)
        });
        let mean = &readers[Moment::Mean as usize];
        let step =
            (domain.periodic).then(|| long::step(module, &format!("{name}_step"), mean, &packing));
        let branch = Branch::of_numbers(module, name, &function, 2);
        Self {
            function,
            branch,
            domain,
            ranges,
            packing,
            levels,
            tables,
            readers,
            step,
        }
    }
}

/// The texels of a level.
fn texels(level: usize) -> usize {
    (intervals(level) + 1).pow(2)
}

/// For each level: its intervals along a side, and the index of its first number.
fn layout(packing: &Packing) -> Vec<f32> {
    let mut rows = Vec::new();
    let mut first = packing.header();
    for level in 0..LEVELS {
        rows.extend([intervals(level) as f32, first as f32]);
        first += texels(level);
    }
    rows
}

impl<'b> Algebra<'b> {
    /// T(X, Y), whatever the covariance of X and Y is: means E[T], coefficients E[∂T] of both, and
    /// the rest of the variance into a fresh ε of each component.
    pub(crate) fn map(&mut self, [x, y]: [&Signal<'b>; 2], map: &Map) -> Vec<Signal<'b>> {
        let [width, height] = map.domain.widths();
        let [x, y] = &[map.phase(x, width), map.phase(y, height)];
        let mean = Vec2([x.mean, y.mean]);
        if !self.mode.spreads() || x.is_certain() && y.is_certain() {
            let values = self.b.call(&map.function, mean);
            return (values.into_iter().zip(&map.ranges))
                .map(|(value, &range)| Signal::certain(value).with_range(range))
                .collect();
        }
        self.bent = true;
        let covariance = Sym2([x.variance(), x.covariance(y).total, y.variance()]);
        let mut moments = map.moments(mean, covariance);
        if self.mode == Mode::Quad
            && let Some(means) = split::means(map, [x, y])
        {
            let fine = map.is_fine(covariance);
            for (moments, mean) in moments.iter_mut().zip(means) {
                moments.mean = fine.select(moments.mean, mean);
            }
        }
        (moments.into_iter().zip(&map.ranges))
            .map(|(m, &range)| {
                let bounded = range.iter().all(|bound| bound.is_finite());
                let mut out = Signal {
                    mean: if bounded {
                        m.mean.clamp(range[0], range[1])
                    } else {
                        m.mean
                    },
                    cell: None,
                    range,
                    binary: None,
                    ..x * m.slopes[0] + y * m.slopes[1]
                };
                self.attach_fresh(&mut out, m.distortion);
                if self.derives() {
                    let lines = [(x, m.slopes[0]), (y, m.slopes[1])];
                    out.slope = self.slopes_of_linear(&lines, m.distortion);
                }
                out
            })
            .collect()
    }
}

impl Map {
    /// The signal with its mean as one number; of a position what is left of whole periods, which
    /// keeps its detail far from the origin.
    fn phase<'b>(&self, signal: &Signal<'b>, period: f32) -> Signal<'b> {
        if self.domain.periodic && signal.cell.is_some() {
            return Signal {
                mean: position::modulo((signal.cell, signal.mean), period),
                cell: None,
                ..signal.clone()
            };
        }
        signal.flat()
    }
}

/// The moments of one component.
struct Moments<'b> {
    mean: Float<'b>,
    slopes: Vec2<'b>,
    distortion: Float<'b>,
}

#[cfg(test)]
mod tests;
