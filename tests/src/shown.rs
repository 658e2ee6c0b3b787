//! What a display shows of a texture, limited to 0 to 1 and sRGB: its wavelength, its truth on pixels,
//! and how far values are from each other.

use crate::random::Random;
use mipless::{Footprint, Method, Options, Texture, TextureEvaluator};
use mipless_runtime::srgb::srgb_from_linear;
use std::f64::consts::TAU;

/// A graph whose values spread less over its places shows nothing.
pub const VISIBLE: f64 = 0.01;

/// What a display shows of values.
pub fn shown(values: Vec<Vec<f32>>) -> Vec<Vec<f64>> {
    let of = |values: Vec<f32>| {
        let show = |x: f32| f64::from(srgb_from_linear(x));
        values.into_iter().map(show).collect()
    };
    values.into_iter().map(of).collect()
}

/// The values of all components at pixels.
pub fn evaluate(texture: &Texture, method: Method, seed: u32, at: &[Footprint]) -> Vec<Vec<f32>> {
    evaluator(texture, method, seed).evaluate(at)
}

fn evaluator(texture: &Texture, method: Method, seed: u32) -> TextureEvaluator {
    texture.evaluator(&Options {
        method,
        seed,
        ..Options::default()
    })
}

/// The variance over all components together, each about its own mean.
pub fn variance(values: &[Vec<f64>]) -> f64 {
    let of = |values: &Vec<f64>| {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n
    };
    values.iter().map(of).sum::<f64>() / values.len() as f64
}

/// The root mean square of the differences.
pub fn rms(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    let (sum, count) = pairs.fold((0.0, 0.0), |(sum, count), (a, b)| {
        (sum + (a - b).powi(2), count + 1.0)
    });
    (sum / f64::max(count, 1.0)).sqrt()
}

/// The wavelength of what a graph shows: six times the least distance at which its values are
/// correlated by a half, as a cosine's are at a sixth of its wavelength. `None` if it shows nothing.
pub fn wavelength(texture: &Texture) -> Option<f64> {
    let mut random = Random::new(3);
    let places: Vec<([f64; 2], f64)> = (0..384)
        .map(|_| {
            let place = [0, 1].map(|_| random.within(-8.0, 8.0));
            (place, TAU * random.unit())
        })
        .collect();
    let mut point = evaluator(texture, Method::Point, 0);
    let mut values = |distance: f64| {
        let moved: Vec<Footprint> = (places.iter())
            .map(|([x, y], angle)| {
                Footprint::point([x + distance * angle.cos(), y + distance * angle.sin()])
            })
            .collect();
        shown(point.evaluate(&moved))
    };
    let start = values(0.0);
    let spread = variance(&start);
    if spread.sqrt() < VISIBLE {
        return None;
    }
    let distances = (-28..=6).map(|k| 2.0_f64.powf(0.5 * f64::from(k)));
    let half = distances
        .map(|distance| (distance, rms(&start, &values(distance)).powi(2)))
        .find(|&(_, difference)| difference >= spread);
    Some(half.map_or(8.0, |(distance, _)| 6.0 * distance))
}

/// Two independent truths.
pub fn truths(texture: &Texture, samples: u32, pixels: &[Footprint]) -> [Vec<Vec<f32>>; 2] {
    [1, 2].map(|seed| evaluate(texture, Method::Supersample(samples), seed, pixels))
}

/// The mean of two truths.
pub fn mean([a, b]: &[Vec<Vec<f64>>; 2]) -> Vec<Vec<f64>> {
    let of = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect();
    a.iter().zip(b).map(of).collect()
}
