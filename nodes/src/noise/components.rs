//! Which hash decides a noise, and the components of noises of several numbers.

use crate::port;
use mipless_codegen::Lower;
use mipless_codegen::moments::Signal;
use mipless_graph::{Default, Node, PortSpec, PortType, Range};

/// Which hash decides what is random.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Hash {
    /// That of this catalogue.
    Mipless,
    /// MaterialX's.
    Materialx,
}

/// Whose noise it is.
pub(crate) const HASH: PortSpec = port::choice(
    "hash",
    &["mipless", "materialx"],
    "mipless",
    "Whose random numbers: `materialx` gives the blobs of MaterialX's node of this name, and its \
     amplitude.",
);

/// How many numbers it has.
pub(crate) const SIGNATURE: PortSpec = port::choice(
    "signature",
    &["float", "vector2", "vector3", "vector4", "color3", "color4"],
    "float",
    "The type of the result: a noise of its own in each component.",
);

/// How strong, one number for all components or one for each.
pub(crate) const AMPLITUDES: PortSpec = PortSpec::new(
    "amplitude",
    PortType::Own,
    Default::Float(1.0),
    "Four standard deviations of the noise; with MaterialX's hash its own measure. One number, or \
     one for each component.",
)
.range(Range::soft(0.0, 4.0));

impl Hash {
    /// The node's `hash`.
    pub(crate) fn of(lower: &Lower<'_, '_>, node: &Node) -> Self {
        if lower.choice(node, "hash") == "materialx" {
            Self::Materialx
        } else {
            Self::Mipless
        }
    }
}

/// How MaterialX tells the components of a noise apart: three are bytes of one hash, others are read
/// elsewhere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Apart {
    /// Whether the second of two components is read elsewhere.
    pub(crate) second: bool,
    /// How far away.
    pub(crate) by: [f32; 3],
}

/// The components of `noise2d` and `noise3d`.
pub(crate) const NOISE: Apart = Apart {
    second: false,
    by: [19.0, 73.0, 29.0],
};

/// The components of `fractal2d` and `fractal3d`.
pub(crate) const FRACTAL: Apart = Apart {
    second: true,
    by: [19.0, 193.0, 17.0],
};

/// One of the components of a noise.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Component {
    /// Which.
    pub(crate) index: usize,
    /// Which byte of MaterialX's hash decides it.
    pub(crate) byte: u8,
    /// How far away it is read.
    moved: Option<[f32; 3]>,
    /// What is added to the seed.
    seed: i32,
}

impl Component {
    /// All components of a node.
    pub(crate) fn all(hash: Hash, count: usize, apart: Apart) -> Vec<Self> {
        let component = |index: usize| match hash {
            Hash::Mipless => Self {
                index,
                byte: 0,
                moved: None,
                // Far from the seeds that people count up.
                seed: (index as i32).wrapping_mul(0x3c6e_f372),
            },
            Hash::Materialx => {
                let moved = index == 3 || (count == 2 && index == 1 && apart.second);
                Self {
                    index,
                    byte: if moved { 0 } else { index as u8 },
                    moved: moved.then_some(apart.by),
                    seed: 0,
                }
            }
        };
        (0..count).map(component).collect()
    }

    /// Where it is read.
    pub(crate) fn place<'b>(self, position: &[Signal<'b>]) -> Vec<Signal<'b>> {
        let moved = self.moved.unwrap_or_default();
        (position.iter().zip(moved))
            .map(|(axis, by)| {
                if by == 0.0 {
                    axis.clone()
                } else {
                    axis.offset(by)
                }
            })
            .collect()
    }

    /// Its seed, where the node has this one.
    pub(crate) fn seed(self, seed: i32) -> i32 {
        seed.wrapping_add(self.seed)
    }
}
