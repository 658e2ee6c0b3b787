//! What the noises share: hashing, the lattice kernel, and the field that a filtered source gives.

pub(crate) mod bend;
pub(crate) mod field;
pub(crate) mod gabor;
pub(crate) mod hash;
pub(crate) mod lattice;
pub(crate) mod period;
pub(crate) mod source;
pub(crate) mod spectral;
