//! Pictures as fields that know their moments: a pyramid of means and covariances, read for any
//! footprint.

pub(crate) mod example;
pub(crate) mod footprint;
pub(crate) mod gather;
pub(crate) mod planes;
pub(crate) mod port;
pub(crate) mod pyramid;
pub(crate) mod read;
pub(crate) mod texels;
pub(crate) mod tiling;
