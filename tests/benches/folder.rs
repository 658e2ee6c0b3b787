//! Documents of a folder, as strangers write them: how far `auto` and `point` are from the truth, for
//! every output, over windows of 1 and 4 uv.
//!
//! `cargo bench -p mipless-tests --bench folder -- DIR…` looks at all documents in these folders, of
//! any format that is taken, without an argument at those of `mtlx` and `ptex` in the folder that
//! `MIPLESS_CORPUS` names. It prints Markdown: by window how many outputs show something there, the
//! median, the 95 % and the worst error of these, and those that are worse than by `point`, beyond what
//! the truth knows; then the outputs with the largest errors, and how long each document took to
//! compile by `auto`. An output shows nothing in a window whose pixels hardly differ, by the truth, by
//! `auto` and by `point`: most outputs of a material are constants.
//!
//! Errors are the root mean square over the components of an output and [`PIXELS`] pixels of a
//! picture of [`SIDE`] pixels each way, of what a display shows.

use mipless::{CheckOptions, Files as _, Folder, Footprint, Method, Texture, specs};
use mipless_import::{Format, import};
use mipless_tests::measured::Measured;
use mipless_tests::random::Random;
use mipless_tests::shown::{VISIBLE, evaluate, mean, rms, shown, truths, variance};
use rayon::prelude::*;
use std::f64::consts::SQRT_2;
use std::panic::{catch_unwind, set_hook};
use std::path::{Path, PathBuf};
use std::time::Instant;
use std::{env, fs};

const WINDOWS: [f64; 2] = [1.0, 4.0];
/// Pixels of the picture of a window, each way, and how many of them are looked at.
const SIDE: f64 = 256.0;
const PIXELS: usize = 512;
/// Samples of each of the two truths.
const SAMPLES: u32 = 128;
/// Outputs and documents that are listed.
const LISTED: usize = 25;

/// What is measured of an output over a window.
struct Row {
    name: String,
    window: f64,
    errors: Measured,
    /// Whether its pixels differ, or what a point of them shows does.
    shows: bool,
}

/// What became of a document.
enum Outcome {
    Measured(Vec<Row>, f64),
    /// Nothing of it loads.
    Refused,
    Panicked(String),
}

fn main() {
    let given: Vec<PathBuf> = env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .map(PathBuf::from)
        .collect();
    let folders = if given.is_empty() {
        let corpus = PathBuf::from(env::var_os("MIPLESS_CORPUS").unwrap_or_default());
        ["mtlx", "ptex"].map(|format| corpus.join(format)).to_vec()
    } else {
        given
    };
    let mut paths: Vec<PathBuf> = (folders.iter())
        .flat_map(|folder| {
            fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()))
        })
        .map(|entry| entry.expect("an entry of the folder").path())
        .filter(|path| Format::of(path).is_some())
        .collect();
    assert!(!paths.is_empty(), "no documents in {folders:?}");
    paths.sort();
    set_hook(Box::new(|_| {}));
    let outcomes: Vec<Outcome> = (paths.par_iter())
        .map(|path| {
            let name = path
                .file_name()
                .map_or_else(String::new, |n| n.to_string_lossy().into_owned());
            let of = || measured(path, &name);
            let outcome = catch_unwind(of).unwrap_or_else(|_| Outcome::Panicked(name.clone()));
            if let Outcome::Measured(rows, seconds) = &outcome {
                eprintln!("{name}: {} rows, {seconds:.1} s", rows.len());
            }
            outcome
        })
        .collect();
    report(outcomes);
}

/// The texture of a document, of what loads.
fn texture(path: &Path) -> Option<Texture> {
    let text = fs::read_to_string(path).ok()?;
    let files = Folder(path.parent()?.to_path_buf());
    let specs = specs();
    let options = mipless_import::Options {
        specs: &specs,
        files: &|name| files.read(name),
        ..mipless_import::Options::default()
    };
    let imported = import(Format::of(path)?, "document", &text, &options);
    let text = imported.document?.to_text();
    Texture::with_name("t", &text, &CheckOptions::default(), &files).ok()
}

fn measured(path: &Path, name: &str) -> Outcome {
    let Some(texture) = texture(path) else {
        return Outcome::Refused;
    };
    let start = Instant::now();
    let _ = evaluate(&texture, Method::Auto, 0, &pixels(1.0)[..1]);
    let seconds = start.elapsed().as_secs_f64();
    let mut rows = Vec::new();
    for window in WINDOWS {
        let pixels = pixels(window);
        let truths = truths(&texture, SAMPLES, &pixels).map(shown);
        let truth = mean(&truths);
        let [auto, point] = [Method::Auto, Method::Point]
            .map(|method| shown(evaluate(&texture, method, 0, &pixels)));
        let mut start = 0;
        for output in texture.outputs() {
            let of = start..start + output.ty.components();
            start = of.end;
            let error = |values: &[Vec<f64>]| rms(&values[of.clone()], &truth[of.clone()]);
            let spread = |values: &[Vec<f64>]| variance(&values[of.clone()]).sqrt();
            rows.push(Row {
                name: format!("{name} {}", output.name),
                window,
                errors: Measured {
                    auto: error(&auto),
                    point: error(&point),
                    floor: rms(&truths[0][of.clone()], &truths[1][of.clone()]) / SQRT_2,
                },
                shows: spread(&truth).max(spread(&point)).max(spread(&auto)) >= VISIBLE,
            });
        }
    }
    Outcome::Measured(rows, seconds)
}

/// Pixels at random places of the picture of a window.
fn pixels(window: f64) -> Vec<Footprint> {
    let mut random = Random::new(7);
    let size = (window / SIDE) as f32;
    (0..PIXELS)
        .map(|_| Footprint {
            du: [size, 0.0],
            dv: [0.0, size],
            ..Footprint::point([0, 1].map(|_| random.within(0.0, window)))
        })
        .collect()
}

fn report(outcomes: Vec<Outcome>) {
    let (mut rows, mut times) = (Vec::new(), Vec::new());
    let (mut refused, mut panicked) = (0, Vec::new());
    let documents = outcomes.len();
    for outcome in outcomes {
        match outcome {
            Outcome::Measured(of_document, seconds) => {
                let name = of_document.first().map_or("", |row| &row.name);
                let name = name.split(' ').next().unwrap_or_default().to_owned();
                times.push((seconds, name));
                rows.extend(of_document);
            }
            Outcome::Refused => refused += 1,
            Outcome::Panicked(name) => panicked.push(name),
        }
    }
    println!("{documents} documents, of {refused} nothing loads, panicked: {panicked:?}\n");
    println!(
        "| window | outputs | show | median | 95 % | worst | of a point | worse than a point |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for window in WINDOWS {
        let all: Vec<&Row> = rows.iter().filter(|row| row.window == window).collect();
        let of_window: Vec<&Row> = all.iter().copied().filter(|row| row.shows).collect();
        let at = |share: f64, of: &dyn Fn(&Row) -> f64| {
            let mut values: Vec<f64> = of_window.iter().map(|row| of(row)).collect();
            values.sort_by(f64::total_cmp);
            let last = values.len().saturating_sub(1);
            values
                .get((share * last as f64).round() as usize)
                .copied()
                .unwrap_or(0.0)
        };
        let auto = |row: &Row| row.errors.auto;
        let worse = all.iter().filter(|row| row.errors.excess() > 0.0);
        println!(
            "| {window} | {} | {} | {:.4} | {:.4} | {:.4} | {:.4} | {} |",
            all.len(),
            of_window.len(),
            at(0.5, &auto),
            at(0.95, &auto),
            at(1.0, &auto),
            at(0.5, &|row| row.errors.point),
            worse.count()
        );
    }
    type Order = fn(&Row) -> f64;
    let orders: [(&str, Order); 2] = [
        ("worse than a point", |row| row.errors.excess()),
        ("the largest errors", |row| row.errors.auto),
    ];
    for (title, of) in orders {
        rows.sort_by(|a, b| of(b).total_cmp(&of(a)));
        println!("\n{title}:\n\n| output | window | auto | point | floor |\n|---|---|---|---|---|");
        for row in rows.iter().filter(|row| of(row) > 0.0).take(LISTED) {
            let Measured { auto, point, floor } = row.errors;
            println!(
                "| {} | {} | {auto:.4} | {point:.4} | {floor:.4} |",
                row.name, row.window
            );
        }
    }
    times.sort_by(|a, b| b.0.total_cmp(&a.0));
    println!("\nSlowest to compile:");
    for (seconds, name) in times.iter().take(LISTED) {
        println!("    {name} {seconds:.2} s");
    }
}
