//! One program, one result: f32 on the CPU against the f64 oracle, and a graphics device against
//! the CPU, for every graph and method.
//!
//! Without an adapter the device's cases show as ignored; with `MIPLESS_REQUIRE_GPU=1` they fail.
//! `MIPLESS_REPORT=1` prints what was measured.

use libtest_mimic::{Arguments, Failed, Trial};
use mipless::{Footprint, Method, Options, Program};
use mipless_codegen::cpu::eval_program;
use mipless_runtime::cpu::Renderer;
use mipless_runtime::gpu::{AdapterChoice, Gpu, GpuError, LARGEST_PROGRAM};
use mipless_runtime::image::Image;
use mipless_runtime::job::Job;
use mipless_runtime::view::{Flat, Plane, Size, View};
use mipless_tests::case::{Case, all, random};
use mipless_tests::random_graph::{asked as asked_graphs, methods};
use mipless_tests::timing::defaults;
use mipless_tests::tolerance::{DEVICE, F32_AGREES, LEFT_OUT};
use mipless_tests::{METHODS, asked, name_of};
use std::sync::Arc;

/// As many roundings as [`F32_AGREES`] allows a number.
const ROUNDINGS: f64 = 80.0;

/// Random graphs that the device draws, unless `MIPLESS_GRAPHS` says how many.
const RANDOM: u64 = 40;

fn main() {
    let arguments = Arguments::from_args();
    let gpu = Gpu::new(AdapterChoice::Any).map(Arc::new).map_err(Arc::new);
    if let Ok(gpu) = &gpu {
        report(&format!("adapter {}", gpu.report()));
    }
    let none = matches!(
        gpu.as_ref().err().map(Arc::as_ref),
        Some(GpuError::NoAdapter(_))
    );
    let ignored = none && !asked("MIPLESS_REQUIRE_GPU");
    let mut trials = Vec::new();
    for case in all().into_iter().map(Arc::new) {
        for method in METHODS {
            let name = format!("{}_{}", case.name, name_of(method));
            let on_cpu = Arc::clone(&case);
            trials.push(Trial::test(format!("oracle_{name}"), move || {
                oracle(&on_cpu, method)
            }));
            let (on_device, gpu) = (Arc::clone(&case), gpu.clone());
            let run = move || device(gpu?.as_ref(), &on_device, method, 0.0);
            trials.push(Trial::test(format!("device_{name}"), run).with_ignored_flag(ignored));
        }
    }
    for seed in 0..asked_graphs().unwrap_or(RANDOM) {
        let gpu = gpu.clone();
        let run = move || random_on_device(gpu?.as_ref(), seed);
        let name = format!("device_random_{seed}");
        trials.push(Trial::test(name, run).with_ignored_flag(ignored));
    }
    let run = move || refuses(gpu?.as_ref());
    trials.push(Trial::test("device_refuses_what_takes_minutes", run).with_ignored_flag(ignored));
    libtest_mimic::run(&arguments, trials).exit();
}

/// A shader that a driver would take minutes to compile is refused at once.
fn refuses(gpu: &Gpu) -> Result<(), Failed> {
    let nodes: Vec<String> = (0..1200)
        .map(|i| {
            let noise = format!(r#""n{i}":{{"type":"noise2d","inputs":{{"seed":{i}}}}}"#);
            let before = match i {
                0 => "0".to_owned(),
                _ => format!(r#"{{"node":"m{}"}}"#, i - 1),
            };
            format!(
                r#"{noise},"m{i}":{{"type":"max","inputs":{{"in1":{{"node":"n{i}"}},"in2":{before}}}}}"#
            )
        })
        .collect();
    let text = format!(
        r#"{{"version":1,"name":"long","nodes":{{{}}},"outputs":{{"out":{{"node":"m1199"}}}}}}"#,
        nodes.join(",")
    );
    let case = Case::new("long", text);
    match gpu.pipeline(&compile(&case, Method::Local)) {
        Err(GpuError::TooLong(instructions)) if instructions > LARGEST_PROGRAM => Ok(()),
        Err(error) => Err(format!("refused for another reason: {error}").into()),
        Ok(_) => Err("a shader of 2,400 nodes was compiled".into()),
    }
}

/// A random graph, by its methods.
fn random_on_device(gpu: &Gpu, seed: u64) -> Result<(), Failed> {
    let case = random(seed);
    for method in methods(seed) {
        device(gpu, &case, method, LEFT_OUT)?;
    }
    Ok(())
}

/// A picture that recedes to the horizon, so that it holds footprints of every size, and a flat one.
fn views() -> [View; 2] {
    let flat = Flat {
        window: [-1.3, 0.2, 2.1, 2.7],
    };
    [View::Plane(Plane::default()), View::Flat(flat)]
}

fn size() -> Size {
    Size::new(48, 32)
}

fn compile(case: &Case, method: Method) -> Program {
    case.texture.compile(&Options {
        method,
        moments: true,
        ..Options::default()
    })
}

fn render<F: mipless_codegen::float::Float>(program: &Program, view: &View) -> Image<F> {
    let rendered = Renderer::new(program).render(view, size(), None, Job::default());
    rendered.expect("nothing cancels the job")
}

/// The difference of two numbers relative to max(1, |wanted|); NaN agrees with nothing.
fn difference(found: f64, wanted: f64) -> f64 {
    let difference = (found - wanted).abs() / wanted.abs().max(1.0);
    if difference.is_nan() {
        f64::INFINITY
    } else {
        difference
    }
}

/// For every pixel, the largest difference over the channels between f32 and the oracle.
fn rounding(single: &Image<f32>, double: &Image<f64>) -> Vec<f64> {
    let mut worst = vec![0.0_f64; size().pixels()];
    for (single, double) in single.channels().iter().zip(double.channels()) {
        for (worst, (&found, &wanted)) in worst.iter_mut().zip(single.iter().zip(double)) {
            *worst = worst.max(difference(found.into(), wanted));
        }
    }
    worst
}

fn report(line: &str) {
    if asked("MIPLESS_REPORT") {
        eprintln!("{line}");
    }
}

fn oracle(case: &Case, method: Method) -> Result<(), Failed> {
    let program = compile(case, method);
    let mut failures = Vec::new();
    for view in views() {
        let differences = rounding(&render(&program, &view), &render(&program, &view));
        let mut beyond: Vec<usize> = (0..differences.len())
            .filter(|&pixel| differences[pixel] > F32_AGREES)
            .collect();
        if beyond.len() as f64 > LEFT_OUT * differences.len() as f64 {
            let edges = changes(&program, &view, &beyond);
            let mut edges = edges.into_iter();
            beyond.retain(|&pixel| differences[pixel] > F32_AGREES + edges.next().unwrap_or(0.0));
        }
        let left_out = beyond.len();
        let share = left_out as f64 / differences.len() as f64;
        let worst = differences.iter().copied().fold(0.0, f64::max);
        let line = format!(
            "oracle {} {method} {}: {share:.4} of the pixels beyond {F32_AGREES:e}, worst {worst:.2e}",
            case.name,
            view.name()
        );
        report(&line);
        if share > LEFT_OUT {
            failures.push(line);
        }
    }
    verdict(&failures)
}

/// By how much [`ROUNDINGS`] roundings of the place change the oracle's values at pixels, the most over
/// the channels: near edges f32 can tell no more.
fn changes(program: &Program, view: &View, pixels: &[usize]) -> Vec<f64> {
    let places: Vec<Footprint> = (pixels.iter())
        .map(|&pixel| view.footprint(size(), pixel).unwrap_or_default())
        .collect();
    let moved = |place: &Footprint| Footprint {
        uv: place.uv.map(|x| x + f32::EPSILON / 2.0),
        ..*place
    };
    let moved: Vec<Footprint> = places.iter().map(moved).collect();
    let parameters = defaults(program);
    let [here, beside]: [Vec<Vec<f64>>; 2] =
        [&places, &moved].map(|at| eval_program(program, at, &parameters));
    let of = |pixel: usize| {
        let channels = here.iter().zip(&beside);
        let change = |(here, beside): (&Vec<f64>, &Vec<f64>)| {
            ROUNDINGS * difference(beside[pixel], here[pixel])
        };
        channels.map(change).fold(0.0, f64::max)
    };
    (0..pixels.len()).map(of).collect()
}

/// `left_out` is the share of the pixels that may be further off: in a random graph that an edge runs
/// through.
fn device(gpu: &Gpu, case: &Case, method: Method, left_out: f64) -> Result<(), Failed> {
    let program = compile(case, method);
    let pipeline = gpu.pipeline(&program)?;
    let mut failures = Vec::new();
    for view in views() {
        let single: Image<f32> = render(&program, &view);
        let roundings = rounding(&single, &render(&program, &view));
        let (image, _) = gpu.render(&pipeline, &view, size(), Job::default())?;
        let (mut worst, mut place) = (0.0, String::new());
        let mut beyond = vec![false; size().pixels()];
        let channels = image
            .channels()
            .iter()
            .zip(single.channels())
            .zip(image.names());
        for ((found, wanted), name) in channels {
            for (pixel, (&found, &wanted)) in found.iter().zip(wanted).enumerate() {
                let difference = difference(found.into(), wanted.into());
                if roundings[pixel] > F32_AGREES {
                    continue;
                }
                beyond[pixel] |= difference > DEVICE;
                if difference > worst {
                    worst = difference;
                    place = format!("{name} of pixel {pixel}: {found} for {wanted}");
                }
            }
        }
        let line = format!(
            "device {} {method} {}: {worst:.2e} {place}",
            case.name,
            view.name()
        );
        report(&line);
        let share = beyond.iter().filter(|&&is| is).count() as f64 / beyond.len() as f64;
        if share > left_out {
            failures.push(line);
        }
    }
    verdict(&failures)
}

fn verdict(failures: &[String]) -> Result<(), Failed> {
    if failures.is_empty() {
        Ok(())
    } else {
        Err(failures.join("\n").into())
    }
}
