//! Combinations of signals.

pub(crate) mod blend;
pub(crate) mod condition;
pub(crate) mod vector;

room! {
    add,
    atan2,
    burn,
    crossproduct,
    darken,
    difference,
    distance,
    divide,
    dodge,
    dotproduct,
    hardlight,
    ifequal,
    ifgreater,
    ifgreatereq,
    lighten,
    linearlight,
    magnitude,
    max,
    min,
    minus,
    mix,
    multiply,
    normalize,
    overlay,
    plus,
    screen,
    smoothmax,
    smoothmin,
    softlight,
    subtract,
    switch,
}
