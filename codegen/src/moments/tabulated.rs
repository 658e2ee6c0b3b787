//! Functions of one signal by tables: a σ-pyramid for each moment, baked in f64.
//!
//! Level l holds the moment at σ_l = σ₀ 2^{l/2} on a grid of spacing σ_l/2 over the domain, read
//! linearly in position and in σ; below σ₀ the function itself is the other end (DESIGN §7; MATH
//! §6: 8.7 KB a moment, largest error 14/1000 on ten-stripe maps). The k-th derivative of the mean
//! is stored as σᵏ E[T⁽ᵏ⁾] = E[T Heₖ(z)], the distortion as its root.

use super::{Gaussian, Moments, Transfer};
use crate::ir::{Builder, FunctionRef, Module, Value};

/// σ₀, in domains.
const FINEST: f64 = 0.004;
/// How many levels: the coarsest σ is 0.004 · 2^{13/2} = 0.36 domains, ten of which hold the
/// process's own σ.
const LEVELS: usize = 14;
/// Samples of the function over the domain; 8 a σ₀.
const SAMPLES: usize = 2048;
/// How far a Gaussian reaches, in σ.
const REACH: f64 = 4.5;

/// A function sampled over a domain, ready to bake moments from.
#[derive(Clone, Debug)]
pub(crate) struct Sampled {
    /// Where the domain begins and ends; beyond it the function is taken for constant.
    pub(crate) domain: [f32; 2],
    /// The values at the centres of [`SAMPLES`] cells of the domain.
    values: Vec<f64>,
}

impl Sampled {
    /// Where to sample a function over a domain.
    pub(crate) fn points(domain: [f32; 2]) -> Vec<f32> {
        let width = f64::from(domain[1]) - f64::from(domain[0]);
        (0..SAMPLES)
            .map(|i| (f64::from(domain[0]) + width * (i as f64 + 0.5) / SAMPLES as f64) as f32)
            .collect()
    }

    /// From the values at [`Sampled::points`].
    pub(crate) fn new(domain: [f32; 2], values: Vec<f64>) -> Self {
        assert_eq!(values.len(), SAMPLES, "samples of a function");
        Self { domain, values }
    }

    fn at(&self, index: i64) -> f64 {
        self.values[index.clamp(0, SAMPLES as i64 - 1) as usize]
    }

    /// The least and largest value.
    fn range(&self) -> [f32; 2] {
        self.values.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], &v| {
            [low.min(v as f32), high.max(v as f32)]
        })
    }

    /// Texels of a level: its grid covers the domain with spacing σ/2.
    fn texels(level: usize) -> usize {
        (2.0 / sigma(level)).ceil() as usize + 1
    }

    /// One moment's pyramid: all levels, finest first.
    fn pyramid(&self, moment: Moment) -> Vec<f32> {
        let mut out = Vec::new();
        for level in 0..LEVELS {
            let sd = sigma(level) * SAMPLES as f64;
            let reach = (REACH * sd).ceil() as i64;
            let texels = Self::texels(level);
            for texel in 0..texels {
                // The centre in samples; sample i stands at i + ½.
                let centre = texel as f64 / (texels - 1) as f64 * SAMPLES as f64 - 0.5;
                let middle = centre.round() as i64;
                let mut sums = [0.0; 5];
                for i in middle - reach..=middle + reach {
                    let z = (i as f64 - centre) / sd;
                    let weight = (-0.5 * z * z).exp();
                    let value = self.at(i);
                    let hermite = [1.0, z, z * z - 1.0, z * (z * z - 3.0)];
                    for (sum, h) in sums.iter_mut().zip(hermite) {
                        *sum += weight * h * value;
                    }
                    sums[4] += weight;
                }
                let [mean, first, second, third] = [0, 1, 2, 3].map(|k| sums[k] / sums[4]);
                out.push(match moment {
                    Moment::Mean => mean,
                    Moment::Slope => first,
                    Moment::Curvature => second,
                    Moment::Third => third,
                    Moment::Distortion => {
                        let mut rest = 0.0;
                        for i in middle - reach..=middle + reach {
                            let z = (i as f64 - centre) / sd;
                            let residual = self.at(i) - mean - first * z;
                            rest += (-0.5 * z * z).exp() * residual * residual;
                        }
                        (rest / sums[4]).sqrt()
                    }
                } as f32);
            }
        }
        out
    }
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

/// Which moments of a tabulated function are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Demand {
    /// Slope and distortion: something reads the result's spread.
    pub(crate) spread: bool,
    /// Derivatives for the second order and the third cumulant.
    pub(crate) skew: bool,
}

/// A function of one number with baked moments.
#[derive(Clone, Debug)]
pub(crate) struct Tabulated {
    function: FunctionRef,
    component: usize,
    domain: [f32; 2],
    range: [f32; 2],
    /// The table of texel counts and offsets of the levels.
    levels: u32,
    tables: [Option<u32>; 5],
}

impl Tabulated {
    /// Bakes what is demanded. `function` takes a number and gives the components.
    pub(crate) fn bake(
        module: &mut Module,
        name: &str,
        function: FunctionRef,
        component: usize,
        sampled: &Sampled,
        demand: Demand,
    ) -> Self {
        let mut layout = Vec::new();
        let mut offset = 0;
        for level in 0..LEVELS {
            layout.extend([Sampled::texels(level) as f32, offset as f32]);
            offset += Sampled::texels(level);
        }
        let levels = module.table("pyramid_levels", layout);
        let mut table = |wanted: bool, moment: Moment, suffix: &str| {
            wanted.then(|| module.table(format!("{name}_{suffix}"), sampled.pyramid(moment)))
        };
        let tables = [
            table(true, Moment::Mean, "mean"),
            table(demand.spread, Moment::Slope, "slope"),
            table(demand.spread && demand.skew, Moment::Curvature, "curvature"),
            table(demand.skew, Moment::Third, "third"),
            table(demand.spread, Moment::Distortion, "distortion"),
        ];
        let range = sampled.range();
        Self { function, component, domain: sampled.domain, range, levels, tables }
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
        let inside = b.clamp(x.mean, low, high);
        let u = b.offset(inside, -low);
        let u = b.scale(u, 1.0 / width);
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
        let two = b.u32(2);
        let row = b.mul_u(row, two);
        let texels = [0, 1].map(|next| {
            let step = b.u32(2 * next);
            let row = b.add_u(row, step);
            let one = b.u32(1);
            let second = b.add_u(row, one);
            let count = b.load(self.levels, row);
            let offset = b.load(self.levels, second);
            let last = b.offset(count, -1.0);
            let at = b.mul(u, last);
            let left = b.floor(at);
            // The last interval includes its end.
            let limit = b.offset(last, -1.0);
            let left = b.min(left, limit);
            let share = b.sub(at, left);
            let index = b.add(left, offset);
            let index = b.trunc_i(index);
            (b.cast_u(index), share)
        });
        let finest = b.f32(FINEST as f32);
        let below = b.lt(s, finest);
        let share = b.scale(s, 1.0 / FINEST as f32);
        Place { texels, mix, below, share }
    }

    /// The moment at the place, where its table exists.
    fn read(&self, b: &mut Builder, place: &Place, moment: Moment) -> Option<Value> {
        let table = self.tables[moment as usize]?;
        let [fine, coarse] = place.texels.map(|(index, share)| {
            let one = b.u32(1);
            let next = b.add_u(index, one);
            let (left, right) = (b.load(table, index), b.load(table, next));
            lerp(b, left, right, share)
        });
        Some(lerp(b, fine, coarse, place.mix))
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
        let zero = b.f32(0.0);
        let read = |b: &mut Builder, moment| self.read(b, &place, moment).unwrap_or(zero);
        let mean = read(b, Moment::Mean);
        let exact = self.value(b, x.mean);
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
