//! Patterns of position, filtered by the footprint.

pub(crate) mod angle;
pub(crate) mod bond;
pub(crate) mod pulse;
pub(crate) mod separable;
#[cfg(test)]
mod tests;
pub(crate) mod triangle;
