//! The sources of detail against dense numerical truth, and their distributions against what their
//! pages state.

#[path = "sources/cell.rs"]
mod cell;
#[path = "sources/gabor.rs"]
mod gabor;
#[path = "sources/phasor.rs"]
mod phasor;
#[path = "sources/random.rs"]
mod random;
#[path = "sources/scatter.rs"]
mod scatter;
#[path = "sources/spectral.rs"]
mod spectral;
#[path = "sources/truth.rs"]
mod truth;
#[path = "sources/worley.rs"]
mod worley;
