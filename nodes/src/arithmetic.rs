//! Combinations of signals.

mod blend;
mod comparison;
mod component;
mod extremum;
mod logic;
mod matte;
mod smooth;
mod sum;
pub(crate) mod vector;
mod vectorproduct;

room! {
    sum::add,
    logic::and,
    atan2,
    blend::burn,
    vectorproduct::crossproduct,
    blend::darken,
    blend::difference,
    vector::distance,
    divide,
    blend::dodge,
    vectorproduct::dotproduct,
    blend::hardlight,
    comparison::ifequal,
    comparison::ifgreater,
    comparison::ifgreatereq,
    matte::inside,
    blend::lighten,
    blend::linearlight,
    vector::magnitude,
    extremum::max,
    component::maxcomponent,
    extremum::min,
    component::mincomponent,
    blend::minus,
    mix,
    multiply,
    normalize,
    logic::not,
    logic::or,
    matte::outside,
    blend::overlay,
    blend::plus,
    blend::screen,
    smooth::smoothmax,
    smooth::smoothmin,
    blend::softlight,
    sum::subtract,
    switch,
    logic::xor,
}
