//! Patterns of position, filtered by the footprint.

pub(crate) mod angle;
mod bits;
pub(crate) mod bond;
pub(crate) mod figure;
pub(crate) mod harmonics;
pub(crate) mod measure;
pub(crate) mod pulse;
pub(crate) mod random;
pub(crate) mod region;
pub(crate) mod sawtooth;
pub(crate) mod separable;
pub(crate) mod slope;
pub(crate) mod soft;
pub(crate) mod taps;
#[cfg(test)]
mod tests;
pub(crate) mod tiling;
pub(crate) mod touch;
pub(crate) mod triangle;
pub(crate) mod wall;
pub(crate) mod wanted;

room! {
    brick,
    checkerboard,
    circle,
    cloverleaf,
    crosshatch,
    gradientangular,
    gradientradial,
    grid,
    hexagon,
    image,
    line,
    ramp4,
    ramplr,
    ramptb,
    shape,
    splitlr,
    splittb,
    stripes,
    tiledcircles,
    tiledcloverleafs,
    tiledhexagons,
    wave,
}
