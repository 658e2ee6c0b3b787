//! The sRGB transfer function (IEC 61966-2-1), for numbers from 0 to 1.

/// The sRGB number of a linear one. Numbers outside 0 to 1 are clamped; a NaN stays
/// a NaN.
pub fn srgb_from_linear(linear: f32) -> f32 {
    let x = f64::from(linear.clamp(0.0, 1.0));
    // In f64, so that white is exactly 1 after rounding.
    (if x <= 0.003_130_8 {
        12.92 * x
    } else {
        1.055 * x.powf(1.0 / 2.4) - 0.055
    }) as f32
}

/// The linear number of an sRGB one from 0 to 1.
pub fn linear_from_srgb(srgb: f32) -> f32 {
    if srgb <= 0.040_45 {
        srgb / 12.92
    } else {
        ((srgb + 0.055) / 1.055).powf(2.4)
    }
}

/// The same with more digits.
#[cfg(feature = "files")]
pub(crate) fn linear_in_f64(srgb: f64) -> f64 {
    if srgb <= 0.040_45 {
        srgb / 12.92
    } else {
        ((srgb + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_are_inverse_and_total() {
        for i in 0..=255u8 {
            let srgb = f32::from(i) / 255.0;
            let back = srgb_from_linear(linear_from_srgb(srgb));
            assert!((back - srgb).abs() < 1e-5, "{i}: {back}");
        }
        assert_eq!(
            [-1.0, 0.0, 1.0, 2.0].map(srgb_from_linear),
            [0.0, 0.0, 1.0, 1.0]
        );
        assert!(srgb_from_linear(f32::NAN).is_nan());
    }
}
