//! An example as independent Gaussian channels: its colours along their principal axes, each made
//! Gaussian by ranks, and the way back.

use super::planes::Planes;

/// A picture along the principal axes of its colours.
#[derive(Clone, Debug)]
pub(crate) struct Example {
    /// The mean colour.
    pub(crate) mean: Vec<f64>,
    /// The axes, unit and orthogonal, the one with the largest variance first.
    pub(crate) axes: Vec<Vec<f64>>,
    /// The coordinates of all texels along each axis.
    coordinates: Planes,
}

impl Example {
    pub(crate) fn new(colors: &Planes) -> Self {
        let n = colors.planes.len();
        let texels = colors.planes[0].len();
        let average = |plane: &Vec<f64>| plane.iter().sum::<f64>() / texels as f64;
        let mean: Vec<f64> = colors.planes.iter().map(average).collect();
        let covariance = |i: usize, k: usize| {
            let pairs = colors.planes[i].iter().zip(&colors.planes[k]);
            pairs
                .map(|(x, y)| (x - mean[i]) * (y - mean[k]))
                .sum::<f64>()
                / texels as f64
        };
        let matrix = (0..n).map(|i| (0..n).map(|k| covariance(i, k)).collect());
        let axes = principal(matrix.collect());
        let along = |axis: &Vec<f64>| -> Vec<f64> {
            let at = |t: usize| {
                let channels = axis.iter().zip(&colors.planes).zip(&mean);
                channels.map(|((a, plane), m)| a * (plane[t] - m)).sum()
            };
            (0..texels).map(at).collect()
        };
        let planes = axes.iter().map(along).collect();
        Self {
            mean,
            axes,
            coordinates: Planes {
                size: colors.size,
                planes,
            },
        }
    }

    /// Texels in a row, and rows.
    pub(crate) fn size(&self) -> [usize; 2] {
        self.coordinates.size
    }

    /// The least and the largest coordinate along an axis.
    pub(crate) fn range(&self, axis: usize) -> [f64; 2] {
        let plane = &self.coordinates.planes[axis];
        let low = plane.iter().copied().fold(f64::INFINITY, f64::min);
        let high = plane.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        [low, high]
    }

    /// The wavelength of the first axis in texels, 2π √(Var/E|∇|²); infinite for a flat picture.
    pub(crate) fn wavelength(&self) -> f64 {
        let [width, height] = self.coordinates.size;
        let plane = &self.coordinates.planes[0];
        let (mut slopes, mut squares) = (0.0, 0.0);
        for y in 0..height {
            for x in 0..width {
                let here = plane[y * width + x];
                let right = plane[y * width + (x + 1) % width];
                let below = plane[(y + 1) % height * width + x];
                slopes += (right - here).powi(2) + (below - here).powi(2);
                squares += here * here;
            }
        }
        std::f64::consts::TAU * (squares / slopes).sqrt()
    }

    /// The channels by ranks: the texel of rank r of n stands at Φ⁻¹((r + ½)/n); equal ones share
    /// their middle rank.
    pub(crate) fn gaussian(&self) -> Gaussianised {
        let texels = self.coordinates.planes[0].len();
        let mut planes = Vec::new();
        let mut sorted = Vec::new();
        for plane in &self.coordinates.planes {
            let mut order: Vec<usize> = (0..texels).collect();
            order.sort_by(|&i, &k| plane[i].total_cmp(&plane[k]));
            let values: Vec<f64> = order.iter().map(|&i| plane[i]).collect();
            // Coordinates that differ by rounding are equal.
            let same = 1e-9 * (values[texels - 1] - values[0]);
            let mut gaussian = vec![0.0; texels];
            let mut score = -6.0;
            let mut first = 0;
            while first < texels {
                let end = values[first..].partition_point(|&v| v <= values[first] + same) + first;
                let middle = 0.5 * (first + end) as f64 / texels as f64;
                score = quantile(middle, score);
                order[first..end].iter().for_each(|&i| gaussian[i] = score);
                first = end;
            }
            planes.push(gaussian);
            sorted.push(values);
        }
        Gaussianised {
            planes: Planes {
                size: self.coordinates.size,
                planes,
            },
            sorted,
        }
    }
}

/// An example by ranks, and its coordinates in their order.
#[derive(Clone, Debug)]
pub(crate) struct Gaussianised {
    pub(crate) planes: Planes,
    sorted: Vec<Vec<f64>>,
}

impl Gaussianised {
    /// The coordinate along an axis that a Gaussian number stands for.
    pub(crate) fn coordinate(&self, axis: usize, score: f64) -> f64 {
        let values = &self.sorted[axis];
        let last = values.len() - 1;
        let place = distribution(score) * values.len() as f64 - 0.5;
        let place = place.clamp(0.0, last as f64);
        let left = (place as usize).min(last.saturating_sub(1));
        let share = place - left as f64;
        let right = values[(left + 1).min(last)];
        values[left] + share * (right - values[left])
    }
}

/// φ(x).
fn density(x: f64) -> f64 {
    (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt()
}

/// Φ(x) = ½ + φ(x) (x + x³/3 + x⁵/15 + …) (Marsaglia 2004), to 1e-15 where it matters.
fn distribution(x: f64) -> f64 {
    let x = x.clamp(-8.0, 8.0);
    let (mut term, mut sum, mut odd) = (x, x, 1.0);
    while term.abs() > 1e-17 * sum.abs() {
        odd += 2.0;
        term *= x * x / odd;
        sum += term;
    }
    (0.5 + density(x) * sum).clamp(0.0, 1.0)
}

/// Φ⁻¹(p) for p well inside (0, 1), from a score that is not above it: Newton's steps, none longer
/// than ½.
fn quantile(p: f64, from: f64) -> f64 {
    let mut x = from;
    for _ in 0..80 {
        let step = (p - distribution(x)) / density(x).max(1e-12);
        x += step.clamp(-0.5, 0.5);
        if step.abs() < 1e-10 {
            break;
        }
    }
    x
}

/// max |CDF − Φ| of numbers by their mean and variance; 0 if all are equal.
pub(crate) fn deviation(mut numbers: Vec<f64>) -> f64 {
    let n = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / n;
    let variance = numbers.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n;
    if variance <= 0.0 {
        return 0.0;
    }
    numbers.sort_by(f64::total_cmp);
    let mut worst = 0.0f64;
    let mut first = 0;
    // Equal numbers are one step.
    for run in numbers.chunk_by(|x, y| x == y) {
        let share = distribution((run[0] - mean) / variance.sqrt());
        let ends = [first, first + run.len()].map(|rank| (rank as f64 / n - share).abs());
        worst = worst.max(ends[0]).max(ends[1]);
        first += run.len();
    }
    worst
}

/// Unit eigenvectors of a symmetric matrix, the largest eigenvalue first: Jacobi's rotations. Each
/// has a positive sum, so that they do not depend on the way.
fn principal(mut matrix: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let n = matrix.len();
    let unit = |i: usize| (0..n).map(|k| f64::from(u8::from(i == k))).collect();
    let mut axes: Vec<Vec<f64>> = (0..n).map(unit).collect();
    for _ in 0..30 {
        for p in 0..n {
            for q in p + 1..n {
                if matrix[p][q].abs() < 1e-300 {
                    continue;
                }
                let theta = 0.5 * (2.0 * matrix[p][q]).atan2(matrix[q][q] - matrix[p][p]);
                let (sine, cosine) = theta.sin_cos();
                for row in &mut matrix {
                    let (x, y) = (row[p], row[q]);
                    (row[p], row[q]) = (cosine * x - sine * y, sine * x + cosine * y);
                }
                for rows in [&mut matrix, &mut axes] {
                    for k in 0..n {
                        let (x, y) = (rows[p][k], rows[q][k]);
                        (rows[p][k], rows[q][k]) = (cosine * x - sine * y, sine * x + cosine * y);
                    }
                }
            }
        }
    }
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &k| matrix[k][k].total_cmp(&matrix[i][i]));
    (order.into_iter())
        .map(|i| {
            let sign = if axes[i].iter().sum::<f64>() < 0.0 {
                -1.0
            } else {
                1.0
            };
            axes[i].iter().map(|x| sign * x).collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scores_and_shares_are_inverse() {
        for (x, p) in [
            (0.0, 0.5),
            (1.0, 0.841_344_746_068_543),
            (-3.0, 0.001_349_898_031_630_1),
        ] {
            assert!((distribution(x) - p).abs() < 1e-14);
            assert!((quantile(p, -6.0) - x).abs() < 1e-9);
        }
    }

    #[test]
    fn deviations_are_those_of_known_distributions() {
        let of = |f: &dyn Fn(f64) -> f64| {
            deviation((0..10_000).map(|i| f((f64::from(i) + 0.5) / 1e4)).collect())
        };
        // Gaussian, uniform, two values.
        assert!(of(&|p| quantile(p, -6.0)) < 1e-3);
        assert!((of(&|p| p) - 0.058).abs() < 1e-3);
        assert!((of(&|p| (2.0 * p).floor()) - 0.341_3).abs() < 1e-3);
        assert_eq!(of(&|_| 0.25), 0.0);
    }

    #[test]
    fn an_example_is_gaussian_uncorrelated_and_comes_back() {
        let texels = 40 * 25;
        let number = |i: usize, k: u64| {
            let x = (i as u64 * 2 + k + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            (x ^ (x >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) as f64 / u64::MAX as f64
        };
        let (red, other): (Vec<f64>, Vec<f64>) = (0..texels)
            .map(|i| (number(i, 0).powi(3), number(i, 1)))
            .unzip();
        let green: Vec<f64> = red
            .iter()
            .zip(&other)
            .map(|(x, y)| 0.7 * x + 0.2 * y)
            .collect();
        let planes = vec![red, green, vec![0.25; texels]];
        let colors = Planes {
            size: [40, 25],
            planes,
        };
        let example = Example::new(&colors);
        let gaussian = example.gaussian();
        let of = |axis: usize, t: usize| gaussian.planes.planes[axis][t];
        let mean = |f: &dyn Fn(usize) -> f64| (0..texels).map(f).sum::<f64>() / texels as f64;
        for axis in 0..2 {
            assert!(mean(&|t| of(axis, t)).abs() < 1e-6);
            assert!((mean(&|t| of(axis, t).powi(2)) - 1.0).abs() < 0.01);
        }
        // The third axis has no variance at all.
        assert!(mean(&|t| of(2, t).abs()) < 1e-6);
        for t in (0..texels).step_by(7) {
            for channel in 0..3 {
                let back: f64 = (0..3)
                    .map(|axis| {
                        example.axes[axis][channel] * gaussian.coordinate(axis, of(axis, t))
                    })
                    .sum();
                let wanted = colors.planes[channel][t];
                assert!((example.mean[channel] + back - wanted).abs() < 1e-6);
            }
        }
    }
}
