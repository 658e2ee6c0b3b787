//! Targets: validation of emitted WGSL and its translation, both by naga.
//!
//! It needs the feature `targets`: naga is much to build for a host that takes the WGSL as it is.

#[cfg(feature = "targets")]
mod glsl;
#[cfg(feature = "targets")]
mod included;
#[cfg(feature = "targets")]
mod language;
#[cfg(feature = "targets")]
mod translate;
#[cfg(feature = "targets")]
mod validate;

#[cfg(feature = "targets")]
pub(crate) use included::items;
#[cfg(feature = "targets")]
pub use language::{Target, TranslateError};
#[cfg(feature = "targets")]
pub use translate::{Translated, translate};
#[cfg(feature = "targets")]
pub use validate::{ValidateError, Validated, validate};

/// The range of a graph's input: what the document says of it.
pub type Range = (Option<f32>, Option<f32>);
