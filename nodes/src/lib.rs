//! The catalogue of nodes: one file each, named as the node type.
//!
//! A node is its [`NodeSpec`](mipless_graph::NodeSpec) as data, its statistics rule, and a lowering
//! that builds IR through the moment algebra. Nothing else knows a node by name.

mod arc;
mod blend;
mod componentwise;
mod noise;
mod page;
mod pattern;
mod picture;

mod absval;
mod acos;
mod add;
mod asin;
mod atan;
mod bias;
mod brick;
mod burn;
mod byexample;
mod ceil;
mod checkerboard;
mod clamp;
mod colormap2d;
mod colorramp;
mod combine3;
mod constant;
mod contrast;
mod cos;
mod darken;
mod difference;
mod divide;
mod dodge;
mod exp;
mod extract;
mod floor;
mod fract;
mod fractal2d;
mod gabornoise2d;
mod gain;
mod grid;
mod hardlight;
mod ifequal;
mod ifgreater;
mod ifgreatereq;
mod image;
mod invert;
mod kaleidoscope;
mod levels;
mod lighten;
mod linearlight;
mod ln;
mod luminance;
mod max;
mod min;
mod minus;
mod mirror;
mod mix;
mod modulo;
mod multiply;
mod noise2d;
mod overlay;
mod place2d;
mod plus;
mod polar;
mod power;
mod quantize;
mod ramp4;
mod ramplr;
mod ramptb;
mod range;
mod repeat;
mod rotate2d;
mod round;
mod screen;
mod sign;
mod sin;
mod smoothmax;
mod smoothmin;
mod smoothstep;
mod softlight;
mod spectralnoise2d;
mod splitlr;
mod splittb;
mod sqrt;
mod squarewave;
mod step;
mod stripes;
mod subtract;
mod swirl;
mod switch;
mod tan;
mod texcoord;
mod trianglewave;
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
    byexample::DEF,
    fractal2d::DEF,
    gabornoise2d::DEF,
    noise2d::DEF,
    spectralnoise2d::DEF,
    // Pattern.
    brick::DEF,
    checkerboard::DEF,
    image::DEF,
    grid::DEF,
    ramp4::DEF,
    ramplr::DEF,
    ramptb::DEF,
    splitlr::DEF,
    splittb::DEF,
    stripes::DEF,
    // Arithmetic.
    add::DEF,
    burn::DEF,
    darken::DEF,
    difference::DEF,
    divide::DEF,
    dodge::DEF,
    hardlight::DEF,
    ifequal::DEF,
    ifgreater::DEF,
    ifgreatereq::DEF,
    lighten::DEF,
    linearlight::DEF,
    max::DEF,
    min::DEF,
    minus::DEF,
    mix::DEF,
    multiply::DEF,
    overlay::DEF,
    plus::DEF,
    screen::DEF,
    smoothmax::DEF,
    smoothmin::DEF,
    softlight::DEF,
    subtract::DEF,
    switch::DEF,
    // Transfer.
    absval::DEF,
    acos::DEF,
    asin::DEF,
    atan::DEF,
    bias::DEF,
    ceil::DEF,
    clamp::DEF,
    contrast::DEF,
    cos::DEF,
    exp::DEF,
    floor::DEF,
    fract::DEF,
    gain::DEF,
    invert::DEF,
    levels::DEF,
    ln::DEF,
    modulo::DEF,
    power::DEF,
    quantize::DEF,
    range::DEF,
    round::DEF,
    sign::DEF,
    sin::DEF,
    smoothstep::DEF,
    sqrt::DEF,
    squarewave::DEF,
    step::DEF,
    tan::DEF,
    trianglewave::DEF,
    // Color.
    colormap2d::DEF,
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
