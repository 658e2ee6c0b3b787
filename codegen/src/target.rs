//! Targets: validation of emitted WGSL and its translation, both by naga, and the manifest.
//!
//! All but the manifest needs the feature `targets`: naga is much to build for a host that takes the
//! WGSL as it is.

#[cfg(feature = "targets")]
mod glsl;
#[cfg(feature = "targets")]
mod included;
mod manifest;
#[cfg(feature = "targets")]
mod translate;
#[cfg(feature = "targets")]
mod validate;

#[cfg(feature = "targets")]
pub(crate) use included::items;
pub use manifest::{Manifest, ManifestOutput, ManifestParameter, ManifestTable, Range};
#[cfg(feature = "targets")]
pub use translate::{Target, TranslateError, Translated, translate};
#[cfg(feature = "targets")]
pub use validate::{ValidateError, Validated, validate};
