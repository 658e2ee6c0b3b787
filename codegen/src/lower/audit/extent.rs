//! How large a texture's detail is, which says what footprints to audit it at.

use super::super::bands::Bands;
use super::super::place::scattered;
use super::display::displayed;
use super::places::ASKEW;
use super::truth::measured;
use crate::cpu::Footprint;
use crate::ir::Program;

/// Places that distances are measured from.
const PLACES: usize = 32;
/// Distances, as log₂ of uv.
const FROM: i32 = -16;
const DISTANCES: usize = 27;
/// Shares of the largest mean square difference: of the finest detail, and of the coarsest.
const SHARES: [f64; 2] = [0.1, 0.7];
/// The finest pixel is so many octaves below the finest detail, the largest above the coarsest.
const BELOW: i32 = 5;
const ABOVE: i32 = 3;

/// How large a texture is.
pub(super) struct Extent {
    /// The sizes of pixels at which it is looked at.
    pub(super) bands: Bands,
    /// How far away from the origin, in uv.
    pub(super) distance: f64,
    /// How many instructions a point of it takes.
    pub(super) work: f64,
}

/// The extent of a texture, from the mean square difference of its points by their distance (the
/// structure function).
pub(super) fn extent(point: &Program) -> Extent {
    let mut footprints = Vec::with_capacity(PLACES * (DISTANCES + 1));
    for place in 0..PLACES {
        let at = scattered(place + 1).map(|x| 64.0 * x - 32.0);
        let [x, y] = ASKEW[place % ASKEW.len()].map(f64::from);
        let distances = (0..DISTANCES).map(|i| f64::from(FROM + i as i32).exp2());
        for distance in std::iter::once(0.0).chain(distances) {
            let there = [at[0] + distance * x, at[1] + distance * y];
            footprints.push(Footprint::point(there));
        }
    }
    let (values, steps) = measured(point, &footprints);
    let work = steps as f64 / footprints.len() as f64;
    let squares: Vec<f64> = (1..=DISTANCES)
        .map(|distance| {
            let of_place = |values: &[f32]| {
                let at = |i: usize| displayed(values[i]);
                (0..PLACES)
                    .map(|place| place * (DISTANCES + 1))
                    .map(|first| (at(first + distance) - at(first)).powi(2))
                    .sum::<f64>()
            };
            values.iter().map(|values| of_place(values)).sum()
        })
        .collect();
    let largest = squares.iter().copied().fold(0.0, f64::max);
    if largest <= 0.0 {
        return Extent {
            bands: Bands {
                finest: -10,
                octaves: 2,
            },
            distance: 16.0,
            work,
        };
    }
    let [fine, coarse] = SHARES.map(|share| {
        let reaches = squares.iter().position(|&square| square >= share * largest);
        FROM + reaches.unwrap_or(DISTANCES - 1) as i32
    });
    let finest = fine - BELOW;
    let gaps = Bands::COUNT as i32 - 1;
    let octaves = (coarse + ABOVE - finest + gaps - 1) / gaps;
    let bands = Bands {
        finest,
        octaves: octaves.clamp(2, 5),
    };
    Extent {
        bands,
        distance: f64::from(coarse + 3).exp2().max(16.0),
        work,
    }
}
