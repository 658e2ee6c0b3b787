//! Patterns of position, filtered by the footprint.

pub(crate) mod angle;
mod bits;
pub(crate) mod bond;
pub(crate) mod disc;
pub(crate) mod figure;
mod gradient;
pub(crate) mod harmonics;
mod instances;
pub(crate) mod measure;
pub(crate) mod pulse;
mod ramp;
pub(crate) mod random;
pub(crate) mod region;
pub(crate) mod sawtooth;
pub(crate) mod separable;
pub(crate) mod slope;
pub(crate) mod soft;
mod split;
pub(crate) mod taps;
#[cfg(test)]
mod tests;
mod tiles;
pub(crate) mod tiling;
pub(crate) mod touch;
pub(crate) mod triangle;
pub(crate) mod unless;
pub(crate) mod wall;
pub(crate) mod wanted;
mod waves;

room! {
    brick with things,
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
    gradient::ramp,
    ramp4,
    gradient::ramp_gradient,
    ramp::ramplr,
    ramp::ramptb,
    rays,
    scatter with things,
    shape,
    split::splitlr,
    split::splittb,
    stripes,
    tiles::tiledcircles,
    tiles::tiledcloverleafs,
    tiles::tiledhexagons,
    truchet,
    wave,
    weave,
}
