//! What filtering costs on a graphics device: every graph, every window, against `point`.
//!
//! `cargo bench -p mipless-tests --bench device` prints Markdown. Any adapter will do, lavapipe
//! included; its name is printed. The target for the median of `local` is 1.8.

use mipless::{Method, Options};
use mipless_runtime::gpu::{AdapterChoice, Gpu};
use mipless_runtime::job::Job;
use mipless_runtime::view::{Flat, Size, View};
use mipless_tests::case;

/// Pixels along each side of a window.
const SIDE: u32 = 96;
/// The fastest of this many short runs counts, as other work disturbs long ones; the methods take
/// turns.
const RUNS: usize = 40;
const METHODS: [Method; 4] = [Method::Point, Method::Local, Method::Quad, Method::Auto];

fn main() {
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
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
    for case in case::graphs() {
        let json: serde_json::Value = serde_json::from_str(&case.text).expect("JSON");
        let wavelength = json
            .pointer("/extra/mipless/wavelength")
            .and_then(serde_json::Value::as_f64)
            .unwrap_or_else(|| panic!("{} states no wavelength", case.name));
        let pipelines = METHODS.map(|method| {
            let program = case.texture.compile(&Options {
                method,
                ..Options::default()
            });
            gpu.pipeline(&program)
                .unwrap_or_else(|error| panic!("{}: {error}", case.name))
        });
        for k in -3..=3 {
            let width = 4f64.powi(k) * wavelength * f64::from(SIDE);
            let view = View::Flat(Flat {
                window: [0.3, 0.7, 0.3 + width, 0.7 + width],
            });
            let mut best = [f64::MAX; METHODS.len()];
            for _ in 0..RUNS {
                for (best, pipeline) in best.iter_mut().zip(&pipelines) {
                    let (_, timing) = gpu
                        .render(pipeline, &view, Size::new(SIDE, SIDE), Job::default())
                        .unwrap_or_else(|error| panic!("{}: {error}", case.name));
                    *best = best.min(timing.best().as_secs_f64());
                }
            }
            let point = best[0];
            let relative: Vec<String> = (best.iter().zip(&mut ratios))
                .map(|(time, ratios)| {
                    ratios.push(time / point);
                    format!("{:.2}", time / point)
                })
                .skip(1)
                .collect();
            let pixel = if k < 0 {
                format!("1/{}", 4i32.pow(-k as u32))
            } else {
                4i32.pow(k as u32).to_string()
            };
            let nanoseconds = point * 1e9 / f64::from(SIDE * SIDE);
            println!(
                "| {} | {pixel} | {nanoseconds:.0} | {} |",
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
}
