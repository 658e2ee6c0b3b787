//! Random graphs: which laws they break, and how far `auto` and `point` are from the truth.
//!
//! `cargo bench -p mipless-tests --bench random -- laws COUNT [FIRST]` takes the graphs of COUNT seeds
//! from FIRST on through all laws of composition by every method, and prints what is broken, by law.
//! Each kind of failure is reduced and written to `target/composition`.

use mipless_tests::METHODS;
use mipless_tests::law::{Law, Violation, violations};
use mipless_tests::random_graph::of_seed;
use mipless_tests::reduce::reduced;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::panic::{catch_unwind, set_hook};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;
use std::{env, fs};

/// Questions that reducing one graph may ask.
const QUESTIONS: usize = 300;

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).filter(|a| a != "--bench").collect();
    let number = |place: usize| arguments.get(place).and_then(|a| a.parse().ok());
    match arguments.first().map(String::as_str) {
        Some("laws") => laws(number(1).unwrap_or(300), number(2).unwrap_or(0)),
        _ => {
            eprintln!("laws COUNT [FIRST]");
            return ExitCode::from(2);
        }
    }
    ExitCode::SUCCESS
}

fn laws(count: u64, first: u64) {
    set_hook(Box::new(|_| {}));
    let start = Instant::now();
    let found: Vec<(u64, Vec<Violation>)> = (first..first + count)
        .into_par_iter()
        .map(|seed| {
            let broken = catch_unwind(|| {
                let (_, texture) = of_seed(seed);
                violations(&texture, &Law::ALL, &METHODS)
            });
            (
                seed,
                broken.unwrap_or_else(|_| panic!("seed {seed} has no graph")),
            )
        })
        .collect();
    let mut kinds: BTreeMap<String, Vec<(u64, &Violation)>> = BTreeMap::new();
    for (seed, broken) in &found {
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
        .filter(|(_, broken)| !broken.is_empty())
        .count();
    println!(
        "{count} graphs, {broken} break a law, {:.0} s",
        start.elapsed().as_secs_f64()
    );
    for (kind, cases) in &kinds {
        println!("{:5} {kind}", cases.len());
        for (seed, violation) in cases.iter().take(3) {
            println!("        seed {seed}: {}", violation.what);
        }
    }
    if env::var("REDUCE").is_err() {
        return;
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/composition");
    fs::create_dir_all(&folder).expect("a folder for what is found");
    for (kind, cases) in &kinds {
        let (seed, violation) = cases[0];
        let law = violation.law;
        let methods = [violation.method];
        let (graph, _) = of_seed(seed);
        let small = reduced(graph, QUESTIONS, |_, texture| {
            violations(texture, &[law], &methods)
                .iter()
                .any(|v| v.law == law)
        });
        let name: String = kind
            .chars()
            .take(60)
            .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
            .collect();
        let text = serde_json::to_string_pretty(&small).expect("JSON");
        fs::write(folder.join(format!("{name}_{seed}.json")), text).expect("a writable folder");
    }
}
