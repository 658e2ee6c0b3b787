//! A noise that is read at coordinates displaced by two others, by 0.3 of its wavelengths (standard
//! deviation along each coordinate).
//!
//! `cargo bench -p mipless-tests --bench warp` prints Markdown: the RMS error of the filtered mean of
//! a noise of standard deviation 1, against 4096 samples a pixel, by the footprint in wavelengths.

use mipless::{Footprint, Method, Options, PixelFilter, Texture};
use mipless_codegen::cpu::{Evaluator, Scratch};
use rayon::prelude::*;

/// Standard deviations of the footprint, in wavelengths.
const SIZES: [f32; 4] = [0.03, 0.1, 0.2, 0.35];
const PIXELS: usize = 1500;
const METHODS: [Method; 6] = [
    Method::Point,
    Method::Local,
    Method::Quad,
    Method::Auto,
    Method::Split(4),
    Method::Split(7),
];

/// One number displaces along the diagonal: turned by 45 degrees, one noise displaces along u and
/// the other along v, and 0.3/√2 makes it 0.3.
fn graph(source: &str, frequency: f32, longer: f32) -> String {
    let noise = |seed: u32, frequency: f32, texcoord: &str| {
        format!(
            r#"{{"type":"{source}","inputs":{{"amplitude":4,"frequency":{frequency},"seed":{seed}{texcoord}}}}}"#
        )
    };
    let slow = frequency / longer;
    let (first, second) = (noise(1, slow, ""), noise(2, slow, ""));
    let read = noise(3, frequency, r#","texcoord":{"node":"both"}"#);
    format!(
        r#"{{"version":1,"name":"warp","nodes":{{
        "first":{first},"second":{second},
        "along":{{"type":"rotate2d","inputs":{{"in":{{"node":"first"}},"amount":-45}}}},
        "across":{{"type":"rotate2d","inputs":{{"in":{{"node":"second"}},"amount":45}}}},
        "one":{{"type":"warp","inputs":{{"in":{{"node":"along"}},"strength":0.212132}}}},
        "both":{{"type":"warp","inputs":{{"texcoord":{{"node":"one"}},"in":{{"node":"across"}},"strength":0.212132}}}},
        "read":{read}}},"outputs":{{"out":{{"node":"read"}}}}}}"#
    )
}

fn main() {
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    let heads: Vec<String> = METHODS.iter().map(ToString::to_string).collect();
    println!(
        "| noise, its frequency | wavelength of the displacement | footprint | {} |",
        heads.join(" | ")
    );
    println!("|---|---|---|{}", "---|".repeat(METHODS.len()));
    for (source, frequency, longer) in [
        ("spectralnoise2d", 1.0, 3.0),
        ("spectralnoise2d", 1.0, 1.0),
        ("noise2d", 1.53, 3.0),
        // Of the mean frequency, 0.686 a cell, that the band of the spectral noise has, 1.02.
        ("noise2d", 1.487, 3.0),
        ("noise2d", 1.53, 1.0),
    ] {
        let texture = Texture::from_json(&graph(source, frequency, longer))
            .expect("the graph has no mistakes");
        let rows: Vec<Vec<f64>> = SIZES
            .par_iter()
            .map(|&size| errors(&texture, size))
            .collect();
        for (size, row) in SIZES.iter().zip(rows) {
            let cells: Vec<String> = row.iter().map(|error| format!("{error:.4}")).collect();
            println!(
                "| {source}, {frequency} | {longer} | {size} | {} |",
                cells.join(" | ")
            );
        }
    }
}

/// The RMS error of each method at one footprint.
fn errors(texture: &Texture, size: f32) -> Vec<f64> {
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
        let program = texture.compile(&Options {
            method,
            filter: PixelFilter::Gaussian(1.0),
            ..Options::default()
        });
        let mut outputs = Vec::new();
        let evaluator = Evaluator::<f32>::of_program(&program);
        evaluator.evaluate_footprints(&mut Scratch::new(), &footprints, &[], &mut outputs);
        outputs.swap_remove(0)
    };
    let truth = run(Method::Supersample(4096));
    (METHODS.iter())
        .map(|&method| {
            let values = run(method);
            let squares = (values.iter().zip(&truth)).map(|(&a, &b)| f64::from(a - b).powi(2));
            (squares.sum::<f64>() / PIXELS as f64).sqrt()
        })
        .collect()
}
