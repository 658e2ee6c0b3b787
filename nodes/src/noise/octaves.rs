//! The ports of noises that are made of octaves.

use super::components::Hash;
use super::source::tiling;
use super::sum::Octaves;
use crate::port;
use mipless_codegen::Lower;
use mipless_graph::{Behaviour, InputView, Node, PortSpec, Range};

/// How many.
pub(crate) const OCTAVES: PortSpec = port::number(
    "octaves",
    3.0,
    "How many noises are summed; a fraction is the share of the last one's amplitude.",
)
.uniform()
.range(Range::hard(1.0, 16.0).with_soft(1.0, 8.0))
.unit("count");

/// How much finer each is.
pub(crate) const LACUNARITY: PortSpec = port::number(
    "lacunarity",
    2.0,
    "The ratio of the frequencies of neighbouring octaves.",
)
.uniform()
.range(Range::hard(1.0, 8.0).with_soft(1.5, 3.0));

/// How much weaker each is.
pub(crate) const DIMINISH: PortSpec = port::number(
    "diminish",
    0.5,
    "The ratio of the amplitudes of neighbouring octaves.",
)
.uniform()
.range(Range::hard(0.0, 2.0).with_soft(0.0, 1.0));

/// The class of octaves on lattices that may tile.
pub(crate) fn repeating(inputs: &dyn InputView, deviation: f32) -> Behaviour {
    let (octaves, lacunarity) = (inputs.number("octaves"), inputs.number("lacunarity"));
    tiling(inputs, octaves.ceil(), lacunarity, deviation)
}

/// The octaves that a node's ports ask for, with its `period`.
pub(crate) fn tiled_octaves(lower: &Lower<'_, '_>, node: &Node) -> Octaves {
    Octaves {
        period: lower.integer(node, "period").max(0) as u32,
        ..octaves(lower, node)
    }
}

/// The octaves that a node's ports ask for.
pub(crate) fn octaves(lower: &Lower<'_, '_>, node: &Node) -> Octaves {
    let octaves = lower.float(node, "octaves");
    Octaves {
        count: octaves as u32,
        part: octaves.fract(),
        lacunarity: lower.float(node, "lacunarity"),
        diminish: lower.float(node, "diminish"),
        seed: lower.integer(node, "seed"),
        period: 0,
        ratio: 1.0,
        hash: Hash::Mipless,
    }
}
