//! Reading a map: the level, the taps along the major axis, and the moments from them.

use super::{FINEST, LEVELS, Map, Moment, Moments, Packing, SECOND};
use crate::ir::{Builder, FunctionRef, Module, Value};

/// The largest variance of a position, in squared domains: over it every period is long gone.
const WIDEST: f32 = 1e6;

/// s_min is at least this share of s_max.
const ASPECT: f32 = 0.2;

/// Nodes x and weights of five taps along the major axis: uniform nodes with Gaussian weights, of
/// unit variance. Gauss–Hermite nodes err 1.5 times as much on maps with jumps (MATH §5); three taps
/// leave gaps between them where the ratio of the axes is capped.
fn rule() -> [[f64; 2]; 5] {
    let nodes = [-2.0, -1.0, 0.0, 1.0, 2.0f64];
    let weights = nodes.map(|x| (-0.5 * x * x).exp());
    let total: f64 = weights.iter().sum();
    let squares: f64 = nodes.iter().zip(weights).map(|(x, w)| w * x * x).sum();
    let sd = (squares / total).sqrt();
    std::array::from_fn(|i| [nodes[i] / sd, weights[i] / total])
}

/// A function that reads one level of a table, linearly between texels: the codes of all components
/// at (u, v) of [0, 1]², for a level of so many intervals whose texels begin at `first`.
pub(super) fn bilinear(
    module: &mut Module,
    name: &str,
    table: u32,
    packing: &Packing,
) -> FunctionRef {
    let mut b = Builder::new(name, "One level of a map's table, between its texels.");
    let place = ["u", "v"].map(|name| b.param_f32(name));
    let (intervals, first) = (b.param_f32("intervals"), b.param_f32("first"));
    let last = b.offset(intervals, -1.0);
    let [(x, across), (y, down)] = place.map(|coordinate| {
        let at = b.mul(coordinate, intervals);
        let whole = b.floor(at);
        // The last interval includes its end.
        let whole = b.min(whole, last);
        (whole, b.sub(at, whole))
    });
    let stride = b.offset(intervals, 1.0);
    // Whole numbers below 2²⁴ are exact.
    let start = b.mul(y, stride);
    let start = b.add(start, x);
    let start = b.add(start, first);
    let corners = [0, 1].map(|row| {
        let index = if row == 0 {
            start
        } else {
            b.add(start, stride)
        };
        let index = b.trunc_i(index);
        let index = b.cast_u(index);
        let one = b.u32(1);
        let next = b.add_u(index, one);
        [index, next].map(|index| {
            let number = b.load(table, index);
            packing.unpack(&mut b, number)
        })
    });
    for i in 0..packing.components() {
        let [above, below] = [0, 1].map(|row: usize| {
            let [left, right] = &corners[row];
            lerp(&mut b, left[i], right[i], across)
        });
        let value = lerp(&mut b, above, below, down);
        b.result(format!("code_{i}"), value);
    }
    b.finish(module)
}

fn lerp(b: &mut Builder, from: Value, to: Value, share: Value) -> Value {
    let difference = b.sub(to, from);
    let part = b.mul(difference, share);
    b.add(from, part)
}

/// The two levels that a σ lies between, as (intervals, first) each, and the coarser one's share.
struct Levels {
    rows: [[Value; 2]; 2],
    share: Value,
}

/// Σ as an isotropic part and taps: s, and for each tap its place, weight and distance from the
/// mean along (x, y), in domains.
struct Taps {
    s: Value,
    /// s relative to the finest σ where the whole footprint is smaller than that, else 1.
    shrink: Value,
    /// Whether the footprint is smaller than the finest σ.
    below: Value,
    places: Vec<Tap>,
}

impl Taps {
    /// The mean of a component over the taps.
    fn weighted(&self, b: &mut Builder, values: &[Vec<Value>], component: usize) -> Value {
        let mut sum = b.f32(0.0);
        for (tap, values) in self.places.iter().zip(values) {
            let part = b.scale(values[component], tap.weight);
            sum = b.add(sum, part);
        }
        sum
    }
}

/// The eigenvalues of a covariance (11, 12, 22), the larger first.
fn eigenvalues(b: &mut Builder, [xx, xy, yy]: [Value; 3]) -> (Value, Value) {
    let (sum, difference) = (b.add(xx, yy), b.sub(xx, yy));
    let (half, tilt) = (b.scale(sum, 0.5), b.scale(difference, 0.5));
    let square = b.dot(&[tilt, xy], &[tilt, xy]);
    let root = b.sqrt(square);
    (b.add(half, root), b.sub(half, root))
}

struct Tap {
    weight: f32,
    offset: [Value; 2],
    place: [Value; 2],
}

impl Map {
    /// The moments of all components at a mean and a covariance (11, 12, 22).
    pub(super) fn moments(
        &self,
        b: &mut Builder,
        mean: [Value; 2],
        covariance: [Value; 3],
    ) -> Vec<Moments> {
        let inverse = self.domain.widths().map(|w| 1.0 / w);
        let taps = self.taps(b, mean, covariance, &rule());
        let levels = self.level(b, taps.s);
        let means = self.read(b, &taps, &levels, Moment::Mean);
        let [slopes_x, slopes_y] = [Moment::SlopeX, Moment::SlopeY].map(|moment| {
            // What is stored is relative to σ.
            let one = b.f32(1.0);
            let inverse = b.div(one, taps.s);
            let mut read = self.read(b, &taps, &levels, moment);
            for value in read.iter_mut().flatten() {
                *value = b.mul(*value, inverse);
            }
            read
        });
        let roots = self.read(b, &taps, &levels, Moment::Distortion);
        let weighted = |b: &mut Builder, values: &[Vec<Value>], component: usize| {
            taps.weighted(b, values, component)
        };
        let points = self.branch.taken(b, taps.below, &mean);
        (0..self.packing.components())
            .map(|i| {
                let tapped = weighted(b, &means, i);
                let near = lerp(b, points[i], tapped, taps.shrink);
                let mean = b.select(taps.below, near, tapped);
                let slopes = [&slopes_x, &slopes_y].map(|slopes| weighted(b, slopes, i));
                // The residual T − E[T] − α·(x − m), split at the taps: within each, D and the
                // slope beyond α; between them, the means beyond the line.
                let mut distortion = b.f32(0.0);
                for (k, tap) in taps.places.iter().enumerate() {
                    let root = b.mul(roots[k][i], taps.shrink);
                    let mut sum = b.square(root);
                    for (of, slope) in [&slopes_x, &slopes_y].into_iter().zip(slopes) {
                        let beyond = b.sub(of[k][i], slope);
                        let beyond = b.mul(beyond, taps.s);
                        let beyond = b.mul(beyond, taps.shrink);
                        let square = b.square(beyond);
                        sum = b.add(sum, square);
                    }
                    let line = b.dot(&tap.offset, &slopes);
                    let above = b.sub(means[k][i], tapped);
                    let above = b.sub(above, line);
                    let above = b.mul(above, taps.shrink);
                    let square = b.square(above);
                    sum = b.add(sum, square);
                    let part = b.scale(sum, tap.weight);
                    distortion = b.add(distortion, part);
                }
                Moments {
                    mean,
                    slopes: [0, 1].map(|axis| b.scale(slopes[axis], inverse[axis])),
                    distortion,
                }
            })
            .collect()
    }

    /// The means of all components at a mean and a covariance that are a part of a footprint; a part
    /// below the finest σ is taken for that.
    pub(super) fn part(
        &self,
        b: &mut Builder,
        mean: [Value; 2],
        covariance: [Value; 3],
    ) -> Vec<Value> {
        let taps = self.taps(b, mean, covariance, &rule());
        let levels = self.level(b, taps.s);
        let means = self.read(b, &taps, &levels, Moment::Mean);
        (0..self.packing.components())
            .map(|i| taps.weighted(b, &means, i))
            .collect()
    }

    /// Whether a footprint of this covariance is smaller than the finest σ.
    pub(super) fn is_fine(&self, b: &mut Builder, covariance: [Value; 3]) -> Value {
        let [xx, xy, yy] = self.relative(b, covariance);
        let (largest, _) = eigenvalues(b, [xx, xy, yy]);
        let finest = b.f32((FINEST * FINEST) as f32);
        b.lt(largest, finest)
    }

    /// A covariance in units of the domain, not larger than [`WIDEST`].
    fn relative(&self, b: &mut Builder, [xx, xy, yy]: [Value; 3]) -> [Value; 3] {
        let [p, q] = self.domain.widths().map(|w| 1.0 / w);
        let covariance = [b.scale(xx, p * p), b.scale(xy, p * q), b.scale(yy, q * q)];
        // One factor for all three keeps the shape.
        let limit = b.f32(WIDEST);
        let most = b.max(covariance[0], covariance[2]);
        let most = b.max(most, limit);
        let factor = b.div(limit, most);
        covariance.map(|v| b.mul(v, factor))
    }

    fn taps(
        &self,
        b: &mut Builder,
        mean: [Value; 2],
        covariance: [Value; 3],
        rule: &[[f64; 2]],
    ) -> Taps {
        let [xx, xy, yy] = self.relative(b, covariance);
        let (more, less) = eigenvalues(b, [xx, xy, yy]);
        let (difference, root) = (b.sub(xx, yy), b.sub(more, less));
        let finest = FINEST as f32;
        let floor = b.f32(finest * finest);
        let capped = b.scale(more, ASPECT * ASPECT);
        let isotropic = b.max(less, capped);
        let isotropic = b.max(isotropic, floor);
        let s = b.sqrt(isotropic);
        let along = b.sub(more, isotropic);
        let zero = b.f32(0.0);
        let along = b.max(along, zero);
        let along = b.sqrt(along);
        // v = (√½(1 + cos 2θ), ±√½(1 − cos 2θ)); where Σ is isotropic there is no direction and no
        // distance either.
        let guarded = b.offset(root, 1e-30);
        let cosine = b.div(difference, guarded);
        let cosine = b.clamp(cosine, -1.0, 1.0);
        let half_cosine = b.scale(cosine, 0.5);
        let (plus, minus) = (b.offset(half_cosine, 0.5), b.neg(half_cosine));
        let minus = b.offset(minus, 0.5);
        let (vx, vy) = (b.sqrt(plus), b.sqrt(minus));
        let negative = b.lt(xy, zero);
        let other = b.neg(vy);
        let vy = b.select(negative, other, vy);
        let axis = [b.mul(vx, along), b.mul(vy, along)];
        let size = b.sqrt(more);
        let share = b.scale(size, 1.0 / finest);
        let one = b.f32(1.0);
        let below = b.lt(share, one);
        let shrink = b.min(share, one);
        let centre = [0, 1].map(|i| {
            let [low, high] = self.domain.bounds[i];
            let from = b.offset(mean[i], -low);
            b.scale(from, 1.0 / (high - low))
        });
        let places = (rule.iter())
            .map(|&[x, weight]| {
                let offset = axis.map(|a| b.scale(a, x as f32));
                let place = [0, 1].map(|i| {
                    let at = b.add(centre[i], offset[i]);
                    if self.domain.periodic {
                        let whole = b.floor(at);
                        b.sub(at, whole)
                    } else {
                        b.clamp(at, 0.0, 1.0)
                    }
                });
                Tap {
                    weight: weight as f32,
                    offset,
                    place,
                }
            })
            .collect();
        Taps {
            s,
            shrink,
            below,
            places,
        }
    }

    fn level(&self, b: &mut Builder, s: Value) -> Levels {
        let coarsest = super::sigma(LEVELS - 1) as f32;
        let (finest, second) = (FINEST as f32, SECOND as f32);
        let s = b.clamp(s, finest, coarsest);
        // 2 log₂(σ/σ₁) levels above the second; the first is two octaves below it.
        let ratio = b.scale(s, 1.0 / second);
        let log = b.ln(ratio);
        let level = b.scale(log, 2.0 / std::f32::consts::LN_2);
        let level = b.floor(level);
        let level = b.clamp(level, 0.0, (LEVELS - 3) as f32);
        // Linear in σ: (σ/σ_l − 1)/(√2 − 1).
        let exponent = b.scale(level, -0.5 * std::f32::consts::LN_2);
        let down = b.exp(exponent);
        let relative = b.mul(ratio, down);
        let share = b.offset(relative, -1.0);
        let share = b.scale(share, 1.0 / (std::f32::consts::SQRT_2 - 1.0));
        let from = b.offset(s, -finest);
        let first = b.scale(from, 1.0 / (second - finest));
        let boundary = b.f32(second);
        let is_first = b.lt(s, boundary);
        let (zero, next) = (b.f32(0.0), b.offset(level, 1.0));
        let row = b.select(is_first, zero, next);
        let share = b.select(is_first, first, share);
        let share = b.clamp(share, 0.0, 1.0);
        let row = b.trunc_i(row);
        let row = b.cast_u(row);
        let two = b.u32(2);
        let row = b.mul_u(row, two);
        let rows = [0, 1].map(|next| {
            [0, 1].map(|column| {
                let step = b.u32(2 * next + column);
                let at = b.add_u(row, step);
                b.load(self.levels, at)
            })
        });
        Levels { rows, share }
    }

    /// One moment's values at every tap, by component.
    fn read(
        &self,
        b: &mut Builder,
        taps: &Taps,
        levels: &Levels,
        moment: Moment,
    ) -> Vec<Vec<Value>> {
        let reader = &self.readers[moment as usize];
        let table = self.tables[moment as usize];
        (taps.places.iter())
            .map(|tap| {
                let [fine, coarse] = levels.rows.map(|[intervals, first]| {
                    b.call(reader, &[tap.place[0], tap.place[1], intervals, first])
                });
                let codes: Vec<Value> = (fine.iter().zip(&coarse))
                    .map(|(&fine, &coarse)| lerp(b, fine, coarse, levels.share))
                    .collect();
                self.packing.decode(b, table, &codes)
            })
            .collect()
    }
}
