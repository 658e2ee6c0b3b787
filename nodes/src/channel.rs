//! Components of vectors: taken apart, put together, and what the slopes of a height make.

pub(crate) mod separate;

room! {
    blur,
    combine2,
    combine3,
    combine4,
    convert,
    dot,
    extract,
    heighttonormal,
    normalmap,
    separate2,
    separate3,
    separate4,
}
