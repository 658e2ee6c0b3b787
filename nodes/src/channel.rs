//! Components of vectors: taken apart, put together, and what the slopes of a height make.

mod combine;
mod gradient;
mod microsurface;
mod separate;

room! {
    blendnormal,
    blur,
    combine::combine2,
    combine::combine3,
    combine::combine4,
    convert,
    curvature,
    dot,
    extract,
    heightmask,
    heighttonormal,
    normalmap,
    normaltoslope,
    separate::separate2,
    separate::separate3,
    separate::separate4,
    slope,
    slopemask,
    slopetonormal,
    surface,
}
