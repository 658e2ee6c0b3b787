//! The catalogue of nodes: one file each.
