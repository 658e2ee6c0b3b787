//! Where a ramp in closed form costs as much as a table.
//!
//! `cargo bench -p mipless-tests --bench stops` prints Markdown: the time of ramps over a noise by
//! `local`, less that of the noise, in nanoseconds a pixel on one thread. The table is that of the
//! ramp after a clamp that no noise reaches, which is fused with it. With `-- --device` any graphics
//! device evaluates them, and the times are in shares of that of the noise.

use mipless::{Footprint, Method, Options, Texture};
use mipless_codegen::cpu::{Evaluator, Scratch};
use mipless_runtime::gpu::{AdapterChoice, Gpu, Pipeline};
use mipless_runtime::job::Job;
use mipless_runtime::view::{Flat, Size, View};
use std::time::Instant;

const PIXELS: usize = 1 << 14;
const RUNS: usize = 9;
/// The change of texture coordinates per pixel.
const PIXEL: f32 = 0.1;
/// Pixels along each side of a picture on a graphics device: enough to keep hardware busy, few
/// enough for software.
const SIDES: [u32; 2] = [1024, 128];

/// What evaluates.
enum Machine {
    Cpu { bare: f64 },
    Device { gpu: Box<Gpu>, bare: Box<Pipeline> },
}

impl Machine {
    fn new(device: bool) -> Self {
        let bare = texture(r#""o":{"type":"invert","inputs":{"in":{"node":"n"}}}"#);
        if !device {
            return Self::Cpu { bare: time(&bare) };
        }
        let gpu = Box::new(Gpu::new(AdapterChoice::Any).expect("a graphics device"));
        println!("{:?}\n", gpu.report());
        let bare = Box::new(pipeline(&gpu, &bare));
        Self::Device { gpu, bare }
    }

    /// What a texture costs beyond the noise.
    fn beyond(&self, nodes: &str) -> f64 {
        let texture = texture(nodes);
        match self {
            Self::Cpu { bare } => time(&texture) - bare,
            Self::Device { gpu, bare } => {
                let pipeline = pipeline(gpu, &texture);
                let side = SIDES[usize::from(gpu.report().software)];
                let width = f64::from(PIXEL) * f64::from(side);
                let view = View::Flat(Flat {
                    window: [0.0, 0.0, width, width],
                });
                let size = Size::new(side, side);
                gpu.pace(&pipeline, bare, &view, size, RUNS as u32, Job::default())
                    .expect("the device renders")
                    .ratio
                    - 1.0
            }
        }
    }
}

fn main() {
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    let machine = Machine::new(std::env::args().any(|argument| argument == "--device"));
    println!("| stops | values | closed form | table |");
    println!("|---|---|---|---|");
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
            let closed = machine.beyond(&ramp("n"));
            let table = machine.beyond(&format!("{clamp},{}", ramp("c")));
            println!("| {count} | {values}, {interpolation} | {closed:.2} | {table:.2} |");
        }
    }
}

fn texture(nodes: &str) -> Texture {
    Texture::from_json(&format!(
        r#"{{"version":1,"name":"stops","nodes":{{"n":{{"type":"noise2d","inputs":{{"amplitude":4}}}},{nodes}}},"outputs":{{"out":{{"node":"o"}}}}}}"#
    ))
    .expect("the graph has no mistakes")
}

fn local() -> Options {
    Options {
        method: Method::Local,
        ..Options::default()
    }
}

fn pipeline(gpu: &Gpu, texture: &Texture) -> Pipeline {
    gpu.pipeline(&texture.compile(&local()))
        .expect("the device takes the shader")
}

/// The time of a pixel on the CPU in nanoseconds, the fastest of several runs.
fn time(texture: &Texture) -> f64 {
    let footprints: Vec<Footprint> = (0..PIXELS)
        .map(|i| {
            let p = [0.754_877_666, 0.569_840_29].map(|step: f64| (i as f64 * step).fract() * 80.0);
            Footprint {
                cell: p.map(|x| x.floor() as i32),
                uv: p.map(|x| x.fract() as f32),
                du: [PIXEL, 0.0],
                dv: [0.0, PIXEL],
            }
        })
        .collect();
    let program = texture.compile(&local());
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
