//! Where a ramp in closed form costs as much as a table.
//!
//! `cargo bench -p mipless-tests --bench stops` prints Markdown: the time of ramps over a noise by
//! `local`, less that of the noise, in nanoseconds a pixel on one thread. The table is that of the
//! ramp after a clamp that no noise reaches, which is fused with it.

use mipless::{Footprint, Method, Options, Texture};
use mipless_codegen::cpu::{Evaluator, Scratch};
use std::time::Instant;

const PIXELS: usize = 1 << 14;
const RUNS: usize = 9;

fn main() {
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    println!("| stops | values | closed form | table |");
    println!("|---|---|---|---|");
    let bare = time(r#""o":{"type":"invert","inputs":{"in":{"node":"n"}}}"#);
    for (values, interpolation) in [
        ("number", "linear"),
        ("colour", "constant"),
        ("colour", "linear"),
    ] {
        for count in [2, 4, 8, 12, 16, 24, 32, 64] {
            let stops: Vec<String> = (0..count)
                .map(|i| {
                    let at = 6.0 * f64::from(i) / f64::from(count - 1) - 3.0;
                    let channel = |k: i32| f64::from((i * k + k) % 11) / 10.0;
                    let [r, g, b] = [3, 5, 7].map(channel);
                    let value = match values {
                        "number" => r.to_string(),
                        _ => format!("[{r},{g},{b}]"),
                    };
                    format!(r#"{{"at":{at},"value":{value}}}"#)
                })
                .collect();
            let ramp = |input: &str| {
                let stops = stops.join(",");
                format!(
                    r#""o":{{"type":"colorramp","inputs":{{"in":{{"node":"{input}"}},"interpolation":"{interpolation}","stops":[{stops}]}}}}"#
                )
            };
            let clamp =
                r#""c":{"type":"clamp","inputs":{"in":{"node":"n"},"low":-4.9,"high":4.9}}"#;
            let closed = time(&ramp("n")) - bare;
            let table = time(&format!("{clamp},{}", ramp("c"))) - bare;
            println!("| {count} | {values}, {interpolation} | {closed:.1} | {table:.1} |");
        }
    }
}

/// The fastest of several runs.
fn time(nodes: &str) -> f64 {
    let texture = Texture::from_json(&format!(
        r#"{{"version":1,"name":"stops","nodes":{{"n":{{"type":"noise2d","inputs":{{"amplitude":4}}}},{nodes}}},"outputs":{{"out":{{"node":"o"}}}}}}"#
    ))
    .expect("the graph has no mistakes");
    let footprints: Vec<Footprint> = (0..PIXELS)
        .map(|i| {
            let p = [0.754_877_666, 0.569_840_29].map(|step: f64| (i as f64 * step).fract() * 80.0);
            Footprint {
                cell: p.map(|x| x.floor() as i32),
                uv: p.map(|x| x.fract() as f32),
                du: [0.1, 0.0],
                dv: [0.0, 0.1],
            }
        })
        .collect();
    let program = texture.compile(&Options {
        method: Method::Local,
        ..Options::default()
    });
    let evaluator = Evaluator::<f32>::of_program(&program);
    let mut scratch = Scratch::new();
    let mut outputs = Vec::new();
    let runs = (0..RUNS).map(|_| {
        let start = Instant::now();
        evaluator.evaluate_footprints(&mut scratch, &footprints, &[], &mut outputs);
        start.elapsed().as_secs_f64() * 1e9 / PIXELS as f64
    });
    runs.fold(f64::INFINITY, f64::min)
}
