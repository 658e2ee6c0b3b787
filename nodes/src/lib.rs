//! The catalogue of nodes: one file each, named as the node type.
//!
//! A node is its [`NodeSpec`](mipless_graph::NodeSpec) as data, its statistics rule, and a lowering
//! that builds IR through the moment algebra. Nothing else knows a node by name.

mod componentwise;
mod noise;
mod page;
mod picture;

mod absval;
mod add;
mod byexample;
mod checkerboard;
mod clamp;
mod colorramp;
mod combine3;
mod constant;
mod divide;
mod extract;
mod fractal2d;
mod image;
mod invert;
mod luminance;
mod max;
mod min;
mod mix;
mod multiply;
mod noise2d;
mod place2d;
mod power;
mod range;
mod rotate2d;
mod sin;
mod smoothstep;
mod spectralnoise2d;
mod step;
mod stripes;
mod subtract;
mod texcoord;

pub use page::{describe, page};

use mipless_codegen::NodeDef;
use mipless_graph::NodeSpec;

/// Every node definition, sorted by category.
static CATALOGUE: &[NodeDef] = &[
    // Input.
    constant::DEF,
    texcoord::DEF,
    // Noise.
    byexample::DEF,
    fractal2d::DEF,
    noise2d::DEF,
    spectralnoise2d::DEF,
    // Pattern.
    checkerboard::DEF,
    image::DEF,
    stripes::DEF,
    // Arithmetic.
    add::DEF,
    divide::DEF,
    max::DEF,
    min::DEF,
    mix::DEF,
    multiply::DEF,
    subtract::DEF,
    // Transfer.
    absval::DEF,
    clamp::DEF,
    invert::DEF,
    power::DEF,
    range::DEF,
    sin::DEF,
    smoothstep::DEF,
    step::DEF,
    // Color.
    colorramp::DEF,
    luminance::DEF,
    // Coordinate.
    place2d::DEF,
    rotate2d::DEF,
    // Channel.
    combine3::DEF,
    extract::DEF,
];

/// The node definitions, in the order of the reference pages: what codegen compiles with.
pub fn catalogue() -> &'static [NodeDef] {
    CATALOGUE
}

/// The specs of [`catalogue`], in the same order: what documents are resolved with.
pub fn specs() -> Vec<&'static NodeSpec> {
    CATALOGUE.iter().map(|def| def.spec).collect()
}

/// The definition of a node type; aliases are not looked up.
pub fn find(name: &str) -> Option<&'static NodeDef> {
    CATALOGUE.iter().find(|def| def.spec.name == name)
}

#[cfg(test)]
mod tests;
