//! What the noises claim of themselves, as hypothesis tests.
//!
//! All tests together have the level [`SIGNIFICANCE`]: each gets an equal part of it (Bonferroni).
//! The positions are random, uniform in a square so large that neighbours are independent, and the
//! same in every run.

use mipless::{Footprint, Method, Options, Texture};
use mipless_tests::random::Random;
use mipless_tests::tolerance::{SIGNIFICANCE, p_value};

/// A noise with the variance that its page states for an amplitude of 4 and a frequency of 1.
struct Noise {
    node: &'static str,
    parameters: &'static str,
    variance: f64,
    /// Whether it looks the same in all directions: a lattice shows through the quintic window.
    isotropic: bool,
}

const NOISES: [Noise; 9] = [
    Noise {
        node: "noise2d",
        parameters: "",
        variance: 1.0,
        isotropic: true,
    },
    // Σ (1/4)ᵏ over five octaves.
    Noise {
        node: "fractal2d",
        parameters: r#", "octaves": 5"#,
        variance: 1.332_031_25,
        isotropic: true,
    },
    // Σ (0.64)ᵏ over three octaves.
    Noise {
        node: "fractal2d",
        parameters: r#", "octaves": 3, "lacunarity": 2.7, "diminish": 0.8"#,
        variance: 2.0496,
        isotropic: true,
    },
    Noise {
        node: "spectralnoise2d",
        parameters: "",
        variance: 1.0,
        isotropic: true,
    },
    Noise {
        node: "spectralnoise2d",
        parameters: r#", "waves": 64, "bandwidth": 0.25"#,
        variance: 1.0,
        isotropic: true,
    },
    Noise {
        node: "gabornoise2d",
        parameters: "",
        variance: 1.0,
        isotropic: true,
    },
    Noise {
        node: "noise2d",
        parameters: r#", "kernel": "quintic""#,
        variance: 1.0,
        isotropic: false,
    },
    // Σ (1/4)ᵏ over three octaves, and (1/16)² for half the amplitude of a fourth one.
    Noise {
        node: "fractal2d",
        parameters: r#", "kernel": "quintic", "octaves": 3.5"#,
        variance: 1.316_406_25,
        isotropic: false,
    },
    // (181/231)²/12 of the square of the amplitude.
    Noise {
        node: "valuenoise2d",
        parameters: "",
        variance: 0.818_600_3,
        isotropic: false,
    },
];

const PIVOT: f64 = 0.375;

/// Mean and variance, three pairs of directions at most, two pairs of
/// seeds, and two pairs of octaves.
const TESTS: f64 = NOISES.len() as f64 * (2.0 + 3.0 + 2.0) + 2.0;

impl Noise {
    fn texture(&self, seed: u32) -> Texture {
        let Self {
            node, parameters, ..
        } = self;
        let text = format!(
            r#"{{ "version": 1, "name": "noise", "nodes": {{ "n": {{ "type": "{node}", "inputs":
               {{ "amplitude": 4, "pivot": {PIVOT}, "seed": {seed}{parameters} }} }} }},
               "outputs": {{ "out": {{ "node": "n" }} }} }}"#
        );
        Texture::from_json(&text).expect("the graph has no mistakes")
    }

    /// The noise less its mean, at points.
    fn sample(&self, seed: u32, points: &[[f64; 2]]) -> Vec<f64> {
        let footprint = |&[x, y]: &[f64; 2]| Footprint {
            cell: [x.floor() as i32, y.floor() as i32],
            uv: [(x - x.floor()) as f32, (y - y.floor()) as f32],
            ..Footprint::default()
        };
        let footprints: Vec<Footprint> = points.iter().map(footprint).collect();
        let options = Options {
            method: Method::Point,
            ..Options::default()
        };
        let values = self.texture(seed).evaluator(&options).evaluate(&footprints);
        values[0].iter().map(|&x| f64::from(x) - PIVOT).collect()
    }

    fn named(&self) -> String {
        format!("{}{}", self.node, self.parameters)
    }
}

fn points(seed: u64, count: usize) -> Vec<[f64; 2]> {
    let mut random = Random::new(seed);
    (0..count)
        .map(|_| [0, 1].map(|_| random.within(-30_000.0, 30_000.0)))
        .collect()
}

fn mean(numbers: &[f64]) -> f64 {
    numbers.iter().sum::<f64>() / numbers.len() as f64
}

/// Rejects that independent numbers have mean 0, at the suite's level.
fn holds_zero_mean(what: &str, numbers: &[f64]) {
    let (n, average) = (numbers.len() as f64, mean(numbers));
    let variance = numbers.iter().map(|x| (x - average).powi(2)).sum::<f64>() / (n - 1.0);
    let z = average / (variance / n).sqrt();
    let p = p_value(z);
    println!("{what}: {average:.5}, z = {z:.2}, p = {p:.2e}");
    assert!(
        p >= SIGNIFICANCE / TESTS,
        "{what}: off by {average}, z = {z}, p = {p:e}"
    );
}

#[test]
fn the_noises_have_their_mean_and_variance() {
    for (index, noise) in NOISES.iter().enumerate() {
        let values = noise.sample(17, &points(index as u64, 100_000));
        holds_zero_mean(&format!("mean of {}", noise.named()), &values);
        let squares: Vec<f64> = values.iter().map(|x| x * x - noise.variance).collect();
        holds_zero_mean(&format!("variance of {}", noise.named()), &squares);
    }
}

#[test]
fn the_noises_look_the_same_in_all_directions() {
    // One number a seed: points of one seed share its directions.
    const SEEDS: u32 = 200;
    let lag = 0.35;
    let directions = [0.0_f64, 30.0, 45.0, 90.0].map(|angle| {
        let (sin, cos) = angle.to_radians().sin_cos();
        [lag * cos, lag * sin]
    });
    for noise in &NOISES {
        let mut differences = [const { Vec::new() }; 3];
        for seed in 0..SEEDS {
            let points = points(u64::from(seed), 400);
            let values = noise.sample(seed, &points);
            let [along, others @ ..] = directions.map(|[dx, dy]| {
                let moved: Vec<[f64; 2]> = points.iter().map(|[x, y]| [x + dx, y + dy]).collect();
                let moved = noise.sample(seed, &moved);
                let squares: Vec<f64> = values
                    .iter()
                    .zip(&moved)
                    .map(|(a, b)| (a - b) * (a - b))
                    .collect();
                mean(&squares)
            });
            for (differences, other) in differences.iter_mut().zip(others) {
                differences.push(other - along);
            }
        }
        for (angle, differences) in [30, 45, 90].iter().zip(&differences) {
            if !noise.isotropic && *angle != 90 {
                continue;
            }
            holds_zero_mean(
                &format!("{angle}° against 0° of {}", noise.named()),
                differences,
            );
        }
    }
}

#[test]
fn seeds_are_independent() {
    for noise in &NOISES {
        let points = points(5, 50_000);
        let first = noise.sample(0, &points);
        for seed in [1, 65_536] {
            let products: Vec<f64> = first
                .iter()
                .zip(noise.sample(seed, &points))
                .map(|(a, b)| a * b)
                .collect();
            holds_zero_mean(
                &format!("seeds 0 and {seed} of {}", noise.named()),
                &products,
            );
        }
    }
}

#[test]
fn octaves_are_independent() {
    let octaves = [1, 2, 3].map(|count| {
        let parameters: &'static str = match count {
            1 => r#", "octaves": 1"#,
            2 => r#", "octaves": 2"#,
            _ => r#", "octaves": 3"#,
        };
        let noise = Noise {
            node: "fractal2d",
            parameters,
            variance: 0.0,
            isotropic: true,
        };
        noise.sample(3, &points(9, 50_000))
    });
    for (lower, upper) in [(0, 1), (1, 2)] {
        let pairs = octaves[lower].iter().zip(&octaves[upper]);
        let products: Vec<f64> = pairs.map(|(sum, next)| sum * (next - sum)).collect();
        holds_zero_mean(&format!("octave {} and those below", upper + 1), &products);
    }
}
