//! A pyramid of moments: the field that bilinear interpolation makes of a picture, its local mean
//! and its local covariance under Gaussians of twice the variance each.
//!
//! Level 0 holds the texels. Level l ≥ 1 holds mean and covariance under a Gaussian of σ² = 2^{l−1}
//! texels², on a grid of at most σ. That is denser than a mip pyramid, which is off by up to a quarter
//! of the detail (MATH §8): with one level an octave the mean is off by 0.07 of the picture's standard
//! deviation where waves are 3 σ long, with two by 0.02. Covariances are those of an actual
//! distribution (Grenier et al. 2022, eq. 10 and 16, with Gaussian weights), never second moments:
//! level 1 starts from the cells between texels, where the integral of a product of bilinear
//! functions is exact, and each further level filters what is inside, C, and what is between, m mᵀ.
//! Everything is computed in f64 about the picture's own mean.

use super::planes::Planes;

/// What lies beyond the edges of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Address {
    /// The picture again.
    Periodic,
    /// Its last texel.
    Clamp,
    /// The picture reversed.
    Mirror,
}

impl Address {
    /// The texel of a row of n that stands at i.
    fn texel(self, i: i64, n: i64) -> usize {
        let within = match self {
            Self::Periodic => i.rem_euclid(n),
            Self::Clamp => i.clamp(0, n - 1),
            Self::Mirror => {
                let place = i.rem_euclid(2 * n);
                place.min(2 * n - 1 - place)
            }
        };
        within as usize
    }

    /// How many samples a level keeps beyond each edge: those that interpolation reads, or those
    /// within which the edge is felt.
    pub(crate) fn margin(self) -> usize {
        match self {
            Self::Periodic | Self::Mirror => 1,
            Self::Clamp => 5,
        }
    }
}

/// Where a level is in the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Level {
    /// Samples in a row and rows, without the margins.
    pub(crate) size: [usize; 2],
    /// The number of samples with the margins.
    pub(crate) padded: [usize; 2],
    /// The first number of the level in the table.
    pub(crate) offset: usize,
    /// Numbers a sample: the means, and but for level 0 the lower triangle of the covariance.
    pub(crate) stride: usize,
}

/// What a pyramid's table holds and where; known without computing it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Layout {
    /// How many channels.
    pub(crate) channels: usize,
    /// Beyond the edges in u and v.
    pub(crate) address: [Address; 2],
    /// The finest first.
    pub(crate) levels: Vec<Level>,
}

/// Entries of the lower triangle of a covariance of n channels.
pub(crate) const fn triangle(n: usize) -> usize {
    n * (n + 1) / 2
}

/// The channels of each entry, in order.
pub(crate) fn pairs(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(|i| (0..=i).map(move |k| (i, k)))
}

impl Layout {
    /// Of a picture of this size: to the level that is wider than the picture, or the texels alone.
    pub(crate) fn new(
        size: [usize; 2],
        channels: usize,
        address: [Address; 2],
        filtered: bool,
    ) -> Self {
        let mut levels: Vec<Level> = Vec::new();
        let mut offset = 0;
        let mut samples = size;
        // Level 1 is as dense as level 0; then each is by √2 less.
        let sparser = |index: usize, n: usize| {
            let step = (0.5 * index.saturating_sub(1) as f64).exp2();
            (n as f64 / step).ceil() as usize
        };
        loop {
            let covariances = if levels.is_empty() {
                0
            } else {
                triangle(channels)
            };
            let stride = channels + covariances;
            let padded = [0, 1].map(|i| samples[i] + 2 * address[i].margin());
            levels.push(Level {
                size: samples,
                padded,
                offset,
                stride,
            });
            offset += padded[0] * padded[1] * stride;
            let done = levels.len() > 1 && samples == [1, 1];
            if done || !filtered {
                break;
            }
            samples = size.map(|n| sparser(levels.len(), n));
        }
        Self {
            channels,
            address,
            levels,
        }
    }

    /// Numbers in the table.
    pub(crate) fn len(&self) -> usize {
        let last = self.levels.last().expect("there is level 0");
        last.offset + last.padded[0] * last.padded[1] * last.stride
    }
}

/// A plane of samples with margins; rows from the top.
type Plane = Vec<f64>;

/// The moments of one level.
struct Moments {
    means: Vec<Plane>,
    /// The lower triangle.
    covariances: Vec<Plane>,
}

/// The variance that a Gaussian has beyond the box of a cell between four texels.
const FIRST: f64 = 1.0 - 1.0 / 12.0;

/// What a pyramid is made of.
pub(crate) struct Baked {
    /// All numbers of the table.
    pub(crate) numbers: Vec<f32>,
    /// The mean covariance of each level: one row a level, zeros for level 0.
    pub(crate) removed: Vec<Vec<f64>>,
}

pub(crate) fn bake(layout: &Layout, picture: &Planes) -> Baked {
    let n = layout.channels;
    let centre: Vec<f64> = (picture.planes.iter())
        .map(|plane| plane.iter().sum::<f64>() / plane.len() as f64)
        .collect();
    let finest = layout.levels[0];
    let padded: Vec<Plane> = (picture.planes.iter().zip(&centre))
        .map(|(plane, centre)| pad(layout, finest, plane, *centre))
        .collect();
    let mut numbers = Vec::with_capacity(layout.len());
    let mut removed = vec![vec![0.0; triangle(n)]];
    store(&mut numbers, &padded, &[], &centre);
    let mut previous: Option<Moments> = None;
    for index in 1..layout.levels.len() {
        let moments = match &previous {
            None => first(layout, &padded),
            Some(finer) => coarser(layout, index, finer),
        };
        store(&mut numbers, &moments.means, &moments.covariances, &centre);
        let inside = |plane: &Plane| inner_mean(layout, layout.levels[index], plane);
        removed.push(moments.covariances.iter().map(inside).collect());
        previous = Some(moments);
    }
    Baked { numbers, removed }
}

/// The samples with margins, about the centre.
fn pad(layout: &Layout, level: Level, plane: &[f64], centre: f64) -> Plane {
    let [width, height] = level.padded;
    let place = |i: usize, axis: usize| {
        let address = layout.address[axis];
        address.texel(i as i64 - address.margin() as i64, level.size[axis] as i64)
    };
    let mut out = Vec::with_capacity(width * height);
    for y in 0..height {
        let row = place(y, 1) * level.size[0];
        out.extend((0..width).map(|x| plane[row + place(x, 0)] - centre));
    }
    out
}

/// Interleaves the planes into the table.
fn store(numbers: &mut Vec<f32>, means: &[Plane], covariances: &[Plane], centre: &[f64]) {
    for i in 0..means[0].len() {
        numbers.extend(means.iter().zip(centre).map(|(m, c)| (m[i] + c) as f32));
        numbers.extend(covariances.iter().map(|plane| plane[i] as f32));
    }
}

/// The mean over the picture itself.
fn inner_mean(layout: &Layout, level: Level, plane: &Plane) -> f64 {
    let [mx, my] = layout.address.map(Address::margin);
    let [nx, ny] = level.size;
    let rows = (my..my + ny).map(|y| &plane[y * level.padded[0] + mx..][..nx]);
    rows.flatten().sum::<f64>() / (nx * ny) as f64
}

/// Level 1 from the texels: the exact moments of the cells between four texels, then the rest of
/// the Gaussian.
fn first(layout: &Layout, texels: &[Plane]) -> Moments {
    let from = layout.levels[0];
    let [width, height] = from.padded;
    let n = texels.len();
    // The cell right of and below each sample; margins end in cells of no width.
    let fold = |i: usize, axis: usize| {
        let address = layout.address[axis];
        let margin = address.margin();
        address.texel(i as i64 - margin as i64, from.size[axis] as i64) + margin
    };
    let corner = |x: usize, y: usize| fold(y, 1) * width + fold(x, 0);
    let mut cells = Moments {
        means: vec![vec![0.0; width * height]; n],
        covariances: vec![vec![0.0; width * height]; triangle(n)],
    };
    for y in 0..height {
        for x in 0..width {
            let at = y * width + x;
            let corners =
                [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)].map(|(x, y)| corner(x, y));
            // f = a + b s + c t + d s t with s, t from −½ to ½: variance b²/12 + c²/12 + d²/144.
            let parts: Vec<[f64; 4]> = (texels.iter())
                .map(|plane| {
                    let [p, q, r, s] = corners.map(|i| plane[i]);
                    [
                        (p + q + r + s) / 4.0,
                        (q - p + s - r) / 2.0,
                        (r - p + s - q) / 2.0,
                        p - q - r + s,
                    ]
                })
                .collect();
            for (plane, part) in cells.means.iter_mut().zip(&parts) {
                plane[at] = part[0];
            }
            for ((i, k), plane) in pairs(n).zip(&mut cells.covariances) {
                let product = |part: usize| parts[i][part] * parts[k][part];
                plane[at] = (product(1) + product(2)) / 12.0 + product(3) / 144.0;
            }
        }
    }
    let axes = [0, 1].map(|axis| Axis::new(layout, axis, 0, 1, FIRST, 0.5));
    filtered(&axes, &cells)
}

/// A level from the finer one.
fn coarser(layout: &Layout, index: usize, finer: &Moments) -> Moments {
    let more = (index as f64 - 2.0).exp2();
    let axes = [0, 1].map(|axis| Axis::new(layout, axis, index - 1, index, more, 0.0));
    filtered(&axes, finer)
}

/// The weights that make the samples of a level along one axis from those of the finer one.
struct Axis {
    /// Samples of the finer level, with margins.
    from: usize,
    /// For each sample: the samples that it is made from, and their weights.
    rows: Vec<Vec<(usize, f64)>>,
}

impl Axis {
    /// A Gaussian of this variance in texels; the finer samples stand `shift` of their distance
    /// after their place.
    fn new(
        layout: &Layout,
        axis: usize,
        from: usize,
        to: usize,
        variance: f64,
        shift: f64,
    ) -> Self {
        let texels = layout.levels[0].size[axis] as f64;
        let address = layout.address[axis];
        let margin = address.margin() as i64;
        let (from, to) = (layout.levels[from], layout.levels[to]);
        let count = from.size[axis] as i64;
        let (fine, coarse) = (
            texels / from.size[axis] as f64,
            texels / to.size[axis] as f64,
        );
        let reach = (5.0 * variance.sqrt() / fine).ceil() as i64 + 1;
        let row = |j: usize| {
            let place = (j as f64 - margin as f64 + 0.5) * coarse;
            let nearest = (place / fine - 0.5 - shift).round() as i64;
            let mut weights: Vec<(usize, f64)> = (nearest - reach..=nearest + reach)
                .map(|i| {
                    let distance = (i as f64 + 0.5 + shift) * fine - place;
                    let sample = match address {
                        // Beyond the margin nothing changes any more.
                        Address::Clamp => i.clamp(-margin, count + margin - 1) + margin,
                        Address::Periodic => address.texel(i, count) as i64 + margin,
                        // A sample between two places is reflected to one between two others.
                        Address::Mirror => {
                            let doubled = (2.0 * shift) as i64;
                            let period = 2 * count;
                            let place = i.rem_euclid(period);
                            let last = 2 * count - 1 - doubled;
                            let folded = if place > last - place {
                                last - place
                            } else {
                                place
                            };
                            folded + margin
                        }
                    };
                    let weight = (-0.5 * distance * distance / variance).exp();
                    (sample as usize, weight)
                })
                .collect();
            let total: f64 = weights.iter().map(|(_, w)| w).sum();
            weights.iter_mut().for_each(|(_, w)| *w /= total);
            weights
        };
        Self {
            from: from.padded[axis],
            rows: (0..to.padded[axis]).map(row).collect(),
        }
    }
}

/// Means filtered, and covariances as what is inside and what is between.
fn filtered(axes: &[Axis; 2], finer: &Moments) -> Moments {
    let means: Vec<Plane> = finer.means.iter().map(|m| separable(axes, m)).collect();
    let covariances = pairs(means.len())
        .zip(&finer.covariances)
        .map(|((i, k), inside)| {
            let products: Plane = (inside.iter().zip(&finer.means[i]).zip(&finer.means[k]))
                .map(|((c, x), y)| c + x * y)
                .collect();
            let mut plane = separable(axes, &products);
            for ((c, x), y) in plane.iter_mut().zip(&means[i]).zip(&means[k]) {
                *c -= x * y;
                if i == k {
                    *c = c.max(0.0);
                }
            }
            plane
        });
    Moments {
        covariances: covariances.collect(),
        means,
    }
}

fn separable([horizontal, vertical]: &[Axis; 2], plane: &Plane) -> Plane {
    let width = horizontal.rows.len();
    let mut between = vec![0.0; width * vertical.from];
    for (row, out) in plane
        .chunks_exact(horizontal.from)
        .zip(between.chunks_exact_mut(width))
    {
        for (out, weights) in out.iter_mut().zip(&horizontal.rows) {
            *out = weights.iter().map(|&(i, w)| w * row[i]).sum();
        }
    }
    let mut out = vec![0.0; width * vertical.rows.len()];
    for (out, weights) in out.chunks_exact_mut(width).zip(&vertical.rows) {
        for &(i, w) in weights {
            let row = &between[i * width..][..width];
            out.iter_mut().zip(row).for_each(|(out, x)| *out += w * x);
        }
    }
    out
}
