//! Rendering: views, the CPU renderer, graphics devices, truth, error metrics and image files.
//!
//! # A tour
//! - A [`view::View`] gives every pixel of a picture its footprint with exact derivatives.
//! - [`cpu::Renderer`] evaluates a compiled texture over a view on all cores; `gpu::Gpu`, with
//!   the feature `gpu`, does it on a graphics device. Both return an [`image::Image`] of all results:
//!   means and, where the program computes them, variances, unlit and without a background.
//! - [`image::Image::mean`] takes one output out of it, [`view::View::present`] lights it and puts
//!   the background behind it, [`image_file`] writes it as PNG or EXR.
//! - [`lit::Lit`] lights the material of a graph instead: from the moments that a program gives of it, or, as
//!   the truth, facet by facet.
//! - [`device::Device`] is the choice between the two. [`metrics`] says how far two images are apart, and [`compare`] sets them side by side.
//! - [`plan`] measures error and cost of the methods and chooses one; [`chart`] draws what it found.
//!
//! Two features, both on by default: `files` writes pictures ([`image_file`]), `gpu` renders on a
//! graphics device.
//!
//! This is the only crate that knows wgpu, and it holds no semantics of graphs.

#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod chart;
pub mod compare;
pub mod cpu;
pub mod device;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod image;
#[cfg(feature = "files")]
pub mod image_file;
pub mod job;
pub mod lit;
pub mod metrics;
#[cfg(feature = "files")]
mod ordered;
pub mod plan;
mod size;
pub mod srgb;
pub mod view;
