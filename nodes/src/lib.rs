//! The catalogue of nodes: one file each, named as the node type.
//!
//! A node is its [`NodeSpec`](mipless_graph::NodeSpec) as data, its statistics rule, and a lowering
//! that builds IR through the moment algebra. Nothing else knows a node by name.

mod componentwise;
mod noise;
mod page;
mod pattern;

mod absval;
mod add;
mod brick;
mod checkerboard;
mod circle;
mod clamp;
mod colorramp;
mod combine3;
mod constant;
mod divide;
mod extract;
mod fractal2d;
mod gradientangular;
mod gradientradial;
mod grid;
mod hexagon;
mod invert;
mod kaleidoscope;
mod line;
mod luminance;
mod max;
mod min;
mod mirror;
mod mix;
mod multiply;
mod noise2d;
mod place2d;
mod polar;
mod power;
mod ramp4;
mod ramplr;
mod ramptb;
mod range;
mod repeat;
mod rotate2d;
mod shape;
mod sin;
mod smoothstep;
mod spectralnoise2d;
mod splitlr;
mod splittb;
mod step;
mod stripes;
mod subtract;
mod swirl;
mod texcoord;
mod tiledcircles;
mod tiledhexagons;
mod warp;

pub use page::{describe, page};

use mipless_codegen::NodeDef;
use mipless_graph::NodeSpec;

/// Every node definition, sorted by category.
static CATALOGUE: &[NodeDef] = &[
    // Input.
    constant::DEF,
    texcoord::DEF,
    // Noise.
    fractal2d::DEF,
    noise2d::DEF,
    spectralnoise2d::DEF,
    // Pattern.
    brick::DEF,
    checkerboard::DEF,
    circle::DEF,
    gradientangular::DEF,
    gradientradial::DEF,
    grid::DEF,
    hexagon::DEF,
    line::DEF,
    ramp4::DEF,
    ramplr::DEF,
    ramptb::DEF,
    shape::DEF,
    splitlr::DEF,
    splittb::DEF,
    stripes::DEF,
    tiledcircles::DEF,
    tiledhexagons::DEF,
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
    kaleidoscope::DEF,
    mirror::DEF,
    place2d::DEF,
    polar::DEF,
    repeat::DEF,
    rotate2d::DEF,
    swirl::DEF,
    warp::DEF,
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
