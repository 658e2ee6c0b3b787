//! Colours: maps from numbers to them, their corrections, layers with alpha.

mod alpha;
mod composite;
pub(crate) mod hsv;
mod srgb;
pub(crate) mod stops;

room! {
    blackbody,
    brightness,
    colorcorrect,
    colormap2d,
    colorramp,
    disjointover,
    hsvadjust,
    hsvtorgb,
    srgb::lineartosrgb,
    luminance,
    composite::mask,
    composite::matte,
    composite::out,
    composite::over,
    alpha::premult,
    composite::r#in,
    rgbtohsv,
    saturate,
    srgb::srgbtolinear,
    alpha::unpremult,
}
