//! What an error is measured in.

/// A number as a display shows it, to both sides of 0: normals and heights are numbers too.
pub(super) fn displayed(x: f32) -> f64 {
    let size = f64::from(x.abs().min(1.0));
    let encoded = if size <= 0.003_130_8 {
        12.92 * size
    } else {
        1.055 * size.powf(1.0 / 2.4) - 0.055
    };
    if x.is_finite() {
        encoded.copysign(f64::from(x))
    } else {
        2.0
    }
}
