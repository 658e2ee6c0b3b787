//! The noise ladder: one noise through one map, footprints from 0.01 to 0.8 wavelengths.
//!
//! `cargo bench -p mipless-tests --bench ladder [-- MAP…]` prints Markdown: the RMS error of each method over
//! the footprints and three seeds, in thousandths of the map's range, against 4096 samples a pixel.

use mipless::{Footprint, Method, Options, PixelFilter, Texture};
use mipless_codegen::cpu::{Evaluator, Scratch};
use rayon::prelude::*;

/// Standard deviations of the footprint, in wavelengths.
const SIZES: [f32; 9] = [0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.35, 0.5, 0.8];
/// The noises' seeds.
const SEEDS: [u32; 3] = [0, 1, 2];
/// Pixels of each seed.
const PIXELS: usize = 700;
const METHODS: [Method; 8] = [
    Method::Naive,
    Method::Ensemble,
    Method::Local,
    Method::Quad,
    Method::Auto,
    Method::Split(4),
    Method::Split(7),
    Method::Split(16),
];

/// Name, the map's node `o` (with what it needs) over the noise `n`, and its range.
const MAPS: [(&str, &str, f32); 8] = [
    (
        "smooth: ½ + ½ sin 2x",
        r#""s":{"type":"multiply","inputs":{"in1":{"node":"n"},"in2":2}},"o":{"type":"sin","inputs":{"in":{"node":"s"}}}"#,
        2.0,
    ),
    (
        "smoothstep from −2 to 2",
        r#""o":{"type":"smoothstep","inputs":{"in":{"node":"n"},"low":-2,"high":2}}"#,
        1.0,
    ),
    (
        "smoothstep from −1.5 to 1.5",
        r#""o":{"type":"smoothstep","inputs":{"in":{"node":"n"},"low":-1.5,"high":1.5}}"#,
        1.0,
    ),
    (
        "smooth: ½ + ½ sin x",
        r#""o":{"type":"sin","inputs":{"in":{"node":"n"}}}"#,
        2.0,
    ),
    (
        "ramp",
        r#""o":{"type":"colorramp","inputs":{"in":{"node":"n"},"stops":[{"at":-1,"value":0},{"at":1,"value":1}]}}"#,
        1.0,
    ),
    (
        "1 step",
        r#""o":{"type":"step","inputs":{"in":{"node":"n"},"edge":0.3}}"#,
        1.0,
    ),
    (
        "4 steps",
        r#""o":{"type":"colorramp","inputs":{"in":{"node":"n"},"interpolation":"constant","stops":[{"at":-2,"value":0},{"at":-1,"value":1},{"at":-0.3,"value":0},{"at":0.4,"value":1},{"at":1.1,"value":0}]}}"#,
        1.0,
    ),
    (
        "sin(5 abs x)",
        r#""a":{"type":"absval","inputs":{"in":{"node":"n"}}},"s":{"type":"multiply","inputs":{"in1":{"node":"a"},"in2":5}},"o":{"type":"sin","inputs":{"in":{"node":"s"}}}"#,
        2.0,
    ),
];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.iter().any(|argument| argument == "--test") {
        return;
    }
    let wanted = |name: &str| {
        let mut names = arguments.iter().filter(|a| !a.starts_with("--")).peekable();
        names.peek().is_none() || names.any(|part| name.contains(part.as_str()))
    };
    let heads: Vec<String> = METHODS.iter().map(ToString::to_string).collect();
    println!("| noise | map | {} |", heads.join(" | "));
    println!("|---|---|{}", "---|".repeat(METHODS.len()));
    for (source, frequency) in [("spectralnoise2d", 1.0), ("noise2d", 1.53)] {
        for (name, map, range) in MAPS.into_iter().filter(|map| wanted(map.0)) {
            let textures = SEEDS.map(|seed| {
                Texture::from_json(&format!(
                    r#"{{"version":1,"name":"ladder","nodes":{{"n":{{"type":"{source}","inputs":{{"amplitude":4,"frequency":{frequency},"seed":{seed}}}}},{map}}},"outputs":{{"out":{{"node":"o"}}}}}}"#
                ))
                .expect("the graph has no mistakes")
            });
            let runs: Vec<(usize, f32)> = (0..SEEDS.len())
                .flat_map(|seed| SIZES.map(|size| (seed, size)))
                .collect();
            let squares: Vec<Vec<f64>> = runs
                .par_iter()
                .map(|&(seed, size)| errors(&textures[seed], size, range))
                .collect();
            let totals: Vec<String> = (0..METHODS.len())
                .map(|i| {
                    let mean = squares.iter().map(|s| s[i]).sum::<f64>() / runs.len() as f64;
                    format!("{:.1}", 1e3 * mean.sqrt())
                })
                .collect();
            println!("| {source} | {name} | {} |", totals.join(" | "));
        }
    }
}

/// The mean squared error of each method at one footprint.
fn errors(texture: &Texture, size: f32, range: f32) -> Vec<f64> {
    let footprints: Vec<Footprint> = (0..PIXELS)
        .map(|i| {
            // The R2 sequence spreads pixels over 80 wavelengths.
            let p = [0.754_877_666, 0.569_840_29].map(|step: f64| (i as f64 * step).fract() * 80.0);
            Footprint {
                cell: p.map(|x| x.floor() as i32),
                uv: p.map(|x| x.fract() as f32),
                du: [size, 0.0],
                dv: [0.0, size],
            }
        })
        .collect();
    let run = |method| {
        let filter = PixelFilter::Gaussian(1.0);
        let program = texture.compile(&Options {
            method,
            filter,
            ..Options::default()
        });
        let mut outputs = Vec::new();
        let evaluator = Evaluator::<f32>::of_program(&program);
        evaluator.evaluate_footprints(&mut Scratch::new(), &footprints, &[], &mut outputs);
        outputs.swap_remove(0)
    };
    let truth = run(Method::Supersample(4096));
    let square = |a: f32, b: f32| f64::from((a - b) / range).powi(2);
    (METHODS.iter())
        .map(|&method| {
            let values = run(method);
            values
                .iter()
                .zip(&truth)
                .map(|(&a, &b)| square(a, b))
                .sum::<f64>()
                / PIXELS as f64
        })
        .collect()
}
