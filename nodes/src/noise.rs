//! What the noises share: hashing, the lattice kernel, and the field that a filtered source gives.

pub(crate) mod affine;
pub(crate) mod bend;
pub(crate) mod cell;
pub(crate) mod components;
pub(crate) mod field;
pub(crate) mod gabor;
pub(crate) mod hash;
pub(crate) mod jenkins;
pub(crate) mod kernel;
pub(crate) mod lattice;
pub(crate) mod layers;
pub(crate) mod octaves;
pub(crate) mod period;
pub(crate) mod perlin;
pub(crate) mod phasor;
mod remainder;
pub(crate) mod ridge;
pub(crate) mod source;
pub(crate) mod spectral;
pub(crate) mod steep;
pub(crate) mod sum;
pub(crate) mod things;
mod tile;
mod trigonometric;
pub(crate) mod volume;
mod window;
pub(crate) mod worley;

room! {
    byexample,
    cellnoise2d with things,
    cellnoise3d with things,
    fractal2d,
    fractal3d,
    gabornoise2d,
    multifractal2d,
    noise2d,
    noise3d,
    phasornoise2d,
    randomcolor,
    randomfloat,
    ridged2d,
    spectralnoise2d,
    turbulence2d,
    unifiednoise2d,
    unifiednoise3d,
    valuenoise2d,
    whitenoise2d,
    worleynoise2d with things,
    worleynoise3d,
}
