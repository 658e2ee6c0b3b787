//! Baking: separable convolutions of the samples in f64, one pair of kernels a level.

use super::super::tabulated::{deviation, gaussian};
use super::{Grid, LEVELS, MOST, Packing, SIDE, intervals, sigma};

/// How far a Gaussian reaches, in σ.
const REACH: f64 = 4.5;
/// A level is made from samples that are at least this many a σ.
const DENSE: f64 = 4.0;

/// The table of the means: the packing's header, then all levels, finest first.
pub(super) fn means(grid: &Grid, periodic: bool, packing: &Packing) -> Vec<f32> {
    let [means] = tables(grid, packing, false, |samples, kernels| {
        [samples.means(kernels, periodic)]
    });
    means
}

/// The tables of slopes and distortions, which share most of their work.
pub(super) fn spreads(grid: &Grid, periodic: bool, packing: &Packing) -> [Vec<f32>; 3] {
    tables(grid, packing, true, |samples, kernels| {
        let [_, x, y, distortion] = samples.moments(kernels, kernels, periodic);
        [x, y, distortion]
    })
}

/// The tables of what is found at the texels of each level of each component.
fn tables<const N: usize>(
    grid: &Grid,
    packing: &Packing,
    squared: bool,
    found: impl Fn(&Samples, &[Kernel; 2]) -> [Vec<f64>; N],
) -> [Vec<f32>; N] {
    let mut components = [const { Vec::new() }; N];
    for samples in grid.iter() {
        let mut pyramid = Samples::new(samples, squared);
        let mut all = [const { Vec::new() }; N];
        for level in 0..LEVELS {
            pyramid.coarsen(level);
            let kernels = pyramid.kernels(level);
            for (all, texels) in all.iter_mut().zip(found(&pyramid, &kernels)) {
                all.extend(texels);
            }
        }
        for (component, all) in components.iter_mut().zip(all) {
            component.push(all);
        }
    }
    components.map(|components| packing.pack(&components))
}

/// The samples of one component, averaged so far that σ is still many of them, with a border of the
/// values that the function keeps beyond the domain: those of its edge, not of the last averages.
/// Columns come first: along rows, of which there are most, [`Kernel::down`] sums columns.
struct Samples {
    side: usize,
    values: Vec<f64>,
    /// Averages of the squares, where a variance is wanted.
    squares: Vec<f64>,
}

/// A banded matrix: for each texel the first sample it reads and the weights from there on.
struct Kernel {
    rows: Vec<(i64, Vec<f64>)>,
}

impl Kernel {
    /// Weights of a Gaussian of `sd` samples at places (in samples), and those times the score.
    fn gaussian(places: impl Iterator<Item = f64>, sd: f64) -> [Self; 2] {
        let (mut plain, mut scored) = (Vec::new(), Vec::new());
        for place in places {
            let first = (place - REACH * sd).floor() as i64;
            let last = (place + REACH * sd).ceil() as i64;
            let scores = (first..last).map(|i| (i as f64 + 0.5 - place) / sd);
            let scores: Vec<f64> = scores.collect();
            let weights = gaussian(&scores);
            let first_moment: f64 = weights.iter().zip(&scores).map(|(w, z)| w * z).sum();
            // A constant has no slope.
            let products = weights.iter().zip(&scores);
            scored.push((
                first,
                products.map(|(w, z)| w * (z - first_moment)).collect(),
            ));
            plain.push((first, weights));
        }
        [plain, scored].map(|rows| Self { rows })
    }

    /// The products with every column of rows with a border. Whole rows are added at a time, so that
    /// no sum waits for the one before it.
    fn down(&self, values: &[f64], columns: usize, periodic: bool) -> Vec<f64> {
        let side = values.len() / columns - 2;
        let mut out = vec![0.0; self.rows.len() * columns];
        for ((first, weights), sums) in self.rows.iter().zip(out.chunks_mut(columns)) {
            for (i, w) in (*first..).zip(weights) {
                let row = bordered(i, side, periodic) * columns;
                for (sum, x) in sums.iter_mut().zip(&values[row..row + columns]) {
                    *sum += w * x;
                }
            }
        }
        out
    }
}

/// Rows of `columns` numbers as columns.
fn transposed(values: &[f64], columns: usize) -> Vec<f64> {
    let rows = values.len() / columns;
    let mut out = Vec::with_capacity(values.len());
    for column in 0..columns {
        out.extend((0..rows).map(|row| values[row * columns + column]));
    }
    out
}

/// Where sample i is among samples with a border.
fn bordered(i: i64, side: usize, periodic: bool) -> usize {
    let side = side as i64;
    let i = if periodic {
        i.rem_euclid(side)
    } else {
        i.clamp(-1, side)
    };
    (i + 1) as usize
}

impl Samples {
    fn new(samples: &[f32], squared: bool) -> Self {
        assert_eq!(samples.len(), SIDE * SIDE, "samples of a map");
        let mut values = Vec::with_capacity((SIDE + 2) * (SIDE + 2));
        for column in (0..SIDE + 2).map(|i| i.saturating_sub(1).min(SIDE - 1)) {
            let mut border = |row: usize| values.push(f64::from(samples[row * SIDE + column]));
            border(0);
            (0..SIDE).for_each(&mut border);
            border(SIDE - 1);
        }
        let squares = if squared {
            values.iter().map(|x| x * x).collect()
        } else {
            Vec::new()
        };
        Self {
            side: SIDE,
            values,
            squares,
        }
    }

    /// Halves the side while the level's σ stays [`DENSE`].
    fn coarsen(&mut self, level: usize) {
        while sigma(level) * self.side as f64 >= 2.0 * DENSE {
            let (from, side) = (self.side + 2, self.side / 2);
            // Of each row or column with its border: those that it is the average of.
            let pair = |i: usize| match i {
                0 => [0, 0],
                _ if i > side => [from - 1, from - 1],
                _ => [2 * i - 1, 2 * i],
            };
            let halved = |values: &[f64]| -> Vec<f64> {
                let mut out = Vec::with_capacity((side + 2) * (side + 2));
                for column in 0..side + 2 {
                    let columns = pair(column).map(|i| &values[i * from..(i + 1) * from]);
                    out.extend((0..side + 2).map(|row| {
                        let [p, q] = pair(row);
                        0.25 * (columns[0][p] + columns[1][p] + columns[0][q] + columns[1][q])
                    }));
                }
                out
            };
            self.values = halved(&self.values);
            if !self.squares.is_empty() {
                self.squares = halved(&self.squares);
            }
            self.side /= 2;
        }
    }

    /// The kernels of the texels of a level, the same along both axes.
    fn kernels(&self, level: usize) -> [Kernel; 2] {
        let count = intervals(level);
        let step = self.side as f64 / count as f64;
        let places = (0..=count).map(|i| i as f64 * step);
        Kernel::gaussian(places, deviation(sigma(level), SIDE, self.side))
    }

    /// The products of a kernel with each row of samples.
    fn across(&self, kernel: &Kernel, samples: &[f64], periodic: bool) -> Vec<f64> {
        let rows = self.side + 2;
        transposed(&kernel.down(samples, rows, periodic), rows)
    }

    /// The means at the texels of a level.
    fn means(&self, [plain, _]: &[Kernel; 2], periodic: bool) -> Vec<f64> {
        let narrow = self.across(plain, &self.values, periodic);
        plain.down(&narrow, plain.rows.len(), periodic)
    }

    /// All moments at the places of a pair of kernels for each axis, in the order of
    /// [`super::MOMENTS`].
    fn moments(
        &self,
        [x0, x1]: &[Kernel; 2],
        [y0, y1]: &[Kernel; 2],
        periodic: bool,
    ) -> [Vec<f64>; 4] {
        let columns = x0.rows.len();
        let across = |x: &Kernel, samples: &[f64]| self.across(x, samples, periodic);
        let narrow = across(x0, &self.values);
        let means = y0.down(&narrow, columns, periodic);
        let slopes_y = y1.down(&narrow, columns, periodic);
        let slopes_x = y0.down(&across(x1, &self.values), columns, periodic);
        let squares = y0.down(&across(x0, &self.squares), columns, periodic);
        // In f64 the difference of second moments is exact to 1e-16 of the square.
        let distortions = (squares.iter().zip(&means))
            .zip(slopes_x.iter().zip(&slopes_y))
            .map(|((q, m), (x, y))| (q - m * m - x * x - y * y).max(0.0).sqrt())
            .collect();
        [means, slopes_x, slopes_y, distortions]
    }
}

/// Places along each axis, and shares between two levels, at which a table is compared with the
/// moments themselves: irrational steps meet texels nowhere twice.
const PLACES: usize = 24;
const BETWEEN: [f64; 3] = [0.0, 0.35, 0.7];

/// The largest error of reading each moment's table between its texels and its levels, in units of
/// the map; of slopes and distortions, in those of σ ∂T and of √D.
pub(super) fn errors(
    grid: &Grid,
    means: &[f32],
    spreads: &[Vec<f32>; 3],
    periodic: bool,
    packing: &Packing,
) -> [f64; 4] {
    let mut worst = [0.0f64; 4];
    for (component, samples) in grid.iter().enumerate() {
        let mut samples = Samples::new(samples, true);
        let mut first = packing.header();
        for level in 0..LEVELS - 1 {
            samples.coarsen(level);
            let next = first + super::texels(level);
            let (fine, coarse) = (sigma(level), sigma(level + 1));
            for share in BETWEEN {
                let steps = [(0.113, 0.754_877_666), (0.271, 0.569_840_291)];
                let [u, v] = steps.map(|(start, step)| {
                    let places = (0..PLACES).map(|i| (start + (i as f64 + share) * step).fract());
                    places.collect::<Vec<f64>>()
                });
                let sd = deviation(fine + share * (coarse - fine), SIDE, samples.side);
                let kernels = [&u, &v].map(|places| {
                    let places = places.iter().map(|p| p * samples.side as f64);
                    Kernel::gaussian(places, sd)
                });
                let exact = samples.moments(&kernels[0], &kernels[1], periodic);
                let tables = std::iter::once(means).chain(spreads.iter().map(Vec::as_slice));
                for ((table, exact), worst) in tables.zip(&exact).zip(&mut worst) {
                    let [low, step] = [0, 1].map(|i| f64::from(table[2 * component + i]));
                    let ends = [(level, first), (level + 1, next)];
                    for (exact, place) in exact
                        .iter()
                        .zip(v.iter().flat_map(|&v| u.iter().map(move |&u| [u, v])))
                    {
                        let [a, b] = ends.map(|(level, first)| {
                            texel(table, packing, component, (intervals(level), first), place)
                        });
                        let value = low + step * (a + share * (b - a));
                        *worst = worst.max((value - exact).abs());
                    }
                }
            }
            first = next;
        }
    }
    worst
}

/// A level of a table between its texels, as the shader reads it: codes of one component.
fn texel(
    table: &[f32],
    packing: &Packing,
    component: usize,
    (count, first): (usize, usize),
    place: [f64; 2],
) -> f64 {
    debug_assert!(count <= MOST);
    let [(x, across), (y, down)] = place.map(|p| {
        let at = p * count as f64;
        let whole = at.floor().min(count as f64 - 1.0);
        (whole as usize, at - whole)
    });
    let code = |x: usize, y: usize| packing.codes(table[first + y * (count + 1) + x])[component];
    let row = |y: usize| code(x, y) + across * (code(x + 1, y) - code(x, y));
    row(y) + down * (row(y + 1) - row(y))
}
