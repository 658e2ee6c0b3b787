//! Functions of one signal by tables: a σ-pyramid for each moment, baked in f64.
//!
//! Level l holds the moment at σ_l = σ₀ 2^{l/2} on a grid of at most σ_l/2 over the domain, read
//! linearly in position and in σ; below σ₀ the function itself is the other end (DESIGN §7; MATH
//! §6: 8.7 KB a moment, largest error 14/1000 on ten-stripe maps). The k-th derivative of the mean
//! is stored as σᵏ E[T⁽ᵏ⁾] = E[T Heₖ(z)], the distortion as its root.

use super::branch::Branch;
use super::{Gaussian, Moments, Transfer};
use crate::ir::{Builder, FunctionRef, Module, Numbers, Value};
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
            let finer = mips.last().expect("the samples");
            mips.push(
                finer
                    .chunks(2)
                    .map(|pair| 0.5 * (pair[0] + pair[1]))
                    .collect(),
            );
        }
        Self { mips, periodic }
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
        // Averages over 2ᵐ samples have the variance of a box that the kernel need not add.
        let cell = (1u64 << mip) as f64;
        let wanted = sigma(level) * SAMPLES as f64 / cell;
        let sd = (wanted * wanted - (1.0 - 1.0 / (cell * cell)) / 12.0).sqrt();
        let reach = (REACH * sd).ceil() as i64;
        // Sample i stands at i + ½, texel j at 4j: the score of sample 4j + k is (k + ½)/σ.
        let scores: Vec<f64> = (-reach..reach).map(|k| (k as f64 + 0.5) / sd).collect();
        let mut weights: Vec<f64> = scores.iter().map(|z| (-0.5 * z * z).exp()).collect();
        let total: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|w| *w /= total);
        let weighted = |f: fn(f64) -> f64| -> Vec<f64> {
            scores
                .iter()
                .zip(&weights)
                .map(|(&z, w)| f(z) * w)
                .collect()
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
        let cell = (1u64 << mip) as f64;
        let wanted = sigma * samples.len() as f64;
        let sd = (wanted * wanted - (1.0 - 1.0 / (cell * cell)) / 12.0).sqrt();
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
}

impl Tabulated {
    /// `function` takes a number and gives the components; `range` bounds this one.
    pub(crate) fn new(
        module: &mut Module,
        name: &str,
        (function, branch, component): (FunctionRef, Branch, usize),
        (domain, periodic, range): ([f32; 2], bool, [f32; 2]),
        samples: &Samples,
    ) -> Self {
        let total = (0..LEVELS).map(texels).sum();
        let tables = MOMENTS.map(|(moment, suffix)| {
            let (baked, tried) = (Arc::clone(samples), Arc::clone(samples));
            let bake = move || baked[component].pyramid(moment);
            let error = move |pyramid: &[f32]| tried[component].error(pyramid, moment);
            let numbers = Numbers::lazy(total, bake).with_error(error);
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
        }
    }
}

/// Where a pyramid is read: the two levels' texels and how they mix.
struct Place {
    /// For each of the two levels: the index of the left texel and the share of the right one.
    texels: [(Value, Value); 2],
    /// The share of the coarser level.
    mix: Value,
    /// Whether σ is below σ₀, and the share of the finest level then.
    below: Value,
    share: Value,
}

impl Tabulated {
    fn place(&self, b: &mut Builder, x: &Gaussian) -> Place {
        let width = self.domain[1] - self.domain[0];
        let [low, high] = self.domain;
        let u = if self.periodic {
            let u = b.offset(x.mean, -low);
            let u = b.scale(u, 1.0 / width);
            let whole = b.floor(u);
            b.sub(u, whole)
        } else {
            let inside = b.clamp(x.mean, low, high);
            let u = b.offset(inside, -low);
            b.scale(u, 1.0 / width)
        };
        let s = b.scale(x.sd, 1.0 / width);
        let coarsest = sigma(LEVELS - 1) as f32;
        let ratio = b.clamp(s, FINEST as f32, coarsest);
        // l = 2 log₂(σ/σ₀).
        let ratio = b.scale(ratio, 1.0 / FINEST as f32);
        let log = b.ln(ratio);
        let level = b.scale(log, 2.0 / std::f32::consts::LN_2);
        let level = b.floor(level);
        let level = b.clamp(level, 0.0, (LEVELS - 2) as f32);
        // Linear in σ: (σ/σ_l − 1)/(√2 − 1).
        let exponent = b.scale(level, -0.5 * std::f32::consts::LN_2);
        let down = b.exp(exponent);
        let relative = b.mul(ratio, down);
        let mix = b.offset(relative, -1.0);
        let mix = b.scale(mix, 1.0 / (std::f32::consts::SQRT_2 - 1.0));
        let mix = b.clamp(mix, 0.0, 1.0);
        let row = b.trunc_i(level);
        let row = b.cast_u(row);
        // A level of n + 1 texels, n = SAMPLES/4 halved every other level, starts after those before:
        // at SAMPLES − 4n + l, and at n more where l is odd.
        let (one, four) = (b.u32(1), b.u32(4));
        let halved = b.shr_u(row, one);
        let odd = b.and_u(row, one);
        let quarter = b.u32((SAMPLES / 4) as u32);
        let fine = b.shr_u(quarter, halved);
        let (all, own) = (b.u32(SAMPLES as u32), b.mul_u(fine, four));
        let before = b.sub_u(all, own);
        let before = b.add_u(before, row);
        let other = b.mul_u(odd, fine);
        let first = b.add_u(before, other);
        let next = b.add_u(first, fine);
        let next = b.add_u(next, one);
        let coarse = b.shr_u(fine, odd);
        let texels = [(fine, first), (coarse, next)].map(|(last, first)| {
            let last = b.float_u(last);
            let at = b.mul(u, last);
            let left = b.floor(at);
            // The last interval includes its end.
            let limit = b.offset(last, -1.0);
            let left = b.min(left, limit);
            let share = b.sub(at, left);
            let left = b.trunc_i(left);
            let left = b.cast_u(left);
            (b.add_u(first, left), share)
        });
        let finest = b.f32(FINEST as f32);
        let below = b.lt(s, finest);
        let share = b.scale(s, 1.0 / FINEST as f32);
        Place {
            texels,
            mix,
            below,
            share,
        }
    }

    /// The moment at the place.
    fn read(&self, b: &mut Builder, place: &Place, moment: Moment) -> Value {
        let table = self.tables[moment as usize];
        let [fine, coarse] = place.texels.map(|(index, share)| {
            let one = b.u32(1);
            let next = b.add_u(index, one);
            let (left, right) = (b.load(table, index), b.load(table, next));
            lerp(b, left, right, share)
        });
        lerp(b, fine, coarse, place.mix)
    }
}

fn lerp(b: &mut Builder, from: Value, to: Value, share: Value) -> Value {
    let difference = b.sub(to, from);
    let part = b.mul(difference, share);
    b.add(from, part)
}

impl Transfer for Tabulated {
    fn value(&self, b: &mut Builder, x: Value) -> Value {
        b.call(&self.function, &[x])[self.component]
    }

    fn moments(&self, b: &mut Builder, x: &Gaussian) -> Moments {
        let place = self.place(b, x);
        let read = |b: &mut Builder, moment| self.read(b, &place, moment);
        let mean = read(b, Moment::Mean);
        let exact = self.branch.taken(b, place.below, &[x.mean])[self.component];
        let near = lerp(b, exact, mean, place.share);
        let mean = b.select(place.below, near, mean);
        // What is stored is relative to σ; below σ₀ the derivatives are those at σ₀.
        let width = self.domain[1] - self.domain[0];
        let finest = b.f32(FINEST as f32 * width);
        let sd = b.max(x.sd, finest);
        let one = b.f32(1.0);
        let inverse = b.div(one, sd);
        let (inverse2, shrink) = (b.square(inverse), b.mul(x.sd, inverse));
        let inverse3 = b.mul(inverse2, inverse);
        let (first, second) = (read(b, Moment::Slope), read(b, Moment::Curvature));
        let third = read(b, Moment::Third);
        let root = read(b, Moment::Distortion);
        let root = b.mul(root, shrink);
        Moments {
            mean,
            slope: b.mul(first, inverse),
            curvature: b.mul(second, inverse2),
            third: b.mul(third, inverse3),
            distortion: b.square(root),
        }
    }

    fn range(&self, _: &Builder, _: [f32; 2]) -> [f32; 2] {
        self.range
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
