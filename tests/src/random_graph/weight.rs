//! How often people use which node.

use crate::random::Random;
use mipless::{NodeDef, NodeSpec};
use std::sync::LazyLock;

/// Nodes that are used more often than once in a while, by how many times. The order is that of the
/// nodes in 43 published Material Maker graphs (ramps and blends first, then transformations, noises,
/// normals, shapes, patterns), with the arithmetic that the same pictures take elsewhere.
const OFTEN: &[(u32, &[&str])] = &[
    (20, &["colorramp"]),
    (14, &["mix"]),
    (10, &["multiply", "place2d", "fractal2d", "noise2d"]),
    (8, &["add", "smoothstep", "warp"]),
    (
        6,
        &["clamp", "valuenoise2d", "stripes", "combine2", "subtract"],
    ),
    (
        5,
        &[
            "worleynoise2d",
            "heighttonormal",
            "shape",
            "brick",
            "checkerboard",
            "invert",
            "power",
            "sin",
            "max",
            "min",
            "absval",
            "range",
            "levels",
            "extract",
        ],
    ),
    (
        4,
        &[
            "step",
            "ifgreater",
            "wave",
            "combine3",
            "fract",
            "texcoord",
            "constant",
            "screen",
            "overlay",
            "floor",
            "modulo",
        ],
    ),
    (
        3,
        &[
            "plus",
            "separate2",
            "separate3",
            "luminance",
            "convert",
            "cellnoise2d",
            "circle",
            "grid",
            "ramplr",
            "quantize",
            "trianglewave",
            "hsvadjust",
            "contrast",
            "rotate2d",
            "distance",
            "divide",
            "magnitude",
            "ridged2d",
        ],
    ),
];

/// What has come into the catalogue since random graphs have been held to laws, one row at a time.
const NEWER: [&[&str]; 1] = [&["rays", "scatter", "truchet", "weave"]];

/// How many seeds draw from the catalogue as it stood before each row of [`NEWER`], so that their graphs
/// are the same when it grows.
const SEEDS: u64 = 10_000;

/// The catalogue as it stood at some time: with so many rows of [`NEWER`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Generation(usize);

impl Generation {
    /// All of the catalogue.
    pub(super) const NEWEST: Self = Self(NEWER.len());

    /// What the graph of a seed is made of.
    pub(super) fn of(seed: u64) -> Self {
        Self((seed / SEEDS).min(NEWER.len() as u64) as usize)
    }
}

/// The sum of the weights up to each node of the catalogue, generation by generation.
static SUMS: LazyLock<Vec<Vec<u32>>> = LazyLock::new(|| {
    let sums = |generation: usize| {
        let sum = |sum: &mut u32, def: &NodeDef| {
            // A material ends a graph: no node reads it.
            let is_read = def.spec.material().is_none();
            let is_there = !NEWER[generation..].concat().contains(&def.spec.name);
            *sum += if is_read && is_there {
                weight(def.spec.name)
            } else {
                0
            };
            Some(*sum)
        };
        mipless::catalogue().iter().scan(0, sum).collect()
    };
    (0..=NEWER.len()).map(sums).collect()
});

fn weight(name: &str) -> u32 {
    let often = OFTEN.iter().find(|(_, names)| names.contains(&name));
    often.map_or(1, |(weight, _)| *weight)
}

/// A node, as often as people use it.
pub(super) fn node(random: &mut Random, Generation(generation): Generation) -> &'static NodeSpec {
    let sums = &SUMS[generation];
    let total = *sums.last().expect("the catalogue holds nodes");
    let place = random.below(total as usize) as u32;
    mipless::catalogue()[sums.partition_point(|&sum| sum <= place)].spec
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_used_often_is_in_the_catalogue() {
        for name in OFTEN.iter().flat_map(|(_, names)| *names) {
            let known = |def: &NodeDef| def.spec.name == *name;
            assert!(mipless::catalogue().iter().any(known), "{name}");
        }
    }

    #[test]
    fn every_node_is_drawn() {
        let mut random = Random::new(1);
        let mut drawn = std::collections::BTreeSet::new();
        for _ in 0..20_000 {
            drawn.insert(node(&mut random, Generation::NEWEST).name);
        }
        let is_read = |def: &&NodeDef| def.spec.material().is_none();
        assert_eq!(
            drawn.len(),
            mipless::catalogue().iter().filter(is_read).count()
        );
    }
}
