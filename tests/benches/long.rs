//! Long footprints and the far field: how far `auto` is from the truth under pixels that are 1, 8
//! and 30 times as long as wide and askew, and how far the mean of a frame is off far away.
//!
//! `cargo bench -p mipless-tests --bench long [-- GRAPH.json…]` prints Markdown; without graphs it
//! looks at all of `graphs/`.
//!
//! Errors are the root mean square over pixels of a quarter to four wavelengths (the mean of the two
//! axes), of what a display shows. The bias is that of the mean over a frame, of pixels of 4, 16 and
//! 64 wavelengths, the largest of the components.

use mipless::{Footprint, Method, Texture};
use mipless_tests::case::load;
use mipless_tests::case::means;
use mipless_tests::random::Random;
use mipless_tests::root;
use mipless_tests::shown::{evaluate, mean, rms, shown, truths, wavelength};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// How much longer pixels are than wide, and the turn of the long axis, as a cosine and a sine.
const RATIOS: [f64; 3] = [1.0, 8.0, 30.0];
const ASKEW: [f64; 2] = [0.819_152, 0.573_576];
/// Pixels, in wavelengths: the geometric mean of their axes.
const BAND: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];
const FAR: [f64; 3] = [4.0, 16.0, 64.0];
/// Pixels of each size.
const PIXELS: usize = 96;
/// Samples of each of the two truths.
const SAMPLES: u32 = 1024;

/// What is measured of a graph under pixels of one ratio.
#[derive(Clone, Copy)]
struct Row {
    ratio: f64,
    auto: f64,
    point: f64,
    biases: [f64; FAR.len()],
}

fn main() {
    let given: Vec<PathBuf> = env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .map(PathBuf::from)
        .collect();
    let paths = if given.is_empty() { all() } else { given };
    let rows: Vec<(String, Vec<Row>)> = (paths.par_iter())
        .filter_map(|path| {
            let name = path.file_stem()?.to_string_lossy().into_owned();
            Some((name, measured(path)?))
        })
        .collect();
    println!("| graph | ratio | auto | point | bias at 4 | at 16 | at 64 |");
    println!("|---|---|---|---|---|---|---|");
    for (name, rows) in &rows {
        for row in rows {
            let [a, b, c] = row.biases;
            println!(
                "| {name} | {} | {:.4} | {:.4} | {a:.4} | {b:.4} | {c:.4} |",
                row.ratio, row.auto, row.point
            );
        }
    }
    println!("\n| ratio | median | worst | median bias | worst bias |\n|---|---|---|---|---|");
    for (i, ratio) in RATIOS.into_iter().enumerate() {
        let [median, worst] = extremes(rows.iter().map(|(_, rows)| rows[i].auto));
        let [bias, largest] = extremes(rows.iter().flat_map(|(_, rows)| rows[i].biases));
        println!("| {ratio} | {median:.4} | {worst:.4} | {bias:.4} | {largest:.4} |");
    }
}

/// The median and the largest.
fn extremes(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let at = |place: usize| values.get(place).copied().unwrap_or(0.0);
    [at(values.len() / 2), at(values.len().saturating_sub(1))]
}

fn all() -> Vec<PathBuf> {
    let entries = fs::read_dir(root().join("graphs")).expect("the folder of graphs");
    let mut paths: Vec<PathBuf> = entries
        .map(|entry| entry.expect("an entry of the folder of graphs").path())
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .collect();
    paths.sort();
    paths
}

/// `None` if a graph shows nothing.
fn measured(path: &Path) -> Option<Vec<Row>> {
    let texture = Texture::from_file(path)
        .or_else(|_| load(&fs::read_to_string(path).expect("a graph")))
        .unwrap_or_else(|mistakes| panic!("{}: {mistakes:?}", path.display()));
    let texture = means(&texture);
    let wavelength = wavelength(&texture)?;
    let of = |ratio| {
        let band = pixels(&BAND, wavelength, ratio);
        let truth = mean(&truths(&texture, SAMPLES, &band).map(shown));
        let error = |method| rms(&shown(evaluate(&texture, method, 0, &band)), &truth);
        Row {
            ratio,
            auto: error(Method::Auto),
            point: error(Method::Point),
            biases: FAR.map(|size| bias(&texture, &pixels(&[size], wavelength, ratio))),
        }
    };
    Some(RATIOS.map(of).to_vec())
}

fn bias(texture: &Texture, frame: &[Footprint]) -> f64 {
    let truth = mean(&truths(texture, SAMPLES, frame).map(shown));
    let found = shown(evaluate(texture, Method::Auto, 0, frame));
    let average = |values: &Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
    let biases = (found.iter().zip(&truth)).map(|(a, b)| (average(a) - average(b)).abs());
    biases.fold(0.0, f64::max)
}

fn pixels(sizes: &[f64], wavelength: f64, ratio: f64) -> Vec<Footprint> {
    let mut random = Random::new(4);
    let mut all = Vec::new();
    for size in sizes {
        let [long, narrow] = [ratio.sqrt(), 1.0 / ratio.sqrt()].map(|by| by * size * wavelength);
        for _ in 0..PIXELS {
            let reach = (20.0 * wavelength).max(8.0).max(PIXELS as f64 * long);
            let [x, y] = [0, 1].map(|_| random.within(-reach, reach));
            let [cos, sin] = ASKEW;
            all.push(Footprint {
                du: [long * cos, long * sin].map(|x| x as f32),
                dv: [-narrow * sin, narrow * cos].map(|x| x as f32),
                ..Footprint::point([x, y])
            });
        }
    }
    all
}
