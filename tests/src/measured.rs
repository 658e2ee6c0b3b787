//! How far `auto` and `point` are from the truth of a graph, over pixels of the sizes at which filters
//! matter.
//!
//! The truth of a pixel is the mean of two independent ones of many samples, their own error that of
//! the two against each other over √2. Errors are the root mean square over pixels and components, of
//! what a display shows: limited to 0 to 1, and sRGB.

use crate::random::Random;
use crate::shown::{evaluate, mean, rms, shown, truths, variance};
use mipless::{Footprint, Method, Texture};
use std::f64::consts::SQRT_2;

/// Pixels, in wavelengths.
const BAND: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];
/// The pixels of the frame far away, in wavelengths.
const FAR: f64 = 64.0;

/// By how many numbers a graph is measured.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Pixels of each size.
    pub pixels: usize,
    /// Samples of each of the two truths.
    pub samples: u32,
}

/// The errors of a graph in its band.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// Of `auto`.
    pub auto: f64,
    /// Of `point`.
    pub point: f64,
    /// Of the truth.
    pub floor: f64,
}

impl Measured {
    /// The errors over pixels of a quarter to four wavelengths.
    pub fn of(texture: &Texture, wavelength: f64, effort: Effort) -> Self {
        let band = band(wavelength, effort);
        let truths = truths(texture, effort.samples, &band).map(shown);
        let truth = mean(&truths);
        let error = |method| rms(&shown(evaluate(texture, method, 0, &band)), &truth);
        Self {
            auto: error(Method::Auto),
            point: error(Method::Point),
            floor: rms(&truths[0], &truths[1]) / SQRT_2,
        }
    }

    /// By how much `auto` is worse than `point`, beyond what the truth knows.
    pub fn excess(&self) -> f64 {
        self.auto - self.point - self.floor
    }
}

/// |mean of `auto` − mean of the truth| over a frame of pixels of 64 wavelengths, as a display shows
/// them; the largest of the components. The means are those of the values themselves: shown one by
/// one, truths of a mean of 0 are off by what their own noise is above 0.
pub fn far_bias(texture: &Texture, wavelength: f64, effort: Effort) -> f64 {
    let frame = pixels(&[FAR, FAR], wavelength, effort);
    let exact = |values: Vec<Vec<f32>>| -> Vec<Vec<f64>> {
        let of = |values: Vec<f32>| values.into_iter().map(f64::from).collect();
        values.into_iter().map(of).collect()
    };
    let truth = mean(&truths(texture, effort.samples, &frame).map(exact));
    let far = exact(evaluate(texture, Method::Auto, 0, &frame));
    let average = |values: &[Vec<f64>]| {
        let of = |values: &Vec<f64>| (values.iter().sum::<f64>() / values.len() as f64) as f32;
        shown(vec![values.iter().map(of).collect()]).swap_remove(0)
    };
    let biases = average(&far).into_iter().zip(average(&truth));
    biases.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The error of `auto` over a band, relative to the spread of the values there; `None` where it is
/// no number.
pub fn relative(texture: &Texture, band: &[Footprint], effort: Effort) -> Option<f64> {
    let exact = |values: Vec<Vec<f32>>| -> Vec<Vec<f64>> {
        let of = |values: Vec<f32>| values.into_iter().map(f64::from).collect();
        values.into_iter().map(of).collect()
    };
    let spread = variance(&exact(evaluate(texture, Method::Point, 0, band))).sqrt();
    let truth = mean(&truths(texture, effort.samples, band).map(exact));
    let found = exact(evaluate(texture, Method::Auto, 0, band));
    let error = rms(&found, &truth) / spread.max(1e-6);
    error.is_finite().then_some(error)
}

/// Pixels of a quarter to four wavelengths.
pub fn band(wavelength: f64, effort: Effort) -> Vec<Footprint> {
    pixels(&BAND, wavelength, effort)
}

/// Pixels of some sizes at random places, a third of them eight times as long as wide and askew.
fn pixels(sizes: &[f64], wavelength: f64, effort: Effort) -> Vec<Footprint> {
    let mut random = Random::new(4);
    let mut all = Vec::new();
    for size in sizes {
        let size = (size * wavelength) as f32;
        for pixel in 0..effort.pixels {
            let reach = 20.0 * wavelength.max(0.4);
            let [x, y] = [0, 1].map(|_| random.within(-reach, reach));
            let (du, dv) = if pixel % 3 == 2 {
                let narrow = size / 8.0;
                ([0.8 * size, 0.6 * size], [-0.6 * narrow, 0.8 * narrow])
            } else {
                ([size, 0.0], [0.0, size])
            };
            all.push(Footprint {
                du,
                dv,
                ..Footprint::point([x, y])
            });
        }
    }
    all
}
