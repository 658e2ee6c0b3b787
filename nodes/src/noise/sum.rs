//! What a sum of octaves is, and the fold over them.

use super::field::Field;
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, FunctionRef, Value};
use mipless_codegen::moments::{Mode, Signal};

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
    pub(super) count: Value,
    /// 1 if the last, fractional one is left, else 0.
    pub(super) last: Value,
    /// The variance of the others.
    pub(super) gone: Value,
}

impl Octaves {
    /// Whether the lattice repeats.
    pub(super) fn tiles(self) -> bool {
        self.period > 0
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

/// How many derivatives of the noise a mode needs.
pub(super) fn derivatives(mode: Mode) -> usize {
    match mode {
        Mode::Point | Mode::Naive | Mode::Ensemble => 0,
        Mode::Local => 1,
        Mode::Quad => 2,
    }
}

/// How many numbers a mode needs of a field: the mean, the gradient, the Hessian.
pub(super) fn parts(mode: Mode) -> usize {
    let derivatives = derivatives(mode);
    (derivatives + 1) * (derivatives + 2) / 2
}
