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

use super::perlin::fit::SPACE;
use super::sum::Octaves;
use mipless_codegen::Lower;
use mipless_codegen::ir::{Builder, Value};
use mipless_codegen::moments::{Mode, Signal};
use mipless_graph::Node;
use spread::Inverse;
pub(super) use spread::Spread;

/// a of the quadrupole: the width of the kernel, in cells.
const WIDTH: f32 = 0.3854;

/// What is at each lattice point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A second-order kernel under a Gaussian.
    Quadrupole,
    /// A gradient under the quintic window.
    Quintic,
}

impl Kind {
    /// The node's `kernel`.
    pub(crate) fn of(lower: &Lower<'_>, node: &Node) -> Self {
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
            Self::Quintic => SPACE.width,
        }
    }

    /// What the sum over unfiltered kernels is multiplied by.
    fn unit(self) -> f32 {
        match self {
            Self::Quadrupole => quadrupole::unit(),
            Self::Quintic => quintic::unit(),
        }
    }

    /// The wavelength of the dominant detail on a plane through the noise, in cells: where k times
    /// the spectrum has its peak. The quadrupole's there is (k⁴ + k²/a² + 3/4a⁴) e^{−a²k²}, with
    /// the peak at k = 1.405/a.
    fn wavelength(self) -> f32 {
        match self {
            Self::Quadrupole => std::f32::consts::TAU * WIDTH / 1.405,
            Self::Quintic => 1.93,
        }
    }

    /// The energy that a filter leaves, and its derivatives by the footprint.
    fn energy(self, b: &mut Builder, spread: &Spread, inverse: &Inverse) -> [Value; 3] {
        match self {
            Self::Quadrupole => energy::quadrupole(b, spread, inverse),
            Self::Quintic => energy::quintic(b, spread, SPACE.width),
        }
    }
}

/// The pairs of axes of a symmetric matrix, in the order of its six numbers.
const PAIRS: [[usize; 2]; 6] = [[0, 0], [0, 1], [0, 2], [1, 1], [1, 2], [2, 2]];

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

/// Where the number of a pair of axes stands.
fn place(i: usize, j: usize) -> usize {
    PAIRS
        .iter()
        .position(|&pair| pair == [i.min(j), i.max(j)])
        .expect("axes are below 3")
}

/// The filtered sum of octaves as a signal, at a position in cells of the first octave; unit
/// variance of the first octave.
pub(crate) fn filtered(
    lower: &mut Lower<'_>,
    position: &[Signal],
    kind: Kind,
    octaves: Octaves,
) -> Signal {
    let mode = lower.mode();
    let b = lower.b();
    let spread = Spread::of(b, position, kind.width());
    let size = spread.size(b);
    // The first octave dominates: it decides what the footprint is to the source.
    let wavelengths = b.scale(size, kind.width() / kind.wavelength());
    lower.source_footprint(wavelengths);
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
    let captures = match mode {
        Mode::Point => Vec::new(),
        _ => spread.captures(),
    };
    let seed = octaves.scrambled_seed(lower.b());
    let sums = octaves.fold(
        lower,
        &octave,
        (position, seed),
        parts(mode),
        &captures,
        None,
    );
    at(lower, position, &sums)
}

/// The signal of a field (its numbers come first, then the rest if the mode spreads) at a position: g = Jᵀ∇M,
/// H = Jᵀ Hess(M) J + Σ ∂_i M H_i, the position's own symbols through ∇M, the rest as a fresh ε.
pub(super) fn at(lower: &mut Lower<'_>, position: &[Signal], sums: &[Value]) -> Signal {
    let algebra = &mut lower.algebra;
    let (mode, b) = (algebra.mode, &mut algebra.b);
    let mut signal = Signal::certain(b, sums[0]);
    if !mode.spreads() {
        return signal;
    }
    let parts = parts(mode);
    let field = &sums[..parts];
    if let Some(gradient) = field.get(1..4) {
        for (axis, &slope) in position.iter().zip(gradient) {
            let part = axis.scale(b, slope);
            signal = signal.add(b, &part);
        }
        signal.cell = None;
        signal.mean = sums[0];
    }
    if let Some(hessian) = field.get(4..10) {
        for (out, (i, j)) in [(0, 0), (0, 1), (1, 1)].into_iter().enumerate() {
            let mut sum = signal.h[out];
            for p in 0..3 {
                for q in 0..3 {
                    let product = b.mul(position[p].g[i], position[q].g[j]);
                    let part = b.mul(product, hessian[place(p, q)]);
                    sum = b.add(sum, part);
                }
            }
            signal.h[out] = sum;
        }
    }
    lower.algebra.attach_fresh(&mut signal, sums[parts]);
    signal
}
