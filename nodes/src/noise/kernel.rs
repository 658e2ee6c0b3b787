//! The choice of a kernel at each lattice point.

use super::field::Field;
use super::lattice::{self, Octaves};
use super::perlin::{self, Kind};
use mipless_codegen::Lower;
use mipless_codegen::moments::Signal;
use mipless_graph::Node;

/// The filtered sum of octaves of the node's `kernel` at a position in cells of the first octave.
pub(crate) fn filtered(
    lower: &mut Lower<'_>,
    node: &Node,
    position: &[Signal],
    octaves: Octaves,
) -> Field {
    if lower.choice(node, "kernel") == "quintic" {
        perlin::filtered(lower, position, Kind::Gradient, octaves)
    } else {
        lattice::filtered(lower, position, octaves)
    }
}
