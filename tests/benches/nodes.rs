//! What filtering costs by node: the example of every node's page, by `point` and by `local`.
//!
//! `cargo bench -p mipless-tests --bench nodes [-- NAME…]` prints Markdown: nanoseconds a pixel on one
//! core of the CPU by `point`, and how many times that `local` takes under footprints of three sizes.

use mipless::{Footprint, Method, Options};
use mipless_tests::case::{Case, examples};
use mipless_tests::timing::fastest;

/// The sides of the pixels, in units of texture space.
const PIXELS: [f32; 3] = [1.0 / 512.0, 1.0 / 32.0, 1.0];
/// The window consists of square tiles, scattered over a unit of texture space: what a device or the
/// CPU takes together is together in texture space.
const TILES: usize = 24;
/// The pixels along the side of a tile.
const SIDE: usize = 11;
/// The fastest of this many runs counts.
const RUNS: usize = 40;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.iter().any(|argument| argument == "--test") {
        return;
    }
    let wanted: Vec<&String> = arguments.iter().filter(|a| !a.starts_with('-')).collect();
    println!("| node | point, ns | local/point at 1/512 | 1/32 | 1 |\n|---|---:|---:|---:|---:|");
    let mut all = Vec::new();
    for case in examples() {
        let name = case.name.trim_start_matches("example_");
        if !wanted.is_empty() && !wanted.iter().any(|w| *w == name) {
            continue;
        }
        let (point, ratios) = measure(&case);
        all.extend(ratios);
        let [near, middle, far] = ratios;
        println!("| {name} | {point:.0} | {near:.2} | {middle:.2} | {far:.2} |");
    }
    all.sort_by(f64::total_cmp);
    match all.get(all.len() / 2) {
        Some(median) => println!("| median | | {median:.2} | | |"),
        None => println!("\nno node has that name"),
    }
}

/// Nanoseconds a pixel by `point`, and `local` relative to it under each size of pixel.
fn measure(case: &Case) -> (f64, [f64; PIXELS.len()]) {
    let programs = [Method::Point, Method::Local].map(|method| {
        case.texture.compile(&Options {
            method,
            ..Options::default()
        })
    });
    let mut point = f64::INFINITY;
    let ratios = PIXELS.map(|pixel| {
        let [alone, filtered] = fastest(&programs, &footprints(pixel), RUNS);
        point = point.min(alone);
        filtered / alone
    });
    (point * 1e9 / (TILES * SIDE * SIDE) as f64, ratios)
}

fn footprints(pixel: f32) -> Vec<Footprint> {
    (0..TILES * SIDE * SIDE)
        .map(|i| {
            let (tile, at) = (i / (SIDE * SIDE), i % (SIDE * SIDE));
            // The R2 sequence.
            let corner = [0.754_877_7, 0.569_840_3].map(|step| (tile as f32 * step).fract());
            let at = [at % SIDE, at / SIDE].map(|at| (at as f32 + 0.5) * pixel);
            Footprint {
                cell: [0; 2],
                uv: [corner[0] + at[0], corner[1] + at[1]],
                du: [pixel, 0.0],
                dv: [0.0, pixel],
            }
        })
        .collect()
}
