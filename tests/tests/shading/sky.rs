//! Light from all sides.

use mipless_codegen::shade::{Hiding, Lighting};
use mipless_tests::random::Random;
use mipless_tests::surface::{Direction, Model, Moments, direction, dot};

/// The irradiance, over π, of a sky of radiance c₀ + c₁ x + … (see `Sky`), by direction.
fn irradiance(sky: &[f64], [x, y, z]: Direction) -> f64 {
    let second = [x * y, y * z, z * x, z * z - 1.0 / 3.0, x * x - y * y];
    let first: f64 = [x, y, z].iter().zip(&sky[1..4]).map(|(n, c)| n * c).sum();
    let second: f64 = second.iter().zip(&sky[4..9]).map(|(n, c)| n * c).sum();
    sky[0] + 2.0 / 3.0 * first + 0.25 * second
}

#[test]
fn skies_light_the_slopes_that_are_seen() {
    let model = Model::new(&Lighting::Sky.module(Hiding::Facets));
    let mut random = Random::new(11);
    let (mut squares, mut count) = (0.0, 0.0);
    for _ in 0..300 {
        let sky: Vec<f64> = (0..9)
            .map(|k| {
                if k == 0 {
                    1.0
                } else {
                    random.within(-0.4, 0.4)
                }
            })
            .collect();
        let (sigma, ratio) = (random.within(0.1, 1.0), random.within(0.3, 1.0));
        let (tilt, turn) = (random.within(0.0, 0.5), random.within(0.0, 3.0));
        let view = direction(random.within(0.0, 80.0), random.within(0.0, 360.0));
        let m = [tilt * turn.cos(), tilt * turn.sin()];
        let (major, minor) = (sigma * sigma, (sigma * ratio).powi(2));
        let (sin, cos) = (2.0 * turn).sin_cos();
        let s = [
            0.5 * (major * (1.0 + cos * cos) + minor * sin * sin),
            0.5 * (major - minor) * sin * cos,
            0.5 * (major * sin * sin + minor * (1.0 + cos * cos)),
        ];
        let truth = seen_irradiance(&sky, view, m, s);
        let mut white = Moments::flat(1);
        white.set("slope_mean", &m.map(|x| vec![x]));
        white.set("slope_covariance", &s.map(|x| vec![x]));
        let mut black = white.clone();
        black.fill("base_color", 0.0);
        let arguments: Vec<f64> = view
            .into_iter()
            .chain(sky.iter().flat_map(|&c| [c; 3]))
            .collect();
        let [of, without] =
            [&white, &black].map(|moments| model.evaluate(moments, &arguments)[0][0]);
        let open = 1.0 / (1.0 + 0.173 * (0.5 * (s[0] + s[2])).powf(0.722));
        squares += ((of - without) / open - truth).powi(2);
        count += 1.0;
    }
    let rms = (squares / f64::from(300)).sqrt();
    println!("irradiance: {rms:.4} of 1 in {count} skies");
    assert!(rms <= 0.01, "{rms}");
}

/// The mean irradiance of facets with slopes N(m, S) by the area that they show, by a dense sum.
fn seen_irradiance(sky: &[f64], view: Direction, m: [f64; 2], s: [f64; 3]) -> f64 {
    let x = s[0].sqrt();
    let tilt = s[1] / x;
    let y = (s[2] - tilt * tilt).sqrt();
    let (mut sum, mut area) = (0.0, 0.0);
    for i in -50..=50 {
        for j in -50..=50 {
            let [a, b] = [i, j].map(|k| f64::from(k) * 0.1);
            let slope = [m[0] + x * a, m[1] + tilt * a + y * b];
            let length = (1.0 + slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
            let normal = [-slope[0] / length, -slope[1] / length, 1.0 / length];
            let weight = (-0.5 * (a * a + b * b)).exp() * (dot(normal, view) * length).max(0.0);
            sum += weight * irradiance(sky, normal);
            area += weight;
        }
    }
    sum / area
}
