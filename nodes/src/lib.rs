//! The catalogue of nodes: one file each, named as the node type.
//!
//! A node is its [`NodeSpec`](mipless_graph::NodeSpec) as data, its statistics rule, and a lowering
//! that builds IR through the moment algebra. Nothing else knows a node by name.

mod arc;
mod blend;
mod componentwise;
mod composite;
mod condition;
mod hsv;
mod noise;
mod page;
mod pattern;
mod picture;
mod separate;
mod vector;

mod absval;
mod acos;
mod add;
mod asin;
mod atan;
mod atan2;
mod bias;
mod blackbody;
mod blur;
mod brick;
mod brightness;
mod burn;
mod byexample;
mod ceil;
mod cellnoise2d;
mod cellnoise3d;
mod checkerboard;
mod circle;
mod clamp;
mod cloverleaf;
mod colorcorrect;
mod colormap2d;
mod colorramp;
mod combine2;
mod combine3;
mod combine4;
mod constant;
mod contrast;
mod convert;
mod cos;
mod crosshatch;
mod crossproduct;
mod darken;
mod difference;
mod disjointover;
mod distance;
mod divide;
mod dodge;
mod dot;
mod dotproduct;
mod exp;
mod extract;
mod floor;
mod fract;
mod fractal2d;
mod fractal3d;
mod gabornoise2d;
mod gain;
mod gradientangular;
mod gradientradial;
mod grid;
mod hardlight;
mod heighttonormal;
mod hexagon;
mod hsvadjust;
mod hsvtorgb;
mod ifequal;
mod ifgreater;
mod ifgreatereq;
mod image;
mod r#in;
mod invert;
mod kaleidoscope;
mod levels;
mod lighten;
mod line;
mod linearlight;
mod ln;
mod luminance;
mod magnitude;
mod mask;
mod matte;
mod max;
mod min;
mod minus;
mod mirror;
mod mix;
mod modulo;
mod multifractal2d;
mod multiply;
mod noise2d;
mod noise3d;
mod normalize;
mod normalmap;
mod out;
mod over;
mod overlay;
mod phasornoise2d;
mod place2d;
mod plus;
mod polar;
mod position;
mod power;
mod premult;
mod quantize;
mod ramp4;
mod ramplr;
mod ramptb;
mod randomcolor;
mod randomfloat;
mod range;
mod repeat;
mod rgbtohsv;
mod ridged2d;
mod rotate2d;
mod rotate3d;
mod round;
mod saturate;
mod screen;
mod separate2;
mod separate3;
mod separate4;
mod shape;
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
mod tiledcircles;
mod tiledcloverleafs;
mod tiledhexagons;
mod trianglewave;
mod turbulence2d;
mod unifiednoise2d;
mod unpremult;
mod valuenoise2d;
mod warp;
mod wave;
mod whitenoise2d;
mod worleynoise2d;

pub use page::{describe, page};

use mipless_codegen::NodeDef;
use mipless_graph::NodeSpec;

/// Every node definition, sorted by category.
static CATALOGUE: &[NodeDef] = &[
    // Input.
    constant::DEF,
    position::DEF,
    texcoord::DEF,
    // Noise.
    byexample::DEF,
    cellnoise2d::DEF,
    cellnoise3d::DEF,
    fractal2d::DEF,
    fractal3d::DEF,
    gabornoise2d::DEF,
    multifractal2d::DEF,
    noise2d::DEF,
    noise3d::DEF,
    phasornoise2d::DEF,
    randomcolor::DEF,
    randomfloat::DEF,
    ridged2d::DEF,
    spectralnoise2d::DEF,
    turbulence2d::DEF,
    unifiednoise2d::DEF,
    valuenoise2d::DEF,
    whitenoise2d::DEF,
    worleynoise2d::DEF,
    // Pattern.
    brick::DEF,
    checkerboard::DEF,
    circle::DEF,
    cloverleaf::DEF,
    crosshatch::DEF,
    gradientangular::DEF,
    gradientradial::DEF,
    grid::DEF,
    hexagon::DEF,
    image::DEF,
    line::DEF,
    ramp4::DEF,
    ramplr::DEF,
    ramptb::DEF,
    shape::DEF,
    splitlr::DEF,
    splittb::DEF,
    stripes::DEF,
    tiledcircles::DEF,
    tiledcloverleafs::DEF,
    tiledhexagons::DEF,
    wave::DEF,
    // Arithmetic.
    add::DEF,
    atan2::DEF,
    burn::DEF,
    crossproduct::DEF,
    darken::DEF,
    difference::DEF,
    distance::DEF,
    divide::DEF,
    dodge::DEF,
    dotproduct::DEF,
    hardlight::DEF,
    ifequal::DEF,
    ifgreater::DEF,
    ifgreatereq::DEF,
    lighten::DEF,
    linearlight::DEF,
    magnitude::DEF,
    max::DEF,
    min::DEF,
    minus::DEF,
    mix::DEF,
    multiply::DEF,
    normalize::DEF,
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
    blackbody::DEF,
    brightness::DEF,
    colorcorrect::DEF,
    colormap2d::DEF,
    colorramp::DEF,
    disjointover::DEF,
    hsvadjust::DEF,
    hsvtorgb::DEF,
    luminance::DEF,
    mask::DEF,
    matte::DEF,
    out::DEF,
    over::DEF,
    premult::DEF,
    r#in::DEF,
    rgbtohsv::DEF,
    saturate::DEF,
    unpremult::DEF,
    // Coordinate.
    kaleidoscope::DEF,
    mirror::DEF,
    place2d::DEF,
    polar::DEF,
    repeat::DEF,
    rotate2d::DEF,
    rotate3d::DEF,
    swirl::DEF,
    warp::DEF,
    // Channel.
    blur::DEF,
    combine2::DEF,
    combine3::DEF,
    combine4::DEF,
    convert::DEF,
    dot::DEF,
    extract::DEF,
    heighttonormal::DEF,
    normalmap::DEF,
    separate2::DEF,
    separate3::DEF,
    separate4::DEF,
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
