//! Where a graph begins.

room! {
    constant,
    position,
    texcoord,
}
