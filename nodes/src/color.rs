//! Colours: maps from numbers to them, their corrections, layers with alpha.

pub(crate) mod composite;
pub(crate) mod hsv;

room! {
    blackbody,
    brightness,
    colorcorrect,
    colormap2d,
    colorramp,
    disjointover,
    hsvadjust,
    hsvtorgb,
    luminance,
    mask,
    matte,
    out,
    over,
    premult,
    r#in,
    rgbtohsv,
    saturate,
    unpremult,
}
