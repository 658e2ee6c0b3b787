//! Tiling and blending against dense numerical truth: the local standard deviation and the mean
//! over box footprints of 2² to 128² texels, and over Gaussian ones, round and 8:1 at three angles.
//!
//! Examples are sums of waves, 512² texels, 16 bits: *low*, isotropic, 100 texels long, and *high*, in
//! one direction, 20 texels long, as those of Grenier et al. 2022, Table 1, are by what their variance
//! over 2 × 2 texels says. Truth is the point function on a grid of at least 24² points in the footprint.
//! The nearest-mip estimate is Σ wᵢ Eᵢ(l) with the tiles read from the nearest texel of the mip as large
//! as the footprint, which is what Deliot & Heitz 2019 call the mean.
//!
//! `cargo bench -p mipless-tests --bench byexample`; with `-- boxes`, the box footprints alone.

use image::{ExtendedColorType, ImageEncoder};
use mipless::{Footprint, Method, Options, PixelFilter, Texture};
use mipless_graph::CheckOptions;
use mipless_tests::random::Random;
use std::collections::BTreeMap;

/// Texels of a side of the examples.
const SIDE: usize = 512;
/// Footprints for each row.
const PLACES: usize = 200;

/// An example as numbers, and the texture that it makes.
struct Example {
    name: &'static str,
    /// Relative error of σ and share of the nearest mip's error that are asked for.
    target: f64,
    numbers: Vec<f64>,
    texture: Texture,
}

/// A sum of waves with these frequencies, in cycles an example.
fn waves(
    name: &'static str,
    target: f64,
    frequencies: &[[i32; 2]],
    random: &mut Random,
) -> Example {
    let tau = std::f64::consts::TAU;
    let mut numbers = vec![0.0; SIDE * SIDE];
    for &[p, q] in frequencies {
        let phase = random.unit();
        for (i, number) in numbers.iter_mut().enumerate() {
            let (x, y) = ((i % SIDE) as f64, (i / SIDE) as f64);
            let turns = (f64::from(p) * x + f64::from(q) * y) / SIDE as f64 + phase;
            *number += (tau * turns).sin();
        }
    }
    let square = numbers.iter().map(|x| x * x).sum::<f64>() / numbers.len() as f64;
    let scale = 0.16 / square.sqrt();
    let words: Vec<u16> = (numbers.iter())
        .map(|x| ((0.5 + scale * x).clamp(0.0, 1.0) * 65535.0).round() as u16)
        .collect();
    let numbers = words
        .iter()
        .map(|&w| f64::from(w) / 65535.0 - 0.5)
        .collect();
    let bytes: Vec<u8> = words.iter().flat_map(|w| w.to_ne_bytes()).collect();
    let mut file = Vec::new();
    let side = SIDE as u32;
    image::codecs::png::PngEncoder::new(&mut file)
        .write_image(&bytes, side, side, ExtendedColorType::L16)
        .expect("a PNG");
    let files = BTreeMap::from([("example.png".to_owned(), file)]);
    let text = r#"{ "version": 1, "name": "texture",
        "nodes": { "n": { "type": "byexample", "inputs": { "file": "example.png", "signature": "float" } } },
        "outputs": { "out": { "node": "n" } } }"#;
    let texture = Texture::with_files(text, &CheckOptions::default(), &files)
        .unwrap_or_else(|mistakes| panic!("{mistakes:?}"));
    Example {
        name,
        target,
        numbers,
        texture,
    }
}

fn examples() -> [Example; 2] {
    let mut random = Random::new(7);
    let mut low = Vec::new();
    while low.len() < 24 {
        let [p, q] = [0, 1].map(|_| random.within(-9.0, 9.0).round() as i32);
        let length = f64::from(p * p + q * q).sqrt();
        if (3.5..7.0).contains(&length) && !low.contains(&[p, q]) && !low.contains(&[-p, -q]) {
            low.push([p, q]);
        }
    }
    let mut high = Vec::new();
    while high.len() < 64 {
        let wave = [
            random.within(18.0, 34.0).round() as i32,
            random.within(-14.0, 14.0).round() as i32,
        ];
        if !high.contains(&wave) {
            high.push(wave);
        }
    }
    [
        waves("low", 0.18, &low, &mut random),
        waves("high", 0.24, &high, &mut random),
    ]
}

/// The hash of the tiles, for the estimate that they make by mips.
fn scrambled(mut x: u32) -> u32 {
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// The weights of the three tiles at a place in examples, and where they read.
fn tiles([x, y]: [f64; 2]) -> [(f64, [f64; 2]); 3] {
    let (s, t) = (4.0 * x - 2.0 * y, 4.0 * y);
    let (i, j) = (s.floor(), t.floor());
    let (f, g) = (s - i, t - j);
    let corners = if f + g > 1.0 {
        [(f + g - 1.0, 1, 1), (1.0 - g, 1, 0), (1.0 - f, 0, 1)]
    } else {
        [(1.0 - f - g, 0, 0), (f, 1, 0), (g, 0, 1)]
    };
    let length = corners.iter().map(|(b, ..)| b * b).sum::<f64>().sqrt();
    corners.map(|(share, di, dj)| {
        let [i, j] = [(i as i32 + di) as u32, (j as i32 + dj) as u32];
        let first = scrambled(scrambled(i ^ 0x5bd1_e995) ^ j);
        let second = scrambled(first ^ 0x2545_f491);
        let shift = [first, second].map(|h| f64::from(h >> 8) / f64::from(1u32 << 24));
        (share / length, [x + shift[0], y + shift[1]])
    })
}

impl Example {
    /// The blend of tiles that `read` gives.
    fn blend(&self, at: [f64; 2], read: impl Fn([f64; 2]) -> f64) -> f64 {
        0.5 + tiles(at)
            .map(|(w, place)| w * read(place))
            .iter()
            .sum::<f64>()
    }

    /// The texel at (i, j), in repetition.
    fn texel(&self, i: i64, j: i64) -> f64 {
        let n = SIDE as i64;
        self.numbers[(j.rem_euclid(n) * n + i.rem_euclid(n)) as usize]
    }

    fn bilinear(&self, place: [f64; 2]) -> f64 {
        let [x, y] = place.map(|x| x * SIDE as f64 - 0.5);
        let (i, j) = (x.floor(), y.floor());
        let (f, g) = (x - i, y - j);
        let (i, j) = (i as i64, j as i64);
        let row = |j| self.texel(i, j) * (1.0 - f) + self.texel(i + 1, j) * f;
        row(j) * (1.0 - g) + row(j + 1) * g
    }

    /// The average over the texel of the mip of so many texels a side.
    fn nearest(&self, place: [f64; 2], size: i64) -> f64 {
        let [i, j] = place.map(|x| (x * SIDE as f64).floor() as i64 & !(size - 1));
        let all = (0..size * size).map(|k| self.texel(i + k % size, j + k / size));
        all.sum::<f64>() / (size * size) as f64
    }

    /// Means, then variances.
    fn evaluate(&self, method: Method, filter: PixelFilter, at: &[Footprint]) -> [Vec<f64>; 2] {
        let options = Options {
            method,
            filter,
            moments: true,
            seed: 0,
        };
        let out = self.texture.evaluator(&options).evaluate(at);
        [0, 1].map(|i| out[i].iter().map(|&x| f64::from(x)).collect())
    }

    /// Mean and variance of the point function over weighted offsets from each place.
    fn truth(&self, places: &[[f64; 2]], grid: &[([f64; 2], f64)]) -> Vec<[f64; 2]> {
        let total: f64 = grid.iter().map(|(_, w)| w).sum();
        let one = |place: &[f64; 2]| {
            let at: Vec<Footprint> = (grid.iter())
                .map(|(o, _)| footprint([place[0] + o[0], place[1] + o[1]], [[0.0; 2]; 2]))
                .collect();
            let [values, _] = self.evaluate(Method::Point, PixelFilter::Box, &at);
            let all = values.iter().zip(grid);
            let mean = all.clone().map(|(v, (_, w))| v * w).sum::<f64>() / total;
            let spread = all.map(|(v, (_, w))| w * (v - mean).powi(2)).sum::<f64>() / total;
            [mean, spread]
        };
        places.iter().map(one).collect()
    }
}

fn footprint(place: [f64; 2], axes: [[f64; 2]; 2]) -> Footprint {
    Footprint {
        cell: place.map(|x| x.floor() as i32),
        uv: place.map(|x| (x - x.floor()) as f32),
        du: axes[0].map(|x| x as f32),
        dv: axes[1].map(|x| x as f32),
    }
}

/// The mean errors of the mean (absolute) and of σ (relative to its mean).
fn errors(found: &[Vec<f64>; 2], truth: &[[f64; 2]]) -> [f64; 2] {
    let (mut mean, mut spread, mut size) = (0.0, 0.0, 0.0);
    for (i, [m, v]) in truth.iter().enumerate() {
        mean += (found[0][i] - m).abs();
        spread += (found[1][i].max(0.0).sqrt() - v.sqrt()).abs();
        size += v.sqrt();
    }
    [mean / truth.len() as f64, spread / size]
}

fn boxes(example: &Example, places: &[[f64; 2]]) -> bool {
    println!("\n{}: box footprints\n", example.name);
    println!("| texels | σ, relative error | target | mean, of the nearest mip's error | target |");
    println!("|---|---|---|---|---|");
    let mut held = true;
    for size in [2_i64, 4, 8, 16, 32, 64, 128] {
        let side = size as f64 / SIDE as f64;
        let n = size.clamp(24, 64);
        let along = |k: i64| side * ((k as f64 + 0.5) / n as f64 - 0.5);
        let grid: Vec<_> = (0..n * n)
            .map(|k| ([along(k % n), along(k / n)], 1.0))
            .collect();
        let truth = example.truth(places, &grid);
        let axes = [[side, 0.0], [0.0, side]];
        let at: Vec<Footprint> = places.iter().map(|&p| footprint(p, axes)).collect();
        let found = example.evaluate(Method::Local, PixelFilter::Box, &at);
        let [mean, spread] = errors(&found, &truth);
        let nearest = |p: &[f64; 2]| example.blend(*p, |place| example.nearest(place, size));
        let mips: Vec<f64> = places.iter().map(nearest).collect();
        let of_mips = errors(&[mips, vec![0.0; PLACES]], &truth)[0];
        let share = mean / of_mips;
        let wanted = if size <= 32 { "≤ 0.5" } else { "–" };
        held &= spread <= example.target && (size > 32 || share <= 0.5);
        println!(
            "| {size}² | {spread:.3} | ≤ {} | {share:.3} ({mean:.5}/{of_mips:.5}) | {wanted} |",
            example.target
        );
    }
    held
}

fn gaussians(example: &Example, places: &[[f64; 2]]) {
    println!("\n{}: Gaussian footprints, σ across\n", example.name);
    println!("| σ, texels | shape | σ, relative error | mean, of 0.16 |");
    println!("|---|---|---|---|");
    for (ratio, degrees) in [(1.0, 0.0f64), (8.0, 0.0), (8.0, 20.0), (8.0, 45.0)] {
        for sigma in [0.3, 0.6, 1.2, 2.5, 5.0, 10.0, 20.0, 40.0] {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let (long, wide) = (ratio * sigma / SIDE as f64, sigma / SIDE as f64);
            let axes = [[long * cosine, long * sine], [-wide * sine, wide * cosine]];
            let step = |sigma: f64| 25 + (9.0 * sigma / 3.0) as usize;
            let (m, n) = (step(ratio * sigma).min(161), step(sigma).min(65));
            let mut grid = Vec::new();
            for i in 0..m * n {
                let z =
                    [(i % m, m), (i / m, n)].map(|(k, n)| 9.0 * (k as f64 + 0.5) / n as f64 - 4.5);
                let offset = [0, 1].map(|k| axes[0][k] * z[0] + axes[1][k] * z[1]);
                grid.push((offset, (-0.5 * (z[0] * z[0] + z[1] * z[1])).exp()));
            }
            let places = &places[..PLACES / 4];
            let truth = example.truth(places, &grid);
            let at: Vec<Footprint> = places.iter().map(|&p| footprint(p, axes)).collect();
            let found = example.evaluate(Method::Local, PixelFilter::Gaussian(1.0), &at);
            let [mean, spread] = errors(&found, &truth);
            let shape = if ratio > 1.0 {
                format!("8:1 at {degrees}°")
            } else {
                "round".to_owned()
            };
            println!("| {sigma} | {shape} | {spread:.3} | {:.3} |", mean / 0.16);
        }
    }
}

fn main() {
    // `cargo test --benches` runs benchmarks as well: then a look at one size is enough.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    let mut random = Random::new(3);
    let places: Vec<[f64; 2]> = (0..PLACES)
        .map(|_| [random.within(-20.0, 20.0), random.within(-20.0, 20.0)])
        .collect();
    let mut held = true;
    for example in &examples() {
        // The tiles of the estimate by mips are those of the node.
        let at: Vec<Footprint> = places
            .iter()
            .map(|&p| footprint(p, [[0.0; 2]; 2]))
            .collect();
        let [values, _] = example.evaluate(Method::Point, PixelFilter::Box, &at);
        for (place, value) in places.iter().zip(values) {
            let own = example.blend(*place, |place| example.bilinear(place));
            // By ranks the example is Gaussian; as it is, it is so nearly.
            assert!((own - value).abs() < 0.05, "{own} for {value}");
        }
        held &= boxes(example, &places);
        if !std::env::args().any(|argument| argument == "boxes") {
            gaussians(example, &places);
        }
    }
    println!("\nTargets: {}", if held { "held" } else { "missed" });
}
