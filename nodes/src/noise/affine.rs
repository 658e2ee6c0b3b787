//! What scales and shifts a noise.

use mipless_codegen::ir::{Builder, Value};

/// What is added to a noise and what multiplies it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Affine {
    /// The factor.
    pub(crate) amplitude: Value,
    /// The term.
    pub(crate) pivot: Value,
}

impl Affine {
    /// The noise itself.
    pub(crate) fn unit(b: &mut Builder) -> Self {
        Self {
            amplitude: b.f32(1.0),
            pivot: b.f32(0.0),
        }
    }
}
