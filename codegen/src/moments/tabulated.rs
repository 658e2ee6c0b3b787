//! Functions of one signal by tables: a σ-pyramid for each moment, baked in f64.
//!
//! Level l holds the moment at σ_l = σ₀ 2^{l/2} on a grid of at most σ_l/2 over the domain, read
//! linearly in position and in σ; below σ₀ the function itself is the other end (DESIGN §7; MATH
//! §6: 8.7 KB a moment, largest error 14/1000 on ten-stripe maps). The k-th derivative of the mean
//! is stored as σᵏ E[T⁽ᵏ⁾] = E[T Heₖ(z)], the distortion as its root.

use super::branch::Branch;
use super::{Gaussian, Moments, Transfer};
use crate::ir::{Bool, Float, FunctionRef, Module, Numbers, Uint};
use std::sync::{Arc, LazyLock};

/// σ₀, in domains.
const FINEST: f64 = 0.004;
/// How many levels: the coarsest σ is 0.004 · 2⁸ = 1.02 domains, over which a period is gone; ten
/// standard deviations of a process are one domain.
const LEVELS: usize = 17;
/// Samples of the function over the domain; 8 a σ₀.
const SAMPLES: usize = 2048;
/// How far a Gaussian reaches, in σ.
const REACH: f64 = 4.5;

/// A function sampled over a domain, ready to bake moments from.
#[derive(Clone, Debug)]
pub(crate) struct Sampled {
    /// The values at the centres of [`SAMPLES`] cells of the domain, and their averages over 2, 4, …
    /// cells.
    mips: Vec<Vec<f64>>,
    /// Whether the domain is one period.
    periodic: bool,
}

/// Where to sample a function over a domain; beyond it the function is taken for constant.
pub(crate) fn sample_points(domain: [f32; 2]) -> Vec<f32> {
    let width = f64::from(domain[1]) - f64::from(domain[0]);
    (0..SAMPLES)
        .map(|i| (f64::from(domain[0]) + width * (i as f64 + 0.5) / SAMPLES as f64) as f32)
        .collect()
}

impl Sampled {
    /// From the values at [`sample_points`].
    pub(crate) fn new(values: Vec<f64>, periodic: bool) -> Self {
        assert_eq!(values.len(), SAMPLES, "samples of a function");
        let mut mips = vec![values];
        for _ in 0..LEVELS / 2 {
            let finer = mips.last().expect("the samples").chunks(2);
            mips.push(finer.map(|pair| 0.5 * (pair[0] + pair[1])).collect());
        }
        Self { mips, periodic }
    }

    /// The derivative of the function over a domain of this width, which beyond it is 0.
    pub(crate) fn rise(&self, width: f64) -> Self {
        let by = 0.5 * SAMPLES as f64 / width;
        let mut rises: Vec<f64> = (0..SAMPLES as i64)
            .map(|i| (self.sample(0, i + 1) - self.sample(0, i - 1)) * by)
            .collect();
        if !self.periodic {
            rises[0] = 0.0;
            rises[SAMPLES - 1] = 0.0;
        }
        Self::new(rises, self.periodic)
    }

    /// Sample i of a mip, which may lie beyond the domain: there the function keeps its last value,
    /// not that of the last average.
    fn sample(&self, mip: usize, i: i64) -> f64 {
        let (fine, samples) = (&self.mips[0], &self.mips[mip]);
        let count = samples.len() as i64;
        if self.periodic {
            samples[i.rem_euclid(count) as usize]
        } else if i < 0 {
            fine[0]
        } else if i >= count {
            fine[SAMPLES - 1]
        } else {
            samples[i as usize]
        }
    }

    /// One moment's pyramid: all levels, finest first.
    fn pyramid(&self, moment: Moment) -> Vec<f32> {
        (0..LEVELS)
            .flat_map(|level| self.level(level, moment))
            .collect()
    }

    /// One level, from the samples that are 8 or 11 a σ; every texel has the same weights.
    fn level(&self, level: usize, moment: Moment) -> Vec<f32> {
        let mip = level / 2;
        let sd = deviation(sigma(level), SAMPLES, SAMPLES >> mip);
        let reach = (REACH * sd).ceil() as i64;
        // Sample i stands at i + ½, texel j at 4j: the score of sample 4j + k is (k + ½)/σ.
        let scores: Vec<f64> = (-reach..reach).map(|k| (k as f64 + 0.5) / sd).collect();
        let weights = gaussian(&scores);
        let weighted = |f: fn(f64) -> f64| -> Vec<f64> {
            (scores.iter().zip(&weights).map(|(&z, w)| f(z) * w)).collect()
        };
        let first = weighted(|z| z);
        let kernel = match moment {
            Moment::Mean | Moment::Distortion => weights.clone(),
            Moment::Slope => first.clone(),
            Moment::Curvature => weighted(|z| z * z - 1.0),
            Moment::Third => weighted(|z| z * (z * z - 3.0)),
        };
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let mut near = vec![0.0; scores.len()];
        (0..texels(level) as i64)
            .map(|texel| {
                for (value, i) in near.iter_mut().zip(4 * texel - reach..) {
                    *value = self.sample(mip, i);
                }
                let sum = dot(&kernel, &near);
                if moment != Moment::Distortion {
                    return sum as f32;
                }
                let slope = dot(&first, &near);
                let residuals = (near.iter().zip(&scores).zip(&weights))
                    .map(|((v, z), w)| w * (v - sum - slope * z).powi(2));
                residuals.sum::<f64>().sqrt() as f32
            })
            .collect()
    }
}

/// Places of each level, and shares between it and the next, at which a table is compared with the
/// moments themselves.
const PLACES: usize = 61;
const BETWEEN: [f64; 3] = [0.0, 0.35, 0.7];

impl Sampled {
    /// The largest error of reading a pyramid between its texels and its levels, in units of the
    /// function.
    fn error(&self, pyramid: &[f32], moment: Moment) -> f64 {
        let mut worst = 0.0f64;
        let mut first = 0;
        for level in 0..LEVELS - 1 {
            let next = first + texels(level);
            for share in BETWEEN {
                let sd = sigma(level) + share * (sigma(level + 1) - sigma(level));
                for i in 0..PLACES {
                    // The golden ratio's multiples meet texels nowhere twice.
                    let u = ((i as f64 + share) * 0.618_033_988_749_895).fract();
                    let read = [(level, first), (level + 1, next)].map(|(level, first)| {
                        let last = texels(level) - 1;
                        let at = u * last as f64;
                        let left = (at as usize).min(last - 1);
                        let [p, q] = [0, 1].map(|k| f64::from(pyramid[first + left + k]));
                        p + (at - left as f64) * (q - p)
                    });
                    let value = read[0] + share * (read[1] - read[0]);
                    worst = worst.max((value - self.exact(level / 2, u, sd, moment)).abs());
                }
            }
            first = next;
        }
        worst
    }

    /// A moment at a place and a σ of the domain, from the samples of a mip.
    fn exact(&self, mip: usize, u: f64, sigma: f64, moment: Moment) -> f64 {
        let samples = &self.mips[mip];
        let sd = deviation(sigma, SAMPLES, samples.len());
        let at = u * samples.len() as f64;
        let reach = (at - REACH * sd).floor() as i64..=(at + REACH * sd).ceil() as i64;
        let terms: Vec<[f64; 3]> = reach
            .map(|i| {
                let z = (i as f64 + 0.5 - at) / sd;
                [z, (-0.5 * z * z).exp(), self.sample(mip, i)]
            })
            .collect();
        let total: f64 = terms.iter().map(|t| t[1]).sum();
        let mean = |f: &dyn Fn(f64, f64) -> f64| {
            terms.iter().map(|&[z, w, y]| w * f(z, y)).sum::<f64>() / total
        };
        match moment {
            Moment::Mean => mean(&|_, y| y),
            Moment::Slope => mean(&|z, y| y * z),
            Moment::Curvature => mean(&|z, y| y * (z * z - 1.0)),
            Moment::Third => mean(&|z, y| y * z * (z * z - 3.0)),
            Moment::Distortion => {
                let (level, slope) = (mean(&|_, y| y), mean(&|z, y| y * z));
                mean(&|z, y| (y - level - slope * z).powi(2)).sqrt()
            }
        }
    }
}

/// Texels of a level: its grid covers the domain with a texel for every 4 samples, 0.49 or 0.35 σ.
fn texels(level: usize) -> usize {
    (SAMPLES >> (level / 2)) / 4 + 1
}

/// σ of a level, in domains.
fn sigma(level: usize) -> f64 {
    FINEST * (level as f64 / 2.0).exp2()
}

/// The standard deviation, in samples, of a Gaussian over `count` averages of `samples` samples so
/// that the whole has the σ, in domains: each average has the variance of a box that the kernel need
/// not add.
pub(super) fn deviation(sigma: f64, samples: usize, count: usize) -> f64 {
    let (cell, wanted) = ((samples / count) as f64, sigma * count as f64);
    (wanted * wanted - (1.0 - 1.0 / (cell * cell)) / 12.0).sqrt()
}

/// The weights of a Gaussian at standard scores; their sum is 1.
pub(super) fn gaussian(scores: &[f64]) -> Vec<f64> {
    let mut weights: Vec<f64> = scores.iter().map(|z| (-0.5 * z * z).exp()).collect();
    let total: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= total);
    weights
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Moment {
    Mean,
    Slope,
    Curvature,
    Third,
    Distortion,
}

const MOMENTS: [(Moment, &str); 5] = [
    (Moment::Mean, "mean"),
    (Moment::Slope, "slope"),
    (Moment::Curvature, "curvature"),
    (Moment::Third, "third"),
    (Moment::Distortion, "distortion"),
];

/// A function's values at [`sample_points`], one vector a component, computed once when first asked.
pub(crate) type Samples = Arc<LazyLock<Vec<Sampled>, Box<dyn Fn() -> Vec<Sampled> + Send + Sync>>>;

/// The tables of one component of a function, in the order of [`MOMENTS`].
pub(crate) type Pyramids = [Numbers; 5];

/// They are computed from the function's values when they are first read.
pub(crate) fn pyramids(samples: &Samples, component: usize) -> Pyramids {
    let total = (0..LEVELS).map(texels).sum();
    MOMENTS.map(|(moment, _)| {
        let (baked, tried) = (Arc::clone(samples), Arc::clone(samples));
        let bake = move || baked[component].pyramid(moment);
        let error = move |pyramid: &[f32]| tried[component].error(pyramid, moment);
        Numbers::lazy(total, bake).with_error(error)
    })
}

/// A function of one number with moments that are baked when their tables are first read; tables
/// that nothing reads are pruned with the module.
#[derive(Clone, Debug)]
pub struct Tabulated {
    function: FunctionRef,
    branch: Branch,
    component: usize,
    domain: [f32; 2],
    periodic: bool,
    range: [f32; 2],
    tables: [u32; 5],
    /// Its derivative, where slopes are asked for.
    rise: Option<Arc<Tabulated>>,
}

impl Tabulated {
    /// `function` takes a number and gives the components; `range` bounds this one.
    pub(crate) fn new(
        module: &mut Module,
        name: &str,
        (function, branch, component): (FunctionRef, Branch, usize),
        (domain, periodic, range): ([f32; 2], bool, [f32; 2]),
        pyramids: Pyramids,
    ) -> Self {
        let mut suffixes = MOMENTS.iter();
        let tables = pyramids.map(|numbers| {
            let (_, suffix) = suffixes.next().expect("a name for each moment");
            module.push_table(format!("{name}_{suffix}"), numbers)
        });
        Self {
            function,
            branch,
            component,
            domain,
            periodic,
            range,
            tables,
            rise: None,
        }
    }

    /// The same with its derivative.
    pub(crate) fn with_rise(self, rise: Self) -> Self {
        Self {
            rise: Some(Arc::new(rise)),
            ..self
        }
    }

    /// The same with other bounds.
    pub(crate) fn within(self, range: [f32; 2]) -> Self {
        Self { range, ..self }
    }
}

/// Where a pyramid is read: the two levels' texels and how they mix.
struct Place<'b> {
    /// For each of the two levels: the index of the left texel and the share of the right one.
    texels: [(Uint<'b>, Float<'b>); 2],
    /// The share of the coarser level.
    mix: Float<'b>,
    /// Whether σ is below σ₀, and the share of the finest level then.
    below: Bool<'b>,
    share: Float<'b>,
}

impl Tabulated {
    fn place<'b>(&self, x: &Gaussian<'b>) -> Place<'b> {
        let [low, high] = self.domain;
        let width = high - low;
        let within = |x: Float<'b>| (x + -low) * (1.0 / width);
        let u = if self.periodic {
            let turns = within(x.mean);
            turns - turns.floor()
        } else {
            within(x.mean.clamp(low, high))
        };
        let s = x.sd * (1.0 / width);
        let (finest, coarsest) = (FINEST as f32, sigma(LEVELS - 1) as f32);
        let ratio = s.clamp(finest, coarsest) * (1.0 / finest);
        let (level, mix) = half_octave(ratio, LEVELS - 2);
        let row = level.to_int().to_uint();

        // A level of n + 1 texels, n = SAMPLES/4 halved every other level, starts after those before:
        // at SAMPLES − 4n + l, and at n more where l is odd.
        const QUARTER: u32 = (SAMPLES / 4) as u32;
        let odd = row & 1;
        let fine = QUARTER >> (row >> 1);
        let first = SAMPLES as u32 - fine * 4 + row + odd * fine;
        let next = first + fine + 1;
        let texels = [(fine, first), (fine >> odd, next)].map(|(last, first)| {
            let last = last.to_float();
            let at = u * last;
            // The last interval includes its end.
            let left = at.floor().min(last + -1.0);
            (first + left.to_int().to_uint(), at - left)
        });
        Place {
            texels,
            mix: mix.clamp(0.0, 1.0),
            below: s.lt(finest),
            share: s * (1.0 / finest),
        }
    }

    /// The moment at the place.
    fn read<'b>(&self, place: &Place<'b>, moment: Moment) -> Float<'b> {
        let (b, table) = (place.mix.builder(), self.tables[moment as usize]);
        let [fine, coarse] = place
            .texels
            .map(|(index, share)| lerp(b.load(table, index), b.load(table, index + 1), share));
        lerp(fine, coarse, place.mix)
    }
}

/// The level l = 2 log₂ ratio of σ_l = 2^{l/2}, rounded down and limited to `[0, most]`, and the
/// share of the next one, linear in σ and not limited: (σ/σ_l − 1)/(√2 − 1).
pub(super) fn half_octave(ratio: Float<'_>, most: usize) -> (Float<'_>, Float<'_>) {
    use std::f32::consts::{LN_2, SQRT_2};
    let level = (ratio.ln() * (2.0 / LN_2)).floor().clamp(0.0, most as f32);
    let relative = ratio * (level * (-0.5 * LN_2)).exp();
    (level, (relative + -1.0) * (1.0 / (SQRT_2 - 1.0)))
}

pub(super) fn lerp<'b>(from: Float<'b>, to: Float<'b>, share: Float<'b>) -> Float<'b> {
    from + (to - from) * share
}

impl<'b> Transfer<'b> for Tabulated {
    fn value(&self, x: Float<'b>) -> Float<'b> {
        x.builder().call(&self.function, x)[self.component]
    }

    fn moments(&self, x: &Gaussian<'b>) -> Moments<'b> {
        let place = self.place(x);
        let read = |moment| self.read(&place, moment);
        let mean = read(Moment::Mean);
        let exact = self.branch.taken(place.below, x.mean)[self.component];
        let near = lerp(exact, mean, place.share);
        // What is stored is relative to σ; below σ₀ the derivatives are those at σ₀.
        let width = self.domain[1] - self.domain[0];
        let inverse = 1.0 / x.sd.max(FINEST as f32 * width);
        Moments {
            mean: place.below.select(near, mean),
            slope: read(Moment::Slope) * inverse,
            curvature: read(Moment::Curvature) * inverse.square(),
            third: read(Moment::Third) * (inverse.square() * inverse),
            distortion: (read(Moment::Distortion) * (x.sd * inverse)).square(),
        }
    }

    fn range(&self, _: [f32; 2]) -> [f32; 2] {
        self.range
    }

    fn derivative(&self) -> Option<Box<dyn Transfer<'b> + 'b>> {
        let rise = self.rise.as_ref()?;
        Some(Box::new(Self::clone(rise)))
    }

    fn period(&self) -> Option<f32> {
        let [low, high] = self.domain;
        self.periodic.then_some(high - low)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Function = fn(f64) -> f64;

    #[test]
    fn levels_start_where_the_others_end() {
        let mut first = 0;
        for level in 0..LEVELS {
            let last = (SAMPLES / 4) >> (level / 2);
            assert_eq!(texels(level), last + 1);
            assert_eq!(first, SAMPLES - 4 * last + level + level % 2 * last);
            first += texels(level);
        }
    }

    #[test]
    fn a_pyramid_states_its_error_and_stays_small() {
        let values = |f: Function| -> Vec<f64> {
            (0..SAMPLES)
                .map(|i| f((i as f64 + 0.5) / SAMPLES as f64))
                .collect()
        };
        // MATH §6 has 0.011 for sin 9x and 0.014 for ten stripes; nine whole periods are harder.
        let cases: [(Function, f64); 3] = [
            (|x| 0.5 + 0.5 * (9.0 * x).sin(), 0.02),
            (|x| (10.0 * x).floor().rem_euclid(2.0), 0.1),
            (
                |x| 0.5 + 0.5 * (9.0 * std::f64::consts::TAU * x).sin(),
                0.07,
            ),
        ];
        for (f, bound) in cases {
            let sampled = Sampled::new(values(f), false);
            let pyramid = sampled.pyramid(Moment::Mean);
            assert!(4 * pyramid.len() <= 10_000, "{}", 4 * pyramid.len());
            let error = sampled.error(&pyramid, Moment::Mean);
            assert!(error > 1e-4 && error < bound, "{error}");
        }
    }
}
