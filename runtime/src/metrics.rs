//! How far two images are apart.

use serde::Serialize;

use crate::image::Image;
use crate::srgb::srgb_from_linear;

/// The differences of two images over all their channels, in the images' own unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Difference {
    /// The root of the mean of the squares.
    pub rms: f64,
    /// The mean of the absolute values.
    pub mean_absolute: f64,
    /// The largest absolute value.
    pub max: f64,
}

/// The difference of two images, over the pixels where `mask` holds (all, if there is none). No
/// pixels differ by 0; a number that is not finite makes the difference infinite.
///
/// # Panics
/// If the images differ in size or number of channels, or the mask in size.
pub fn difference(a: &Image, b: &Image, mask: Option<&[bool]>) -> Difference {
    difference_of(a, b, mask, |x| x)
}

/// The difference as a display shows it: both images clamped to 0 to 1 and sRGB encoded first.
///
/// # Panics
/// If the images differ in size or number of channels, or the mask in size.
pub fn display_difference(a: &Image, b: &Image, mask: Option<&[bool]>) -> Difference {
    difference_of(a, b, mask, srgb_from_linear)
}

/// The error (RMS) that one sampled truth has of its own: that of two independent ones against
/// each other over √2.
///
/// # Panics
/// If the images differ in size or number of channels, or the mask in size.
pub fn noise_floor(truth: &Image, independent_truth: &Image, mask: Option<&[bool]>) -> f64 {
    difference(truth, independent_truth, mask).rms / std::f64::consts::SQRT_2
}

fn difference_of(
    a: &Image,
    b: &Image,
    mask: Option<&[bool]>,
    transfer: impl Fn(f32) -> f32,
) -> Difference {
    assert_eq!(a.size(), b.size(), "sizes of compared images");
    assert_eq!(
        a.channels().len(),
        b.channels().len(),
        "channels of compared images"
    );
    if let Some(mask) = mask {
        assert_eq!(mask.len(), a.size().pixels(), "size of the mask");
    }
    let (mut squares, mut sum, mut max, mut count) = (0.0, 0.0, 0.0f64, 0u64);
    for (x, y) in a.channels().iter().zip(b.channels()) {
        for (index, (&x, &y)) in x.iter().zip(y).enumerate() {
            if mask.is_some_and(|mask| !mask[index]) {
                continue;
            }
            let apart = f64::from(transfer(x)) - f64::from(transfer(y));
            let apart = if apart.is_finite() {
                apart.abs()
            } else {
                f64::INFINITY
            };
            squares += apart * apart;
            sum += apart;
            max = max.max(apart);
            count += 1;
        }
    }
    let count = count.max(1) as f64;
    Difference {
        rms: (squares / count).sqrt(),
        mean_absolute: sum / count,
        max,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::Size;

    fn image(numbers: [f32; 4]) -> Image {
        Image::new(Size::new(4, 1), &["Y"], vec![numbers.to_vec()])
    }

    #[test]
    fn differences_are_those_of_the_covered_pixels() {
        let (a, b) = (image([0.0, 0.0, 0.0, 9.0]), image([3.0, 4.0, 0.0, 0.0]));
        let found = difference(&a, &b, Some(&[true, true, false, false]));
        assert_eq!(
            (found.rms, found.mean_absolute, found.max),
            (12.5f64.sqrt(), 3.5, 4.0)
        );
        assert_eq!(noise_floor(&a, &b, Some(&[true, true, false, false])), 2.5);
        assert_eq!(difference(&a, &b, Some(&[false; 4])), Difference::default());
        assert_eq!(
            difference(&a, &image([f32::NAN; 4]), None).rms,
            f64::INFINITY
        );
    }

    #[test]
    fn a_display_shows_nothing_beyond_white() {
        let (a, b) = (image([1.0, 0.0, 0.5, 2.0]), image([7.0, -3.0, 0.5, 1.0]));
        assert_eq!(display_difference(&a, &b, None).max, 0.0);
        let darker = display_difference(&image([0.1; 4]), &image([0.0; 4]), None).rms;
        assert!((darker - 0.349_19).abs() < 1e-4, "{darker}");
    }
}
