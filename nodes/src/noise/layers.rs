//! The octaves of a noise as signals of their own, for what is not linear in each of them.

use super::affine::Affine;
use super::kernel::Kernel;
use super::octaves::tiled_octaves;
use super::source::EXTENT;
use super::sum::Octaves;
use mipless_codegen::Lower;
use mipless_codegen::moments::Signal;
use mipless_graph::Node;

/// One octave of variance 1.
#[derive(Clone, Debug)]
pub(crate) struct Layer {
    /// The filtered noise.
    pub(crate) noise: Signal,
    /// diminishᵏ.
    pub(crate) amplitude: f32,
    /// Its share: 1, but for the last one of a fractional count.
    pub(crate) share: f32,
}

/// The octaves that a node's ports ask for, the coarsest first, at a position in cells of it.
///
/// Their remainders join the private variance of each, whatever becomes of the node.
pub(crate) fn layers(lower: &mut Lower<'_>, node: &Node, position: Vec<Signal>) -> Vec<Layer> {
    let kernel = Kernel::of(lower, node);
    let octaves = tiled_octaves(lower, node);
    // What is made of the octaves has the detail of the first one at least.
    let first = Octaves {
        count: 1,
        part: 0.0,
        ..octaves
    };
    kernel.report(lower, &position, first);
    let shares = std::mem::replace(&mut lower.algebra.shares, false);
    let mut position = position;
    let mut period = octaves.period as f32;
    let mut layers = Vec::new();
    for k in 0..octaves.count + u32::from(octaves.part > 0.0) {
        let one = Octaves {
            count: 1,
            part: 0.0,
            period: period.round() as u32,
            seed: octaves
                .seed
                .wrapping_add(k.wrapping_mul(0x9e37_79b9) as i32),
            ..octaves
        };
        let shape = Affine::unit(lower.b());
        layers.push(Layer {
            noise: kernel
                .signal(lower, &position, one, shape)
                .with_range([-EXTENT, EXTENT]),
            amplitude: octaves.diminish.powi(k as i32),
            share: if k < octaves.count { 1.0 } else { octaves.part },
        });
        period *= octaves.lacunarity;
        let b = lower.b();
        let lacunarity = b.f32(octaves.lacunarity);
        // Octaves must not share lattice points, where the variance of all is largest.
        let shift = b.f32(0.381_966);
        for axis in &mut position {
            *axis = axis.scale(b, lacunarity).offset(b, shift);
        }
    }
    lower.algebra.shares = shares;
    layers
}

/// Hands the private variance of a signal to the algebra as fresh: a symbol where the node is read
/// by several.
pub(crate) fn published(lower: &mut Lower<'_>, mut signal: Signal) -> Signal {
    let zero = lower.b().f32(0.0);
    let private = std::mem::replace(&mut signal.private, zero);
    lower.algebra.attach_fresh(&mut signal, private);
    signal
}
