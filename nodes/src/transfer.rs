//! Functions of one signal, and of what shapes them.

pub(crate) mod arc;
mod rounding;
mod schlick;
mod sines;
mod waves;

room! {
    absval,
    arc::acos,
    arc::asin,
    arc::atan,
    schlick::bias,
    rounding::ceil,
    clamp,
    contrast,
    sines::cos,
    exp,
    rounding::floor,
    waves::fract,
    schlick::gain,
    invert,
    levels,
    ln,
    modulo,
    power,
    quantize with steps,
    range,
    remap,
    rounding::round,
    safepower,
    sign,
    sines::sin,
    smoothstep,
    sqrt,
    squarewave,
    step,
    tan,
    waves::trianglewave,
}
