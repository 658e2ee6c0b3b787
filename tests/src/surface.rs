//! Shaded surfaces, exactly: what the closed forms of shading are held against.
//!
//! A height field on a torus ([`Field`]) is lit facet by facet, with rays that are marched towards the
//! eye and the light ([`visible`]), and filtered exactly by Fourier's transform ([`Torus::filtered`]).
//! What a pixel sees is the mean over its facets by the area that they show to the eye (Heitz et al.
//! 2014, eq. 1, with the area of the facets):
//! G∗(f V_o V_i (n·o)⁺/n_z) / G∗(V_o (n·o)⁺/n_z). Facets do not light each other, and a pixel's filter
//! does not move with the height.

mod facet;
mod field;
mod fourier;
mod host;
mod model;
mod pixel;
mod ray;
mod torus;

pub use facet::{Direction, direction, dot, ggx, lambert};
pub use field::{Field, Kind};
pub use host::Host;
pub use model::{Model, Moments};
pub use pixel::{Averages, Lit};
pub use ray::visible;
pub use torus::Torus;
