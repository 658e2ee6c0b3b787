//! Baking: separable convolutions of the samples in f64, one pair of kernels a level.

use super::super::tabulated::{deviation, gaussian};
use super::{Grid, LEVELS, MOST, Moment, Packing, SIDE, intervals, sigma};

/// How far a Gaussian reaches, in σ.
const REACH: f64 = 4.5;
/// A level is made from samples that are at least this many a σ.
const DENSE: f64 = 8.0;

/// The table of a moment: the packing's header, then all levels, finest first.
pub(super) fn table(grid: &Grid, moment: Moment, periodic: bool, packing: &Packing) -> Vec<f32> {
    let components: Vec<Vec<f64>> = (grid.iter())
        .map(|samples| {
            let mut pyramid = Samples::new(samples, moment == Moment::Distortion);
            let mut all = Vec::new();
            for level in 0..LEVELS {
                pyramid.coarsen(level);
                all.extend(pyramid.level(level, moment, periodic));
            }
            all
        })
        .collect();
    packing.pack(&components)
}

/// The samples of one component, averaged so far that σ is still many of them, with a border of the
/// values that the function keeps beyond the domain: those of its edge, not of the last averages.
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

    /// The products with every row of samples with a border; the rows stay.
    fn across(&self, values: &[f64], side: usize, periodic: bool) -> Vec<f64> {
        let reach = self.rows.iter().map(|(_, w)| w.len()).max().unwrap_or(0) as i64 + 1;
        let places = -reach..side as i64 + reach;
        let places: Vec<usize> = places.map(|i| bordered(i, side, periodic)).collect();
        let mut out = Vec::with_capacity(values.len() / (side + 2) * self.rows.len());
        for row in values.chunks(side + 2) {
            let padded: Vec<f64> = places.iter().map(|&place| row[place]).collect();
            for (first, weights) in &self.rows {
                let start = (first + reach) as usize;
                let near = &padded[start..start + weights.len()];
                out.push(near.iter().zip(weights).map(|(x, w)| x * w).sum());
            }
        }
        out
    }

    /// The products with every column of rows with a border.
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
        let edge = |i: usize| i.saturating_sub(1).min(SIDE - 1);
        let values: Vec<f64> = (0..(SIDE + 2) * (SIDE + 2))
            .map(|i| {
                let (row, column) = (edge(i / (SIDE + 2)), edge(i % (SIDE + 2)));
                f64::from(samples[row * SIDE + column])
            })
            .collect();
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
                for row in 0..side + 2 {
                    let rows = pair(row).map(|row| &values[row * from..(row + 1) * from]);
                    out.extend((0..side + 2).map(|column| {
                        let [p, q] = pair(column);
                        0.25 * (rows[0][p] + rows[0][q] + rows[1][p] + rows[1][q])
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

    fn level(&self, level: usize, moment: Moment, periodic: bool) -> Vec<f64> {
        let count = intervals(level);
        let step = self.side as f64 / count as f64;
        let places = (0..=count).map(|i| i as f64 * step);
        let kernels = Kernel::gaussian(places, deviation(sigma(level), SIDE, self.side));
        self.convolved(&kernels, &kernels, moment, periodic)
    }

    /// The moment at the texels of a pair of kernels for each axis.
    fn convolved(
        &self,
        [x0, x1]: &[Kernel; 2],
        [y0, y1]: &[Kernel; 2],
        moment: Moment,
        periodic: bool,
    ) -> Vec<f64> {
        let columns = x0.rows.len();
        let both = |x: &Kernel, y: &Kernel, values: &[f64]| {
            let narrow = x.across(values, self.side, periodic);
            y.down(&narrow, columns, periodic)
        };
        match moment {
            Moment::Mean => both(x0, y0, &self.values),
            Moment::SlopeX => both(x1, y0, &self.values),
            Moment::SlopeY => both(x0, y1, &self.values),
            Moment::Distortion => {
                let narrow = x0.across(&self.values, self.side, periodic);
                let means = y0.down(&narrow, columns, periodic);
                let slopes_y = y1.down(&narrow, columns, periodic);
                let slopes_x = both(x1, y0, &self.values);
                let squares = both(x0, y0, &self.squares);
                // In f64 the difference of second moments is exact to 1e-16 of the square.
                (squares
                    .iter()
                    .zip(&means)
                    .zip(slopes_x.iter().zip(&slopes_y)))
                .map(|((q, m), (x, y))| (q - m * m - x * x - y * y).max(0.0).sqrt())
                .collect()
            }
        }
    }
}

/// Places along each axis, and shares between two levels, at which a table is compared with the
/// moments themselves: irrational steps meet texels nowhere twice.
const PLACES: usize = 24;
const BETWEEN: [f64; 3] = [0.0, 0.35, 0.7];

/// The largest error of reading the table between its texels and its levels, in units of the map;
/// of slopes and distortions, in those of σ ∂T and of √D.
pub(super) fn error(
    grid: &Grid,
    table: &[f32],
    moment: Moment,
    periodic: bool,
    packing: &Packing,
) -> f64 {
    let header = &table[..packing.header()];
    let mut worst = 0.0f64;
    for (component, samples) in grid.iter().enumerate() {
        let mut samples = Samples::new(samples, moment == Moment::Distortion);
        let mut first = packing.header();
        for level in 0..LEVELS - 1 {
            samples.coarsen(level);
            let next = first + super::texels(level);
            let header = &header[2 * component..];
            let (low, step) = (f64::from(header[0]), f64::from(header[1]));
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
                let exact = samples.convolved(&kernels[0], &kernels[1], moment, periodic);
                for (row, &v) in v.iter().enumerate() {
                    for (column, &u) in u.iter().enumerate() {
                        let [a, b] = [(level, first), (level + 1, next)].map(|(level, first)| {
                            texel(table, packing, component, (intervals(level), first), [u, v])
                        });
                        let value = low + step * (a + share * (b - a));
                        worst = worst.max((value - exact[row * PLACES + column]).abs());
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
