//! What filtering costs on a graphics device: every graph, every window, against `point`.
//!
//! `cargo bench -p mipless-tests --bench device [-- [--side N] [--runs N] [GRAPH…]]` prints Markdown.
//! Any adapter will do, lavapipe included; its name is printed. The target for the median of `local`
//! is 1.8. A hardware device is busy only with a million pixels: `--side 1024 --runs 8`.

use mipless::{Method, Options};
use mipless_runtime::gpu::{AdapterChoice, Gpu};
use mipless_runtime::job::Job;
use mipless_runtime::view::{Flat, Size, View};
use mipless_tests::case;
use std::time::Instant;

/// Pixels along each side of a window, if the arguments do not say.
const SIDE: u32 = 96;
/// A method and `point` take this many turns; the median of the ratios of neighbours counts.
const RUNS: u32 = 25;
const METHODS: [Method; 4] = [Method::Point, Method::Local, Method::Quad, Method::Auto];

/// What the command line asks for.
struct Arguments {
    side: u32,
    runs: u32,
    /// All graphs if empty.
    graphs: Vec<String>,
}

impl Arguments {
    fn read() -> Self {
        let mut read = Self {
            side: SIDE,
            runs: RUNS,
            graphs: Vec::new(),
        };
        let mut arguments = std::env::args().skip(1);
        while let Some(argument) = arguments.next() {
            let mut number = || {
                let text = arguments.next().unwrap_or_default();
                text.parse().expect("--side and --runs take a number")
            };
            match argument.as_str() {
                "--side" => read.side = number(),
                "--runs" => read.runs = number(),
                "--bench" => {}
                _ => read.graphs.push(argument),
            }
        }
        read
    }
}

fn main() {
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    let arguments = Arguments::read();
    let side = arguments.side;
    let gpu = match Gpu::new(AdapterChoice::Any) {
        Ok(gpu) => gpu,
        Err(error) => {
            println!("no graphics device: {error}");
            return;
        }
    };
    println!("{:?}\n", gpu.report());
    println!("| graph | pixel, wavelengths | point, ns | local/point | quad/point | auto/point |");
    println!("|---|---:|---:|---:|---:|---:|");
    let mut ratios = vec![Vec::new(); METHODS.len()];
    let mut building = Vec::new();
    for case in case::graphs() {
        if !arguments.graphs.is_empty() && !arguments.graphs.contains(&case.name) {
            continue;
        }
        let json: serde_json::Value = serde_json::from_str(&case.text).expect("JSON");
        let wavelength = json
            .pointer("/extra/mipless/wavelength")
            .and_then(serde_json::Value::as_f64)
            .unwrap_or_else(|| panic!("{} states no wavelength", case.name));
        let mut built = Vec::new();
        let pipelines = METHODS.map(|method| {
            let program = case.texture.compile(&Options {
                method,
                ..Options::default()
            });
            let start = Instant::now();
            let pipeline = gpu.pipeline(&program);
            built.push(format!("{:.2}", start.elapsed().as_secs_f64()));
            pipeline.unwrap_or_else(|error| panic!("{}: {error}", case.name))
        });
        building.push(format!("| {} | {} |", case.name, built.join(" | ")));
        for k in -3..=3 {
            let width = 4f64.powi(k) * wavelength * f64::from(side);
            let view = View::Flat(Flat {
                window: [0.3, 0.7, 0.3 + width, 0.7 + width],
            });
            let mut point = f64::MAX;
            let mut relative = Vec::new();
            for (pipeline, ratios) in pipelines.iter().zip(&mut ratios).skip(1) {
                let size = Size::new(side, side);
                let pace = gpu
                    .pace(
                        pipeline,
                        &pipelines[0],
                        &view,
                        size,
                        arguments.runs,
                        Job::default(),
                    )
                    .unwrap_or_else(|error| panic!("{}: {error}", case.name));
                point = point.min(pace.baseline);
                ratios.push(pace.ratio);
                relative.push(format!("{:.2}", pace.ratio));
            }
            let pixel = if k < 0 {
                format!("1/{}", 4i32.pow(-k as u32))
            } else {
                4i32.pow(k as u32).to_string()
            };
            let nanoseconds = point * 1e9;
            println!(
                "| {} | {pixel} | {nanoseconds:.3} | {} |",
                case.name,
                relative.join(" | ")
            );
        }
    }
    let medians: Vec<String> = (ratios.iter_mut().skip(1))
        .map(|ratios| {
            ratios.sort_by(f64::total_cmp);
            format!("{:.2}", ratios[ratios.len() / 2])
        })
        .collect();
    println!("| median | | | {} |", medians.join(" | "));

    println!("\nSeconds to make a shader ready:\n");
    println!("| graph | point | local | quad | auto |");
    println!("|---|---:|---:|---:|---:|");
    for line in building {
        println!("{line}");
    }
}
