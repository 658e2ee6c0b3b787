//! Random graphs: how far `auto` and `point` are from the truth, and which laws they break.
//!
//! `cargo bench -p mipless-tests --bench random -- COUNT [FIRST]` measures the graphs of COUNT seeds
//! from FIRST on, in a band of a quarter to four wavelengths of each, against samples, and prints how
//! many are worse by `auto` than by `point`, the errors, the bias of the mean of a frame far away, and
//! the worst graphs with the node that is suspected. The worst are reduced and written to
//! `target/composition`, unless `FAST=1` is set.
//!
//! `cargo bench -p mipless-tests --bench random -- laws COUNT [FIRST]` takes the graphs of COUNT seeds
//! from FIRST on through all laws of composition by every method, and prints what is broken, by law.
//! Three graphs of each kind of failure are reduced and written to `target/composition`, unless
//! `FAST=1` is set (`EACH=20`: twenty). `LAWS=vanishing,far` and `METHODS=local,quad` look at less, and
//! `SECONDS=600` begins no further graph after so long; the next run goes on from the seed that is
//! printed.
//!
//! `cargo bench -p mipless-tests --bench random -- seed SEED` prints the graph of a seed.
//!
//! `cargo bench -p mipless-tests --bench random -- file GRAPH.json…` prints what graphs break, and
//! what each method makes of pixels of several sizes.

#[path = "random/accuracy.rs"]
mod accuracy;

use mipless::{Footprint, Method, Options};
use mipless_tests::case::load;
use mipless_tests::law::{Law, Violation, violations};
use mipless_tests::random_graph::of_seed;
use mipless_tests::reduce::reduced;
use mipless_tests::{METHODS, asked, root};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::panic::{catch_unwind, set_hook};
use std::process::ExitCode;
use std::time::Instant;
use std::{env, fs};

/// Pixels of which values are printed.
const SIZES: [f32; 7] = [0.0, 1e-4, 0.01, 0.1, 1.0, 100.0, 1e6];

/// Graphs of each kind of which it is printed what was found.
const SHOWN: usize = 10;

/// Questions that reducing one graph may ask.
const QUESTIONS: usize = 300;

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).filter(|a| a != "--bench").collect();
    let number = |place: usize| arguments.get(place).and_then(|a| a.parse().ok());
    match arguments.first().map(String::as_str) {
        Some("laws") => laws(number(1).unwrap_or(300), number(2).unwrap_or(0)),
        Some("file") => files(&arguments[1..]),
        Some("seed") => println!("{:#}", of_seed(number(1).unwrap_or(0)).0),
        Some(first) if first.parse::<u64>().is_ok() => {
            accuracy::measure(number(0).expect("a number"), number(1).unwrap_or(0));
        }
        _ => {
            eprintln!("COUNT [FIRST], laws COUNT [FIRST], seed SEED, or file GRAPH.json…");
            return ExitCode::from(2);
        }
    }
    ExitCode::SUCCESS
}

fn files(paths: &[String]) {
    for path in paths {
        let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{path}: {error}"));
        let texture = load(&text).unwrap_or_else(|mistakes| panic!("{path}: {mistakes:?}"));
        for violation in violations(&texture, &Law::ALL, &METHODS) {
            println!("{path}: {violation}");
        }
        let pixel = |size: f32| Footprint {
            uv: [0.31, 0.77],
            du: [size, 0.0],
            dv: [0.0, size],
            ..Footprint::default()
        };
        let pixels = SIZES.map(pixel);
        for method in METHODS {
            let options = Options {
                method,
                moments: true,
                ..Options::default()
            };
            let values = texture.evaluator(&options).evaluate(&pixels);
            println!("{method}");
            for values in values {
                println!("    {values:?}");
            }
        }
    }
}

/// Writes a graph that was found.
fn write(name: &str, text: &str) {
    let folder = root().join("target/composition");
    let written = fs::create_dir_all(&folder)
        .and_then(|()| fs::write(folder.join(format!("{name}.json")), text));
    written.unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
}

/// Those of `all` whose names a variable lists; all if it is not set.
fn chosen<T: Copy>(variable: &str, all: &[T], name: impl Fn(&T) -> String) -> Vec<T> {
    let Ok(names) = env::var(variable) else {
        return all.to_vec();
    };
    let names: Vec<&str> = names.split(',').collect();
    let listed = |x: &&T| names.contains(&name(x).as_str());
    all.iter().filter(listed).copied().collect()
}

fn laws(count: u64, first: u64) {
    set_hook(Box::new(|_| {}));
    let start = Instant::now();
    let laws: Vec<Law> = chosen("LAWS", &Law::ALL, |law| law.name().to_owned());
    let methods: Vec<Method> = chosen("METHODS", &METHODS, Method::to_string);
    let limit: Option<f64> = env::var("SECONDS")
        .ok()
        .and_then(|limit| limit.parse().ok());
    let limit = limit.unwrap_or(f64::INFINITY);
    let mut found: Vec<(u64, Vec<Violation>, f64)> = (first..first + count)
        .take_while(|_| start.elapsed().as_secs_f64() < limit)
        .par_bridge()
        .map(|seed| {
            let start = Instant::now();
            let broken = catch_unwind(|| {
                let (_, texture) = of_seed(seed);
                violations(&texture, &laws, &methods)
            });
            let broken = broken.unwrap_or_else(|_| panic!("seed {seed} has no graph"));
            (seed, broken, start.elapsed().as_secs_f64())
        })
        .collect();
    found.sort_by_key(|&(seed, ..)| seed);
    let mut kinds: BTreeMap<String, Vec<(u64, &Violation)>> = BTreeMap::new();
    for (seed, broken, _) in &found {
        for violation in broken {
            let mut kind = format!("{} by {}", violation.law.name(), violation.method);
            if violation.law.name() == "panics" {
                kind += &format!(": {}", violation.what);
            }
            kinds.entry(kind).or_default().push((*seed, violation));
        }
    }
    let broken = found
        .iter()
        .filter(|(_, broken, _)| !broken.is_empty())
        .count();
    println!(
        "{} graphs to seed {}, {broken} break a law, {:.0} s",
        found.len(),
        found.last().map_or(first, |&(seed, ..)| seed),
        start.elapsed().as_secs_f64()
    );
    let mut slowest: Vec<(f64, u64)> = found.iter().map(|&(seed, _, time)| (time, seed)).collect();
    slowest.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (time, seed) in slowest.iter().take(3) {
        println!("      seed {seed} took {time:.1} s");
    }
    for (kind, cases) in &kinds {
        let seeds: Vec<String> = cases.iter().map(|(seed, _)| seed.to_string()).collect();
        println!("{:5} {kind}: {}", cases.len(), seeds.join(" "));
        for (seed, violation) in cases.iter().take(SHOWN) {
            println!("        seed {seed}: {}", violation.what);
        }
    }
    if asked("FAST") {
        return;
    }
    let each = env::var("EACH")
        .ok()
        .and_then(|each| each.parse().ok())
        .unwrap_or(3);
    let chosen: Vec<_> = (kinds.iter())
        .flat_map(|(kind, cases)| cases.iter().take(each).map(move |case| (kind, case)))
        .collect();
    chosen
        .into_par_iter()
        .for_each(|(kind, (seed, violation))| {
            let law = violation.law;
            let methods = [violation.method];
            let (graph, _) = of_seed(*seed);
            let small = reduced(graph, QUESTIONS, |_, texture| {
                let broken = violations(texture, &[law], &methods);
                broken.iter().any(|v| v.law == law)
            });
            let name: String = kind
                .chars()
                .take(60)
                .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
                .collect();
            let text = serde_json::to_string_pretty(&small).expect("JSON");
            write(&format!("{name}_{seed}"), &text);
        });
}
