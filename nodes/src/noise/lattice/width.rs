//! How wide the kernel is.

/// a: the width of the kernel, in cells.
pub(super) const WIDTH: f32 = 0.3854;

/// The wavelength of the dominant detail, in cells: the spectrum k⁵ e^{−a²k²} has its peak at
/// k = √2.5/a.
pub(in crate::noise) const WAVELENGTH: f32 = std::f32::consts::TAU * WIDTH / 1.581_138_8;

/// a², of the spectrum |w|⁴ e^{−a²|w|²}.
pub(in crate::noise) const AREA: f32 = WIDTH * WIDTH;
