//! Lattice noise in space: a random second-order kernel at every lattice point, which any Gaussian
//! footprint filters exactly, or Perlin's gradient noise.
//!
//! A footprint is a Gaussian on the surface; the map to space makes it a Gaussian of covariance Σ
//! (3×3, of rank 2 where nothing displaces the surface). In units of the kernel's width a, with
//! S = Σ/a², P = (I + S)⁻¹, d the offset to the lattice point, u = Pd and E = e^{−d·u/2}, the
//! filtered noise is Σ E k/√det(I + S) with k a polynomial of d and the random number of the point.
//! The unfiltered noise has variance 1 (over random lattices).

mod energy;
mod kernel;
mod octave;
mod points;
mod quadrupole;
mod quintic;
mod spread;
mod symmetric;

use super::perlin::fit::SPACE;
use super::sum::Octave;
use super::sum::Octaves;
use mipless_codegen::Lower;
use mipless_codegen::ir::Float;
use mipless_codegen::moments::{Mode, Signal};
use mipless_graph::Node;
use spread::Inverse;
pub(super) use spread::Spread;
use symmetric::Symmetric;

/// a of the quadrupole: the width of the kernel, in cells.
const WIDTH: f32 = 0.3854;

/// What is at each lattice point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A second-order kernel under a Gaussian.
    Quadrupole,
    /// A gradient under the quintic window.
    Quintic,
    /// The same with one of twelve directions by a byte of MaterialX's hash.
    Materialx(u8),
}

impl Kind {
    /// The node's `kernel`.
    pub(crate) fn of(lower: &Lower<'_, '_>, node: &Node) -> Self {
        if lower.choice(node, "kernel") == "quintic" {
            Self::Quintic
        } else {
            Self::Quadrupole
        }
    }

    /// a, in cells.
    fn width(self) -> f32 {
        match self {
            Self::Quadrupole => WIDTH,
            Self::Quintic | Self::Materialx(_) => SPACE.width,
        }
    }

    /// What the sum over unfiltered kernels is multiplied by.
    pub(crate) fn unit(self) -> f32 {
        match self {
            Self::Quadrupole => quadrupole::unit(),
            Self::Quintic => quintic::unit(),
            // Its directions have the squared length 2.
            Self::Materialx(_) => quintic::unit() * std::f32::consts::FRAC_1_SQRT_2,
        }
    }

    /// The wavelength of the dominant detail on a plane through the noise, in cells: where k times
    /// the spectrum has its peak. The quadrupole's there is (k⁴ + k²/a² + 3/4a⁴) e^{−a²k²}, with
    /// the peak at k = 1.405/a.
    fn wavelength(self) -> f32 {
        match self {
            Self::Quadrupole => std::f32::consts::TAU * WIDTH / 1.405,
            Self::Quintic | Self::Materialx(_) => 1.93,
        }
    }

    /// The energy that a filter leaves, and its derivatives by the footprint.
    fn energy<'b>(self, spread: &Spread<'b>, inverse: &Inverse<'b>) -> [Float<'b>; 3] {
        match self {
            Self::Quadrupole => energy::quadrupole(spread, inverse),
            Self::Quintic | Self::Materialx(_) => energy::quintic(spread, SPACE.width),
        }
    }
}

/// The names of a field's numbers: mean, gradient, Hessian.
const NAMES: [&str; 10] = [
    "mean", "dx", "dy", "dz", "dxx", "dxy", "dxz", "dyy", "dyz", "dzz",
];

/// How many numbers a mode needs of a field.
fn parts(mode: Mode) -> usize {
    match mode {
        Mode::Point | Mode::Naive | Mode::Ensemble => 1,
        Mode::Local => 4,
        Mode::Quad => 10,
    }
}

/// The filtered sum of octaves as a signal, at a position in cells of the first octave; unit
/// variance of the first octave.
pub(crate) fn filtered<'b>(
    lower: &mut Lower<'_, 'b>,
    position: &[Signal<'b>],
    kind: Kind,
    octaves: Octaves,
) -> Signal<'b> {
    let mode = lower.mode();
    let spread = Spread::of(position, kind.width());
    // The first octave dominates: it decides what the footprint is to the source.
    lower.source_footprint(spread.size() * (kind.width() / kind.wavelength()));
    let Octaves {
        lacunarity,
        diminish,
        ..
    } = octaves;
    let tiles = octaves.tiles();
    let key = format!("volume {kind:?} {mode:?} {lacunarity} {diminish} {tiles}");
    let octave = lower.function(&key, |module| match mode {
        Mode::Point => octave::point(module, kind, octaves),
        _ => octave::filtered(module, kind, mode, octaves),
    });
    let captures = (mode != Mode::Point).then_some(spread);
    let seed = octaves.scrambled_seed(lower.b());
    let first: Octave<'b, 3> = Octave::first(position, seed, octaves);
    let sums = octaves.fold(lower, &octave, first, parts(mode), captures, None);
    at(lower, position, &sums)
}

/// The signal of a field (its numbers come first, then the rest if the mode spreads) at a position: g = Jᵀ∇M,
/// H = Jᵀ Hess(M) J + Σ ∂_i M H_i, the position's own symbols through ∇M, the rest as a fresh ε.
pub(super) fn at<'b>(
    lower: &mut Lower<'_, 'b>,
    position: &[Signal<'b>],
    sums: &[Float<'b>],
) -> Signal<'b> {
    let mode = lower.mode();
    let mut signal = Signal::certain(sums[0]);
    if !mode.spreads() {
        return signal;
    }
    let parts = parts(mode);
    let field = &sums[..parts];
    if let Some(gradient) = field.get(1..4) {
        for (axis, &slope) in position.iter().zip(gradient) {
            signal = signal + axis * slope;
        }
        signal.cell = None;
        signal.mean = sums[0];
    }
    if let Some(hessian) = field[parts.min(4)..].first_chunk() {
        let hessian = Symmetric(*hessian);
        for (out, (i, j)) in [(0, 0), (0, 1), (1, 1)].into_iter().enumerate() {
            for p in 0..3 {
                for q in 0..3 {
                    signal.h[out] += position[p].g[i] * position[q].g[j] * hessian.at(p, q);
                }
            }
        }
    }
    lower.algebra.attach_fresh(&mut signal, sums[parts]);
    signal
}
