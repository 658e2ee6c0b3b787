//! Lattice noise with the quadrupole kernel: a random second-order kernel at every lattice point,
//! filtered exactly by any Gaussian footprint (RULES, lattice noise).
//!
//! With T = a²I + Σ, d the offset to the lattice point, u = T⁻¹d, E = e^{−d·u/2}, θ a random angle
//! and B = [[cos θ, sin θ], [sin θ, −cos θ]]: k = uᵀBu − tr(BT⁻¹), M = Σ κ E k with
//! κ = a³/(√π √det T). The unfiltered noise has variance 1 (over random lattices).

mod address;
mod energy;
mod filtered;
mod point;
mod row;
mod width;

use super::field::{Field, Spread};
use super::sum::{Left, Octaves};
use mipless_codegen::Lower;
use mipless_codegen::ir::{Float, Uint};
use mipless_codegen::moments::{Mode, Signal};
use width::WIDTH;
pub(super) use width::{AREA, WAVELENGTH};

impl Octaves {
    /// How many octaves the footprint leaves, at most, and the variance of the others. Each is
    /// finer than the one before: where one is gone, all that follow are. With y the smaller
    /// eigenvalue of Σ/a² a footprint leaves no more than (1 + y)⁻³ of the variance.
    fn left(self, minor: Float<'_>) -> Left<'_> {
        let b = minor.builder();
        let mut left = Left {
            count: b.uint(0),
            last: b.uint(0),
            gone: b.float(0.0),
        };
        let total = self.sd().powi(2);
        let shares = (0..self.count).map(|_| 1.0);
        let shares = shares.chain((self.part > 0.0).then_some(self.part));
        let octaves: Vec<[f32; 2]> = (0..)
            .zip(shares)
            .map(|(k, share)| {
                let energy = share * share * self.diminish.powi(2 * k);
                let weight = (energy / total).max(filtered::LEAST_SHARE);
                let limit = (weight / filtered::FADE[0]).cbrt() - 1.0;
                let limit = WIDTH * WIDTH * limit / self.lacunarity.powi(2 * k);
                [limit, energy]
            })
            .collect();
        for (k, &[_, energy]) in octaves.iter().enumerate() {
            // Where amplitudes grow, a later one may be left longer.
            let limit = octaves[k..].iter().map(|o| o[0]).fold(0.0, f32::max);
            let is_left = minor.lt(limit);
            let step = is_left.select(1u32, 0u32);
            if k < self.count as usize {
                left.count += step;
            } else {
                left.last = step;
            }
            left.gone += is_left.select(0.0, energy);
        }
        left
    }
}

/// The filtered sum of octaves at a position in cells of the first octave; unit variance of the
/// first octave.
pub(crate) fn filtered<'b>(
    lower: &mut Lower<'_, 'b>,
    position: &[Signal<'b>],
    octaves: Octaves,
    seed: Uint<'b>,
) -> Field<'b> {
    let mode = lower.mode();
    let spread = Spread::of(position);
    let Octaves {
        lacunarity,
        diminish,
        ..
    } = octaves;
    let key = format!(
        "lattice {mode:?} {lacunarity} {diminish} {} {}",
        octaves.sd(),
        octaves.tiles()
    );
    let octave = lower.function(&key, |module| match mode {
        Mode::Point => point::octave(module, octaves),
        _ => filtered::octave(module, mode, octaves),
    });
    let captures = (mode != Mode::Point).then(|| {
        let [major, minor] = spread.eigenvalues.map(|s| s * (1.0 / (WIDTH * WIDTH)));
        (spread.covariance, major + minor, major * minor)
    });
    let left = (mode.filters()).then(|| octaves.left(spread.eigenvalues[1]));
    octaves.sum(lower, &octave, (position, seed), captures, left)
}
