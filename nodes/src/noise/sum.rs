//! What a sum of octaves is, and the fold over them.

mod octave;

pub(super) use octave::{Octave, along};

use super::components::Hash;
use super::field::Field;
use super::jenkins;
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Float, FunctionRef, Scalars, Sym2, Uint, Vec2};
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
    /// How many times as far it repeats along v.
    pub(crate) ratio: f32,
    /// Which hash decides: with MaterialX's all octaves share one lattice.
    pub(crate) hash: Hash,
}

/// The octaves that a footprint leaves.
#[derive(Clone, Copy)]
pub(super) struct Left<'b> {
    /// How many whole ones.
    pub(super) count: Uint<'b>,
    /// 1 if the last, fractional one is left, else 0.
    pub(super) last: Uint<'b>,
    /// The variance of the others.
    pub(super) gone: Float<'b>,
}

impl Octaves {
    /// Whether the lattice repeats.
    pub(super) fn tiles(self) -> bool {
        self.period > 0
    }

    /// All octaves.
    fn all(self, b: &Builder) -> Left<'_> {
        Left {
            count: b.uint(self.count),
            last: b.uint(u32::from(self.part > 0.0)),
            gone: b.float(0.0),
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
    pub(super) fn scrambled_seed(self, b: &Builder) -> Uint<'_> {
        match self.hash {
            Hash::Mipless => b.uint(self.seed as u32).scramble(),
            Hash::Materialx => b.uint(jenkins::seed(self.seed)),
        }
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

    /// The sum over octaves of a noise of the plane, of variance 1; `octave` is the body of the fold
    /// over them.
    pub(super) fn sum<'b>(
        self,
        lower: &Lower<'_, 'b>,
        octave: &FunctionRef,
        (position, seed): (&[Signal<'b>], Uint<'b>),
        captures: impl Scalars<'b>,
        left: Option<Left<'b>>,
    ) -> Field<'b> {
        let mode = lower.mode();
        let parts = parts(mode);
        let first: Octave<'b, 2> = Octave::first(position, seed, self);
        let sums = self.fold(lower, octave, first, parts, captures, left);
        let zero = lower.b().float(0.0);
        let at = |i: usize| if i < parts { sums[i] } else { zero };
        Field {
            mean: at(0),
            gradient: Vec2([at(1), at(2)]),
            hessian: Sym2([at(3), at(4), at(5)]),
            rest: if mode.spreads() { sums[parts] } else { zero },
        }
    }

    /// The sums of a fold over octaves from the first one on: the `parts` numbers of the field, and the
    /// rest where the mode spreads.
    pub(super) fn fold<'b, const AXES: usize>(
        self,
        lower: &Lower<'_, 'b>,
        octave: &FunctionRef,
        first: Octave<'b, AXES>,
        parts: usize,
        captures: impl Scalars<'b>,
        left: Option<Left<'b>>,
    ) -> Vec<Float<'b>> {
        let b = lower.b();
        let left = left.unwrap_or_else(|| self.all(b));
        let mut sums = vec![b.float(0.0); parts];
        sums.extend(lower.mode().spreads().then_some(left.gone));
        let (sums, mut next) = b.fold(octave, left.count, (sums, first), &captures);
        if self.part == 0.0 {
            return sums;
        }
        next.amplitude *= self.part;
        let (sums, _) = b.fold(octave, left.last, (sums, next), &captures);
        sums
    }
}

/// What squared spreads are multiplied by for an octave that is `scale` times as fine, of a footprint of
/// the largest squared spread `spread`. Over 10⁴ cells every octave is gone, and squares of squares
/// are finite; a limit on the scale alone would leave fine octaves unfiltered.
pub(super) fn footprint_scale<'b>(scale: Float<'b>, spread: Float<'b>) -> Float<'b> {
    scale.square().min(1e8 / (spread + 1e-20))
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
