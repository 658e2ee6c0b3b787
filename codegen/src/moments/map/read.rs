//! Reading a map: the level, the taps along the major axis, and the moments from them.

use super::super::tabulated::{half_octave, lerp};
use super::{FINEST, LEVELS, MOMENTS, Map, Moment, Moments, Packing, SECOND};
use crate::ir::{Bool, Builder, Float, FunctionRef, Module, Sym2, Vec2};

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
    let b = &Builder::new(name, "One level of a map's table, between its texels.");
    let place = b.float_params(["u", "v"]);
    let [intervals, first] = b.float_params(["intervals", "first"]);
    let [(x, across), (y, down)] = place.map(|coordinate| {
        let at = coordinate * intervals;
        // The last interval includes its end.
        let whole = at.floor().min(intervals + -1.0);
        (whole, at - whole)
    });
    // Whole numbers below 2²⁴ are exact.
    let stride = intervals + 1.0;
    let start = y * stride + x + first;
    let [above, below] = [start, start + stride].map(|index| {
        let index = index.to_int().to_uint();
        [index, index + 1].map(|index| packing.unpack(b.load(table, index)))
    });
    for i in 0..packing.components() {
        let [above, below] = [&above, &below].map(|[left, right]| lerp(left[i], right[i], across));
        b.result(format!("code_{i}"), lerp(above, below, down));
    }
    b.finish(module)
}

/// The two levels that a σ lies between, as (intervals, first) each, and the coarser one's share.
pub(super) struct Levels<'b> {
    pub(super) rows: [[Float<'b>; 2]; 2],
    pub(super) share: Float<'b>,
}

/// A footprint in domains: where it is, the direction of its major axis, and the variances along that
/// and across it.
pub(super) struct Axes<'b> {
    pub(super) centre: Vec2<'b>,
    pub(super) direction: Vec2<'b>,
    pub(super) variances: [Float<'b>; 2],
}

/// Σ as an isotropic part and taps: s, and for each tap its place, weight and distance from the
/// mean along (x, y), in domains.
struct Taps<'b> {
    s: Float<'b>,
    /// s relative to the finest σ where the whole footprint is smaller than that, else 1.
    shrink: Float<'b>,
    /// Whether the footprint is smaller than the finest σ.
    below: Bool<'b>,
    /// The distance of a tap of x = 1 from the mean.
    axis: Vec2<'b>,
    places: [Tap<'b>; 5],
}

struct Tap<'b> {
    weight: f32,
    /// x: how far along the axis.
    along: f32,
    offset: Vec2<'b>,
    place: Vec2<'b>,
}

impl<'b> Taps<'b> {
    /// The mean of one number for each tap.
    fn weighted(&self, value: impl Fn(usize) -> Float<'b>) -> Float<'b> {
        let terms = self.places.iter().enumerate();
        let b = self.s.builder();
        b.sum(terms.map(|(k, tap)| value(k) * tap.weight))
    }
}

impl Map {
    /// The moments of all components at a mean and a covariance.
    pub(super) fn moments<'b>(&self, mean: Vec2<'b>, covariance: Sym2<'b>) -> Vec<Moments<'b>> {
        let taps = self.taps(mean, covariance);
        let levels = self.levels(taps.s);
        let [means, slopes_x, slopes_y, roots] =
            MOMENTS.map(|(moment, _)| self.read(&taps, &levels, moment));
        let points = self.branch.taken(taps.below, mean);
        let [width, height] = self.domain.widths();
        // What is stored is relative to σ.
        let by_s = 1.0 / taps.s;
        let by_variance = 1.0 / (taps.s.square() + taps.axis.dot(taps.axis));
        let components = 0..self.packing.components();
        let tapped: Vec<Float<'b>> = (components.clone())
            .map(|i| taps.weighted(|k| means[k][i]))
            .collect();
        let long = self.long(mean, covariance, tapped.clone());
        components
            .map(|i| {
                let slopes = |k: usize| Vec2([slopes_x[k][i], slopes_y[k][i]]) * by_s;
                // α is the regression on the place: across the axis the mean of the slopes, along it
                // cov(T, x)/Var x, of which the taps' means have their part. The mean of the slopes
                // alone would take a jump at a tap for one of the whole footprint.
                let within = Vec2([0, 1].map(|axis| taps.weighted(|k| slopes(k)[axis])));
                let between = taps.weighted(|k| (means[k][i] - tapped[i]) * taps.places[k].along);
                let beyond = (between - taps.axis.dot(within)) * by_variance;
                let all = within + taps.axis * beyond;
                // The residual T − E[T] − α·(x − m), split at the taps: within each, D and the
                // slope beyond α; between them, the means beyond the line.
                let distortion = taps.weighted(|k| {
                    let [x, y] = *((slopes(k) - all) * taps.s * taps.shrink);
                    let line = taps.places[k].offset.dot(all);
                    let above = (means[k][i] - tapped[i] - line) * taps.shrink;
                    (roots[k][i] * taps.shrink).square() + x.square() + y.square() + above.square()
                });
                let near = lerp(points[i], long[i], taps.shrink);
                Moments {
                    mean: taps.below.select(near, long[i]),
                    slopes: Vec2([all[0] * (1.0 / width), all[1] * (1.0 / height)]),
                    distortion,
                }
            })
            .collect()
    }

    /// The means of all components at a mean and a covariance that are a part of a footprint; a part
    /// below the finest σ is taken for that.
    pub(super) fn part<'b>(&self, mean: Vec2<'b>, covariance: Sym2<'b>) -> Vec<Float<'b>> {
        let taps = self.taps(mean, covariance);
        let means = self.read(&taps, &self.levels(taps.s), Moment::Mean);
        let components = 0..self.packing.components();
        components.map(|i| taps.weighted(|k| means[k][i])).collect()
    }

    /// Whether a footprint of this covariance is smaller than the finest σ.
    pub(super) fn is_fine<'b>(&self, covariance: Sym2<'b>) -> Bool<'b> {
        let [largest, _] = self.relative(covariance).eigenvalues();
        largest.lt((FINEST * FINEST) as f32)
    }

    /// A covariance in units of the domain, not larger than [`WIDEST`].
    fn relative<'b>(&self, Sym2([xx, xy, yy]): Sym2<'b>) -> Sym2<'b> {
        let [p, q] = self.domain.widths().map(|w| 1.0 / w);
        let covariance = Sym2([xx * (p * p), xy * (p * q), yy * (q * q)]);
        // One factor for all three keeps the shape.
        let most = covariance[0].max(covariance[2]).max(WIDEST);
        covariance * (WIDEST / most)
    }

    pub(super) fn axes<'b>(&self, mean: Vec2<'b>, covariance: Sym2<'b>) -> Axes<'b> {
        let covariance = self.relative(covariance);
        let (Sym2([xx, xy, yy]), [more, less]) = (covariance, covariance.eigenvalues());
        // v = (√½(1 + cos 2θ), ±√½(1 − cos 2θ)); where Σ is isotropic there is no direction and no
        // distance either.
        let cosine = ((xx - yy) / (more - less + 1e-30)).clamp(-1.0, 1.0);
        let vx = (cosine * 0.5 + 0.5).sqrt();
        let vy = (0.5 - cosine * 0.5).sqrt();
        let centre = std::array::from_fn(|i| {
            let [low, high] = self.domain.bounds[i];
            (mean[i] + -low) * (1.0 / (high - low))
        });
        Axes {
            centre: Vec2(centre),
            direction: Vec2([vx, xy.lt(0.0).select(-vy, vy)]),
            variances: [more, less],
        }
    }

    fn taps<'b>(&self, mean: Vec2<'b>, covariance: Sym2<'b>) -> Taps<'b> {
        let Axes {
            centre,
            direction,
            variances: [more, less],
        } = self.axes(mean, covariance);
        let finest = FINEST as f32;
        let isotropic = less.max(more * (ASPECT * ASPECT)).max(finest * finest);
        let axis = direction * (more - isotropic).max(0.0).sqrt();
        let places = rule().map(|[x, weight]| {
            let offset = axis * x as f32;
            let place = (centre + offset).map(|at| {
                if self.domain.periodic {
                    at - at.floor()
                } else {
                    at.clamp(0.0, 1.0)
                }
            });
            Tap {
                weight: weight as f32,
                along: x as f32,
                offset,
                place,
            }
        });
        let share = more.sqrt() * (1.0 / finest);
        Taps {
            s: isotropic.sqrt(),
            shrink: share.min(1.0),
            below: share.lt(1.0),
            axis,
            places,
        }
    }

    pub(super) fn levels<'b>(&self, s: Float<'b>) -> Levels<'b> {
        let (finest, second) = (FINEST as f32, SECOND as f32);
        let s = s.clamp(finest, super::sigma(LEVELS - 1) as f32);
        // Levels above the second; the first is two octaves below it.
        let (level, share) = half_octave(s * (1.0 / second), LEVELS - 3);
        let is_first = s.lt(second);
        let of_first = (s + -finest) * (1.0 / (second - finest));
        let row = is_first.select(0.0, level + 1.0).to_int().to_uint() * 2;
        let load = |column: u32| s.builder().load(self.levels, row + column);
        Levels {
            rows: [[load(0), load(1)], [load(2), load(3)]],
            share: is_first.select(of_first, share).clamp(0.0, 1.0),
        }
    }

    /// One moment's values at every tap, by component.
    fn read<'b>(
        &self,
        taps: &Taps<'b>,
        levels: &Levels<'b>,
        moment: Moment,
    ) -> Vec<Vec<Float<'b>>> {
        let (b, moment) = (taps.s.builder(), moment as usize);
        (taps.places.iter())
            .map(|tap| {
                let [fine, coarse] =
                    (levels.rows).map(|row| b.call(&self.readers[moment], (tap.place, row)));
                let codes = fine.into_iter().zip(coarse);
                let codes = codes.map(|(fine, coarse)| lerp(fine, coarse, levels.share));
                self.packing.decode(self.tables[moment], codes)
            })
            .collect()
    }
}
