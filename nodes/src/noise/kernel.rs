//! The choice of a kernel at each lattice point.

use super::field::{Field, Spread};
use super::lattice::{self, Octaves};
use super::perlin::{self, Kind};
use mipless_codegen::Lower;
use mipless_codegen::moments::Signal;
use mipless_graph::Node;

/// What is at each lattice point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kernel {
    /// The quadrupole.
    Gaussian,
    /// The quintic window.
    Quintic(Kind),
}

impl Kernel {
    /// The node's `kernel`.
    pub(crate) fn of(lower: &Lower<'_>, node: &Node) -> Self {
        if lower.choice(node, "kernel") == "quintic" {
            Self::Quintic(Kind::Gradient)
        } else {
            Self::Gaussian
        }
    }

    /// The filtered sum of octaves at a position in cells of the first octave; unit variance of
    /// the first octave.
    pub(crate) fn filtered(
        self,
        lower: &mut Lower<'_>,
        position: &[Signal],
        octaves: Octaves,
    ) -> Field {
        match self {
            Self::Gaussian => lattice::filtered(lower, position, octaves),
            Self::Quintic(kind) => perlin::filtered(lower, position, kind, octaves),
        }
    }

    /// Reports what the footprint is to a source at this position, in cells of its first octave,
    /// which dominates.
    pub(crate) fn report(self, lower: &mut Lower<'_>, position: &[Signal]) {
        self.report_finer(lower, position, 1.0);
    }

    /// The same of a sum of octaves.
    pub(crate) fn report_octaves(
        self,
        lower: &mut Lower<'_>,
        position: &[Signal],
        octaves: Octaves,
    ) {
        self.report_finer(lower, position, octaves.finer());
    }

    fn report_finer(self, lower: &mut Lower<'_>, position: &[Signal], finer: f32) {
        let wavelength = match self {
            Self::Gaussian => lattice::WAVELENGTH,
            Self::Quintic(kind) => kind.wavelength(),
        };
        let b = lower.b();
        let spread = Spread::of(b, position);
        let size = b.sqrt(spread.eigenvalues[0]);
        let wavelengths = b.scale(size, 1.0 / wavelength);
        lower.source_detail(wavelengths, finer);
    }
}
