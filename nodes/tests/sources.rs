//! The sources of detail against dense numerical truth, and their distributions against what their
//! pages state.

#[path = "sources/gabor.rs"]
mod gabor;
#[path = "sources/truth.rs"]
mod truth;
