//! The catalogue of nodes: one file each.

mod noise;

mod fractal2d;
mod noise2d;
mod spectralnoise2d;

use mipless_codegen::NodeDef;

/// Every node, by category and name.
pub fn catalogue() -> &'static [NodeDef] {
    const CATALOGUE: &[NodeDef] = &[fractal2d::DEF, noise2d::DEF, spectralnoise2d::DEF];
    CATALOGUE
}
