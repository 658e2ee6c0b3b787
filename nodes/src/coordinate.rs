//! Maps of coordinates.

pub(crate) mod place;

room! {
    kaleidoscope,
    mirror,
    place2d,
    polar,
    repeat,
    rotate2d,
    rotate3d,
    swirl,
    transformmatrix,
    warp,
}
