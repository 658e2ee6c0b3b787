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
pub(crate) struct Layer<'b> {
    /// The filtered noise.
    pub(crate) noise: Signal<'b>,
    /// diminishᵏ.
    pub(crate) amplitude: f32,
    /// Its share: 1, but for the last one of a fractional count.
    pub(crate) share: f32,
}

/// The octaves that a node's ports ask for, the coarsest first, at a position in cells of it.
///
/// Their remainders join the private variance of each, whatever becomes of the node.
pub(crate) fn layers<'b>(
    lower: &mut Lower<'_, 'b>,
    node: &Node,
    mut position: Vec<Signal<'b>>,
) -> Vec<Layer<'b>> {
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
        // Octaves must not share lattice points, where the variance of all is largest.
        for axis in &mut position {
            *axis = (&*axis * octaves.lacunarity).offset(0.381_966);
        }
    }
    lower.algebra.shares = shares;
    layers
}

/// Hands the private variance of a signal to the algebra as fresh: a symbol where the node is read
/// by several.
pub(crate) fn published<'b>(lower: &mut Lower<'_, 'b>, mut signal: Signal<'b>) -> Signal<'b> {
    let private = std::mem::replace(&mut signal.private, lower.b().float(0.0));
    lower.algebra.attach_fresh(&mut signal, private);
    signal
}
