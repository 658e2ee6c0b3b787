//! What scales and shifts a noise.

use mipless_codegen::ir::{Builder, Float};

/// What is added to a noise and what multiplies it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Affine<'b> {
    /// The factor.
    pub(crate) amplitude: Float<'b>,
    /// The term.
    pub(crate) pivot: Float<'b>,
}

impl<'b> Affine<'b> {
    /// The noise itself.
    pub(crate) fn unit(b: &'b Builder) -> Self {
        Self {
            amplitude: b.float(1.0),
            pivot: b.float(0.0),
        }
    }
}
