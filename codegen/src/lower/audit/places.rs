//! Where a graph is audited: of many footprints the few at which a closed form is most in doubt, with
//! weights that keep the mean over all of them.
//!
//! A closed form that is wrong along a line is wrong at few places, of which a few dozen chosen
//! blindly hold none. What it gives there differs from what a point gives, as it does at an edge that
//! it is right about; which of both it is only the truth says, which is a hundred times as dear as a
//! look. So each band has [`CANDIDATES`] footprints, looked at once by either method, and those that
//! are held against the truth are drawn among them with probabilities of which a half is the same for
//! all and a half is in proportion to the difference. Each counts by the inverse of its probability
//! (Horvitz & Thompson 1952), at most twice what it would count if all were drawn alike. They are
//! drawn at equal steps along the sum of the probabilities, which is the same everywhere and spreads
//! them over the candidates.

use super::super::bands::Bands;
use super::super::place::scattered;
use super::display::displayed;
use crate::cpu::Footprint;
use std::ops::Range;

/// Places of each size of footprint: the round ones, and the long ones askew.
const ROUND: usize = 24;
const LONG: usize = 8;
pub(super) const PLACES: usize = ROUND + LONG;
/// How many sizes are the largest, which hold most of the texture: a point says nothing of where a
/// closed form is in doubt there, and every place counts alike.
const LARGE: usize = 2;
/// The places of the largest sizes.
pub(super) const LARGEST: usize = LARGE * PLACES;
/// Footprints of each other size that are looked at.
const CANDIDATES: usize = 8 * PLACES;
/// The least width of a window, in pixels.
const WINDOW: f64 = 32.0;
/// How much longer the long ones are than wide.
const RATIO: f32 = 8.0;
/// Cosines and sines of their directions, the same numbers everywhere.
pub(super) const ASKEW: [[f32; 2]; 4] = [[0.8, 0.6], [-0.6, 0.8], [0.96, -0.28], [0.352, 0.936]];
/// Differences below this are none.
const DIFFERENT: f64 = 1e-3;

/// Footprints, band after band, [`PLACES`] of each, and how much each counts in its band.
pub(super) struct Places {
    pub(super) bands: Bands,
    pub(super) footprints: Vec<Footprint>,
    /// The shares of a band add up to 1.
    pub(super) shares: Vec<f64>,
}

/// Which footprints a band has.
fn band(band: usize) -> Range<usize> {
    let start = band * CANDIDATES;
    let count = if band < Bands::COUNT - LARGE {
        CANDIDATES
    } else {
        PLACES
    };
    let before = band.saturating_sub(Bands::COUNT - LARGE) * (CANDIDATES - PLACES);
    start - before..start - before + count
}

/// The footprints that are looked at, band after band: most of them in the unit square or, where
/// pixels are large, in a window of so many of them; every fourth within a distance.
pub(super) fn candidates(bands: Bands, distance: f64) -> Vec<Footprint> {
    let mut footprints = Vec::new();
    for index in 0..Bands::COUNT {
        let size = bands.size(index);
        for place in 0..band(index).len() {
            let turn = place / PLACES * Bands::COUNT + index;
            let at = scattered(turn * PLACES + place % PLACES + 1);
            let extent = match place % 4 {
                3 => distance.max(WINDOW * f64::from(size)),
                _ => 0.5 * (WINDOW * f64::from(size)).max(1.0),
            };
            let at = at.map(|x| 0.5 + extent * (2.0 * x - 1.0));
            let (long, [cos, sin]) = match place % PLACES {
                0..ROUND => (1.0, [1.0, 0.0]),
                _ => (RATIO, ASKEW[place % ASKEW.len()]),
            };
            footprints.push(Footprint {
                du: [long * size * cos, long * size * sin],
                dv: [-size * sin, size * cos],
                ..Footprint::point(at)
            });
        }
    }
    footprints
}

impl Places {
    /// The places, among the candidates of [`candidates`], at which a graph is audited, with where
    /// each is among them; `closed` and `point` are what both give there, component by component, and
    /// `outputs` the components of each output.
    pub(super) fn of(
        bands: Bands,
        candidates: &[Footprint],
        [closed, point]: [&[Vec<f32>]; 2],
        outputs: &[Range<usize>],
    ) -> (Self, Vec<usize>) {
        let mut indices = Vec::with_capacity(PLACES * Bands::COUNT);
        let mut shares = Vec::with_capacity(PLACES * Bands::COUNT);
        for index in 0..Bands::COUNT {
            let all = band(index);
            if all.len() == PLACES {
                indices.extend(all);
                shares.extend([1.0 / PLACES as f64; PLACES]);
                continue;
            }
            let probabilities = probabilities(all.clone(), [closed, point], outputs);
            let drawn = drawn(&probabilities);
            let weights = drawn.iter().map(|&i| 1.0 / probabilities[i]);
            let total: f64 = weights.clone().sum();
            shares.extend(weights.map(|weight| weight / total));
            indices.extend(drawn.iter().map(|&i| all.start + i));
        }
        let places = Self {
            bands,
            footprints: indices.iter().map(|&i| candidates[i]).collect(),
            shares,
        };
        (places, indices)
    }
}

/// How probable each candidate of a band is: they add up to 1.
fn probabilities(
    all: Range<usize>,
    [closed, point]: [&[Vec<f32>]; 2],
    outputs: &[Range<usize>],
) -> Vec<f64> {
    let count = all.len() as f64;
    let mut sums = vec![0.0; all.len()];
    let mut total = 0.0;
    for output in outputs {
        let apart = |place: usize| {
            let square = |component: usize| {
                let of = |values: &[Vec<f32>]| displayed(values[component][place]);
                (of(closed) - of(point)).powi(2)
            };
            output.clone().map(square).sum::<f64>().sqrt()
        };
        let apart: Vec<f64> = all.clone().map(apart).collect();
        // Outputs count alike, so that a bold one does not hide the others.
        let of_output: f64 = apart.iter().sum();
        if of_output > DIFFERENT * count {
            for (sum, apart) in sums.iter_mut().zip(apart) {
                *sum += apart / of_output;
            }
            total += 1.0;
        }
    }
    if total == 0.0 {
        return vec![1.0 / count; all.len()];
    }
    (sums.iter())
        .map(|sum| 0.5 / count + 0.5 * sum / total)
        .collect()
}

/// [`PLACES`] of the candidates at equal steps along the sum of their probabilities; what is more
/// probable than a step is drawn several times.
fn drawn(probabilities: &[f64]) -> Vec<usize> {
    let mut drawn = Vec::with_capacity(PLACES);
    let mut sum = 0.0;
    for (index, probability) in probabilities.iter().enumerate() {
        sum += PLACES as f64 * probability;
        while drawn.len() < PLACES && (drawn.len() as f64 + 0.5) < sum {
            drawn.push(index);
        }
    }
    drawn.resize(PLACES, probabilities.len() - 1);
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;

    const BANDS: Bands = Bands {
        finest: -10,
        octaves: 2,
    };

    /// The components of one output, of one.
    const ONE: Range<usize> = 0..1;

    /// A closed form that is off by 1 at every so manieth candidate, and right elsewhere.
    fn wrong(every: usize) -> (Places, Vec<usize>) {
        let candidates = candidates(BANDS, 16.0);
        let point = vec![0.0; candidates.len()];
        let off = |i: usize| f32::from(u8::from(i % every == 5));
        let closed = (0..candidates.len()).map(off).collect();
        Places::of(BANDS, &candidates, [&[closed], &[point]], &[ONE])
    }

    #[test]
    fn errors_that_are_rare_are_found_and_count_as_much_as_they_are() {
        for every in [16, 32, 64] {
            let (places, indices) = wrong(every);
            for band in 0..Bands::COUNT - LARGE {
                let of_band = band * PLACES..(band + 1) * PLACES;
                let square: f64 = of_band
                    .filter(|&place| indices[place] % every == 5)
                    .map(|place| places.shares[place])
                    .sum();
                let right = 1.0 / every as f64;
                assert!((square / right - 1.0).abs() < 0.15, "{square} for {right}");
            }
        }
    }

    #[test]
    fn shares_add_up_to_one_and_none_counts_twice_as_much_as_by_chance() {
        let (places, _) = wrong(40);
        for shares in places.shares.chunks(PLACES) {
            assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            assert!(shares.iter().all(|&share| share < 2.2 / PLACES as f64));
        }
    }

    #[test]
    fn where_nothing_differs_all_places_count_alike() {
        let candidates = candidates(BANDS, 16.0);
        let same = vec![vec![0.5; candidates.len()]];
        let (places, indices) = Places::of(BANDS, &candidates, [&same, &same], &[ONE]);
        let alike = |share: &f64| (share * PLACES as f64 - 1.0).abs() < 1e-9;
        assert!(places.shares.iter().all(alike));
        assert!(indices.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!(candidates.len(), band(Bands::COUNT - 1).end);
    }
}
