//! Combinations of signals.

mod blend;
mod comparison;
mod extremum;
mod smooth;
mod sum;
pub(crate) mod vector;
mod vectorproduct;

room! {
    sum::add,
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
    blend::lighten,
    blend::linearlight,
    vector::magnitude,
    extremum::max,
    extremum::min,
    blend::minus,
    mix,
    multiply,
    normalize,
    blend::overlay,
    blend::plus,
    blend::screen,
    smooth::smoothmax,
    smooth::smoothmin,
    blend::softlight,
    sum::subtract,
    switch,
}
