//! Lattice noise with the quadrupole kernel: a random second-order kernel at every lattice point,
//! filtered exactly by any Gaussian footprint (RULES, lattice noise).
//!
//! With T = a²I + Σ, d the offset to the lattice point, u = T⁻¹d, E = e^{−d·u/2}, θ a random angle
//! and B = [[cos θ, sin θ], [sin θ, −cos θ]]: k = uᵀBu − tr(BT⁻¹), M = Σ κ E k with
//! κ = a³/(√π √det T). The unfiltered noise has variance 1 (over random lattices).

pub(super) mod address;
mod energy;
mod filtered;
mod point;
mod row;

use super::field::{Field, Spread};
use super::octave::Octave;
use address::Address;
pub(super) use filtered::derivatives;
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, FunctionRef, Value};
use mipless_codegen::moments::{Mode, Signal};

/// a: the width of the kernel, in cells.
const WIDTH: f32 = 0.3854;

/// The wavelength of the dominant detail, in cells: the spectrum k⁵ e^{−a²k²} has its peak at
/// k = √2.5/a.
pub(super) const WAVELENGTH: f32 = std::f32::consts::TAU * WIDTH / 1.581_138_8;

/// The most lattice rows that are summed; footprints that need more fade.
const MOST_ROWS: f32 = 32.0;

/// What a sum of octaves is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Octaves {
    /// How many, at least 1.
    pub(crate) count: u32,
    /// By how much of its amplitude one more is there, below 1.
    pub(crate) part: f32,
    /// By how much the frequency grows.
    pub(crate) lacunarity: f32,
    /// By how much the amplitude falls.
    pub(crate) diminish: f32,
    /// Selects the lattice.
    pub(crate) seed: i32,
    /// After how many cells of the first octave the lattice repeats; 0 if it does not.
    pub(crate) period: u32,
}

/// The octaves that a footprint leaves.
#[derive(Clone, Copy)]
pub(super) struct Left {
    /// How many whole ones.
    count: Value,
    /// 1 if the last, fractional one is left, else 0.
    last: Value,
    /// The variance of the others.
    gone: Value,
}

impl Octaves {
    /// Whether the lattice repeats.
    pub(super) fn tiles(self) -> bool {
        self.period > 0
    }

    /// How many octaves the footprint leaves, at most, and the variance of the others. Each is
    /// finer than the one before: where one is gone, all that follow are. With y the smaller
    /// eigenvalue of Σ/a² a footprint leaves no more than (1 + y)⁻³ of the variance.
    fn left(self, b: &mut Builder, minor: Value) -> Left {
        let (none, one, zero) = (b.u32(0), b.u32(1), b.f32(0.0));
        let mut left = Left {
            count: none,
            last: none,
            gone: zero,
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
            let limit = b.f32(limit);
            let is_left = b.lt(minor, limit);
            let step = b.select(is_left, one, none);
            if k < self.count as usize {
                left.count = b.add_u(left.count, step);
            } else {
                left.last = step;
            }
            let energy = b.f32(energy);
            let energy = b.select(is_left, zero, energy);
            left.gone = b.add(left.gone, energy);
        }
        left
    }

    /// All octaves.
    fn all(self, b: &mut Builder) -> Left {
        Left {
            count: b.u32(self.count),
            last: b.u32(u32::from(self.part > 0.0)),
            gone: b.f32(0.0),
        }
    }

    /// The standard deviation of the sum.
    pub(crate) fn sd(self) -> f32 {
        let whole: f32 = (0..self.count as i32)
            .map(|k| self.diminish.powi(2 * k))
            .sum();
        let part = self.part * self.diminish.powi(self.count as i32);
        (whole + part * part).sqrt()
    }

    /// The scrambled seed, which the state of the first octave holds.
    pub(super) fn scrambled_seed(self, b: &mut Builder) -> Value {
        let seed = b.u32(self.seed as u32);
        b.scramble(seed)
    }

    /// The root mean square frequency of the sum, over that of its first octave.
    pub(crate) fn finer(self) -> f32 {
        let whole = (0..self.count as i32).map(|k| (1.0, k));
        let part = (self.part, self.count as i32);
        let (energy, slopes) = whole.chain([part]).fold((0.0, 0.0), |sums, (share, k)| {
            let energy = (share * self.diminish.powi(k)).powi(2);
            let slope = energy * self.lacunarity.powi(2 * k);
            (sums.0 + energy, sums.1 + slope)
        });
        (slopes / energy).sqrt()
    }

    /// The sum over octaves of a noise of variance 1; `octave` is the body of the fold over them.
    pub(super) fn sum(
        self,
        lower: &mut Lower<'_>,
        octave: &FunctionRef,
        (position, seed): (&[Signal], Value),
        captures: &[Value],
        left: Option<Left>,
    ) -> Field {
        let mode = lower.mode();
        let parts = parts(mode);
        let sums = self.fold(lower, octave, (position, seed), parts, captures, left);
        let zero = lower.b().f32(0.0);
        let at = |i: usize| if i < parts { sums[i] } else { zero };
        Field {
            mean: at(0),
            gradient: [at(1), at(2)],
            hessian: [at(3), at(4), at(5)],
            rest: if mode.spreads() { sums[parts] } else { zero },
        }
    }

    /// The last state of the fold over octaves: the `parts` numbers of the field, the rest where the
    /// mode spreads, and what goes from octave to octave.
    pub(super) fn fold(
        self,
        lower: &mut Lower<'_>,
        octave: &FunctionRef,
        (position, seed): (&[Signal], Value),
        parts: usize,
        captures: &[Value],
        left: Option<Left>,
    ) -> Vec<Value> {
        let mode = lower.mode();
        let b = lower.b();
        let left = left.unwrap_or_else(|| self.all(b));
        let mut init = vec![b.f32(0.0); parts];
        if mode.spreads() {
            init.push(left.gone);
        }
        for axis in position {
            // The lattice needs a cell and a fraction, whatever the position carries.
            let (cell, fraction) = match axis.cell {
                Some(cell) => (cell, axis.mean),
                None => {
                    let whole = b.floor(axis.mean);
                    let fraction = b.sub(axis.mean, whole);
                    (b.trunc_i(whole), fraction)
                }
            };
            init.push(cell);
            init.push(fraction);
        }
        let amplitude = init.len() + 1;
        init.extend([b.f32(1.0), b.f32(1.0), seed]);
        if self.tiles() {
            init.push(b.f32(self.period as f32));
        }
        let mut sums = b.fold(octave, left.count, &init, captures);
        if self.part > 0.0 {
            // The state is that of the next octave.
            sums[amplitude] = b.scale(sums[amplitude], self.part);
            sums = b.fold(octave, left.last, &sums, captures);
        }
        sums
    }
}

/// How many numbers a mode needs of a field: the mean, the gradient, the Hessian.
pub(super) fn parts(mode: Mode) -> usize {
    let derivatives = derivatives(mode);
    (derivatives + 1) * (derivatives + 2) / 2
}

/// The filtered sum of octaves at a position in cells of the first octave; unit variance of the
/// first octave.
pub(crate) fn filtered(
    lower: &mut Lower<'_>,
    position: &[Signal],
    octaves: Octaves,
    seed: Value,
) -> Field {
    let mode = lower.mode();
    let spread = Spread::of(lower.b(), position);
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
    let b = lower.b();
    let mut captures = Vec::new();
    if mode != Mode::Point {
        captures.extend(spread.covariance);
        let [major, minor] = spread
            .eigenvalues
            .map(|s| b.scale(s, 1.0 / (WIDTH * WIDTH)));
        captures.extend([b.add(major, minor), b.mul(major, minor)]);
    }
    let left = (mode.filters()).then(|| octaves.left(lower.b(), spread.eigenvalues[1]));
    octaves.sum(lower, &octave, (position, seed), &captures, left)
}

impl Octave<2> {
    fn address(&self, b: &mut Builder) -> Address {
        Address::new(b, self.cells, self.seed, self.period)
    }
}
