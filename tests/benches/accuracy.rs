//! How far each method is from the truth, and what it costs, for every graph in `graphs/`.
//!
//! `cargo bench -p mipless-tests --bench accuracy [-- [--quick] [GRAPH…]]` prints Markdown.
//!
//! A window looks straight at the texture, with pixels of 4^k wavelengths of the noise that dominates
//! the graph, k from −3 to 3. A graph states that wavelength under `/extra/mipless/wavelength`, in
//! units of texture space. So that a window of small pixels still sees more than one place, it
//! consists of scattered square tiles.
//!
//! With `--quick` the windows are smaller, nothing is timed, and the exit status is 1 if the median
//! or the worst error of `auto` misses its target.

use mipless::{Footprint, Method, Options, Program, Texture};
use mipless_codegen::cpu::{Evaluator, Scratch};
use mipless_tests::timing::{defaults, fastest};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// The targets for `auto`: the median and the worst error over all graphs and windows, linear.
const MEDIAN_ERROR: f64 = 0.02;
const WORST_ERROR: f64 = 0.08;
/// Where `naive` is off by more than this, `auto` should be off by at most half as much.
const NAIVE_IS_WRONG: f64 = 0.1;
/// The target for the median time of `local`, relative to `point`.
const LOCAL_TIME: f64 = 1.8;

/// Samples a pixel of each of the two truths.
const SAMPLES: u32 = 1024;
const METHODS: [Method; 5] = [
    Method::Naive,
    Method::Ensemble,
    Method::Local,
    Method::Quad,
    Method::Auto,
];
/// The exponents k of the windows.
const WINDOWS: std::ops::RangeInclusive<i32> = -3..=3;
/// Tiles along a side of the window, and the distance between their corners in units of texture
/// space. The distance is no multiple of any pattern's period.
const TILES: usize = 4;
const APART: [f64; 2] = [7.318_27, 5.641_93];
/// The fastest of this many runs counts.
const RUNS: usize = 15;

struct Graph {
    name: String,
    texture: Texture,
    wavelength: f64,
}

struct Row {
    /// The size of a pixel, in wavelengths.
    pixel: f64,
    floor: f64,
    /// One for each of [`METHODS`].
    errors: Vec<f64>,
    times: Option<Times>,
}

struct Times {
    /// Nanoseconds a pixel.
    point: f64,
    /// Multiples of `point`.
    local: f64,
    quad: f64,
    auto: f64,
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let quick = arguments.iter().any(|a| a == "--quick");
    let wanted: Vec<&String> = arguments.iter().filter(|a| !a.starts_with('-')).collect();
    let graphs: Vec<Graph> = files()
        .iter()
        .map(|path| read(path))
        .filter(|graph| wanted.is_empty() || wanted.contains(&&graph.name))
        .collect();
    let mut rows = Vec::new();
    for graph in &graphs {
        println!("\n### {}\n", graph.name);
        header();
        for k in WINDOWS {
            let row = measure(graph, 4f64.powi(k), quick);
            print_row(&row);
            rows.push((graph.name.as_str(), row));
        }
    }
    summary(&rows, quick)
}

/// The graphs, in the order of their names.
fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../graphs");
    let entries = std::fs::read_dir(folder).expect("the folder of graphs");
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.expect("an entry of the folder of graphs").path())
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .collect();
    files.sort();
    files
}

fn read(path: &Path) -> Graph {
    let name = path
        .file_stem()
        .expect("a file name")
        .to_string_lossy()
        .into_owned();
    let text = std::fs::read_to_string(path).expect("a readable graph");
    let texture = Texture::from_file(path).unwrap_or_else(|e| panic!("{name}: {e}"));
    let json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let wavelength = json
        .pointer("/extra/mipless/wavelength")
        .and_then(serde_json::Value::as_f64)
        .unwrap_or_else(|| panic!("{name} states no wavelength"));
    Graph {
        name,
        texture,
        wavelength,
    }
}

/// The pixels of a window, `side` along each side; `pixel` is their size in texture space.
fn footprints(side: usize, pixel: f64) -> Vec<Footprint> {
    let tile = side / TILES;
    (0..side * side)
        .map(|index| {
            let place = [index % side, index / side];
            let position: [f64; 2] = std::array::from_fn(|axis| {
                let (tile_at, other) = (place[axis] / tile, place[1 - axis] / tile);
                let corner = APART[axis] * (tile_at as f64 + 0.37 * other as f64 + 0.19);
                corner + ((place[axis] % tile) as f64 + 0.5) * pixel
            });
            let cell = position.map(f64::floor);
            Footprint {
                cell: cell.map(|c| c as i32),
                uv: [0, 1].map(|axis| (position[axis] - cell[axis]) as f32),
                du: [pixel as f32, 0.0],
                dv: [0.0, pixel as f32],
            }
        })
        .collect()
}

fn measure(graph: &Graph, pixel: f64, quick: bool) -> Row {
    let side = if quick { 24 } else { 64 };
    let footprints = footprints(side, pixel * graph.wavelength);
    let compile = |method, seed| {
        graph.texture.compile(&Options {
            method,
            seed,
            ..Options::default()
        })
    };
    let truths =
        [1, 2].map(|seed| parallel(&compile(Method::Supersample(SAMPLES), seed), &footprints));
    let truth: Vec<f64> = truths[0]
        .iter()
        .zip(&truths[1])
        .map(|(a, b)| 0.5 * (a + b))
        .collect();
    let errors = METHODS
        .iter()
        .map(|&method| rms(&parallel(&compile(method, 0), &footprints), &truth))
        .collect();
    // Two independent truths differ by √2 of the error of one, and their mean has 1/√2 of it.
    let floor = 0.5 * rms(&truths[0], &truths[1]);
    let times = (!quick).then(|| {
        let programs = [Method::Point, Method::Local, Method::Quad, Method::Auto];
        let programs = programs.map(|m| compile(m, 0));
        let [point, local, quad, auto] = fastest(&programs, &footprints, RUNS);
        let pixel = 1e9 / footprints.len() as f64;
        Times {
            point: point * pixel,
            local: local / point,
            quad: quad / point,
            auto: auto / point,
        }
    });
    Row {
        pixel,
        floor,
        errors,
        times,
    }
}

/// All outputs of all pixels as a display takes them: from 0 to 1.
fn parallel(program: &Program, footprints: &[Footprint]) -> Vec<f64> {
    let evaluator = Evaluator::<f32>::of_program(program);
    let parameters = defaults(program);
    footprints
        .par_chunks(256)
        .flat_map_iter(|part| {
            let (mut scratch, mut outputs) = (Scratch::new(), Vec::new());
            evaluator.evaluate_footprints(&mut scratch, part, &parameters, &mut outputs);
            (0..part.len())
                .flat_map(|lane| {
                    outputs
                        .iter()
                        .map(move |output| output[lane])
                        .collect::<Vec<_>>()
                })
                .map(|x| {
                    assert!(x.is_finite(), "a result is {x}");
                    f64::from(x.clamp(0.0, 1.0))
                })
                .collect::<Vec<_>>()
        })
        .collect()
}

fn rms(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len(), "numbers of results");
    let squares: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (squares / a.len() as f64).sqrt()
}

fn header() {
    print!("| pixel, wavelengths | floor |");
    METHODS.iter().for_each(|method| print!(" {method} |"));
    println!(" point, ns | local/point | quad/point | auto/point |");
    println!("|{}", "---:|".repeat(METHODS.len() + 6));
}

fn print_row(row: &Row) {
    let pixel = if row.pixel < 1.0 {
        format!("1/{:.0}", 1.0 / row.pixel)
    } else {
        format!("{:.0}", row.pixel)
    };
    print!("| {pixel} | {:.4} |", row.floor);
    row.errors.iter().for_each(|error| print!(" {error:.4} |"));
    match &row.times {
        Some(t) => println!(
            " {:.0} | {:.2} | {:.2} | {:.2} |",
            t.point, t.local, t.quad, t.auto
        ),
        None => println!(" – | – | – | – |"),
    }
}

/// The middle and the largest of some numbers.
fn median_and_worst(mut numbers: Vec<f64>) -> (f64, f64) {
    numbers.sort_by(f64::total_cmp);
    (numbers[numbers.len() / 2], numbers[numbers.len() - 1])
}

fn summary(rows: &[(&str, Row)], quick: bool) -> ExitCode {
    println!("\n### All graphs and windows\n");
    println!("| | median | worst |\n|---|---:|---:|");
    let mut auto = (0.0, 0.0);
    for (i, method) in METHODS.iter().enumerate() {
        auto = median_and_worst(rows.iter().map(|(_, row)| row.errors[i]).collect());
        println!("| error of {method} | {:.4} | {:.4} |", auto.0, auto.1);
    }
    let time = |of: fn(&Times) -> f64| -> Option<(f64, f64)> {
        let all: Vec<f64> = rows
            .iter()
            .filter_map(|(_, row)| row.times.as_ref().map(of))
            .collect();
        (!all.is_empty()).then(|| median_and_worst(all))
    };
    let local = time(|t| t.local);
    let others = [("quad", time(|t| t.quad)), ("auto", time(|t| t.auto))];
    for (name, found) in [("local", local)].into_iter().chain(others) {
        if let Some((median, worst)) = found {
            println!("| time of {name}, relative to point | {median:.2} | {worst:.2} |");
        }
    }
    println!("\nTargets that are missed:\n");
    let mut missed = Vec::new();
    if auto.0 > MEDIAN_ERROR {
        missed.push(format!(
            "the median error of auto is {:.4} > {MEDIAN_ERROR}",
            auto.0
        ));
    }
    if let Some((median, _)) = local.filter(|l| l.0 > LOCAL_TIME) {
        missed.push(format!(
            "the median time of local is {median:.2} > {LOCAL_TIME}"
        ));
    }
    for (name, Row { pixel, errors, .. }) in rows {
        let (naive, auto) = (errors[0], errors[METHODS.len() - 1]);
        if auto > WORST_ERROR {
            missed.push(format!(
                "{name}, {pixel} wavelengths: auto {auto:.4} > {WORST_ERROR}"
            ));
        }
        if naive > NAIVE_IS_WRONG && auto > 0.5 * naive {
            missed.push(format!(
                "{name}, {pixel} wavelengths: auto {auto:.4} > half of naive {naive:.4}"
            ));
        }
    }
    missed.iter().for_each(|line| println!("- {line}"));
    if missed.is_empty() {
        println!("- none");
    }
    let fails = quick && (auto.0 > MEDIAN_ERROR || auto.1 > WORST_ERROR);
    if fails {
        ExitCode::FAILURE
    } else {
        ExitCode::SUCCESS
    }
}
