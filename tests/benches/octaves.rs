//! What octaves of lattice noise cost by footprint, on the CPU and one thread.
//!
//! `cargo bench -p mipless-tests --bench octaves` prints Markdown. The target: eight octaves at 16
//! wavelengths a pixel take at most 0.3 of the time that they take at 1/16.

use mipless::{Footprint, Method, Options, Program, Texture};
use mipless_codegen::cpu::{Evaluator, Scratch};
use std::time::Instant;

/// Pixels of a run.
const PIXELS: usize = 4096;
/// The fastest of this many runs counts; the programs take turns.
const RUNS: usize = 60;
/// Widths of a pixel, in wavelengths of the first octave.
const WIDTHS: [f32; 9] = [0.0, 1.0 / 64.0, 1.0 / 16.0, 0.25, 0.5, 1.0, 2.0, 4.0, 16.0];
/// The wavelength of the noise, in cells.
const WAVELENGTH: f32 = 1.53;

fn program(node: &str, method: Method) -> Program {
    let json = format!(
        r#"{{"version":1,"name":"octaves","nodes":{{"n":{node}}},"outputs":{{"out":{{"node":"n"}}}}}}"#
    );
    let texture = Texture::from_json(&json).expect("the graph has no mistakes");
    texture.compile(&Options {
        method,
        ..Options::default()
    })
}

fn footprints(width: f32) -> Vec<Footprint> {
    let length = width * WAVELENGTH;
    (0..PIXELS)
        .map(|i| Footprint {
            cell: [(i % 61) as i32, (i / 61) as i32],
            uv: [0.754_877_67, 0.569_840_3].map(|step: f32| (step * i as f32).fract()),
            du: [length, 0.0],
            dv: [0.0, length],
        })
        .collect()
}

fn main() {
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    let nodes = [
        ("noise2d", r#"{"type":"noise2d"}"#),
        (
            "8 octaves",
            r#"{"type":"fractal2d","inputs":{"octaves":8}}"#,
        ),
    ];
    let methods = [Method::Point, Method::Local, Method::Quad];
    println!("| noise | pixel, wavelengths | point, ns | local, ns | quad, ns |");
    println!("|---|---:|---:|---:|---:|");
    for (name, node) in nodes {
        let evaluators = methods.map(|method| Evaluator::<f32>::of_program(&program(node, method)));
        let (mut scratch, mut out) = (Scratch::new(), Vec::new());
        let mut local = Vec::new();
        for width in WIDTHS {
            let footprints = footprints(width);
            let mut best = [f64::MAX; 3];
            for _ in 0..RUNS {
                for (best, evaluator) in best.iter_mut().zip(&evaluators) {
                    let begun = Instant::now();
                    evaluator.evaluate_footprints(&mut scratch, &footprints, &[], &mut out);
                    *best = best.min(begun.elapsed().as_secs_f64());
                }
            }
            let times = best.map(|t| t * 1e9 / PIXELS as f64);
            local.push(times[1]);
            println!(
                "| {name} | {width} | {:.0} | {:.0} | {:.0} |",
                times[0], times[1], times[2]
            );
        }
        println!(
            "| {name}, `local` at 16 against 1/16 | | | {:.2} | |",
            local[8] / local[2]
        );
    }
}
