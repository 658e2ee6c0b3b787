//! From JSON to WGSL text: graphs of 10, 100, 1,000 and 10,000 nodes, with naga's own validation
//! beside it.
//!
//! `cargo bench -p mipless-tests --bench compile` prints Markdown. The target is 1 ms for 100 nodes
//! and a growth of at most linear × 1.2.
//!
//! A process builds the rules that graphs share once: the first compilation is measured in processes
//! of its own, the others are those of a process that has compiled the graph before.

use mipless::{Options, Texture, target, wgsl};
use mipless_tests::large::graph;
use std::process::Command;
use std::time::{Duration, Instant};

/// The argument that makes this program measure one first compilation.
const FIRST: &str = "--first";
/// How many processes measure it.
const PROCESSES: usize = 10;

/// The fastest of this many runs counts, for a graph of 10 nodes; fewer for larger ones.
const RUNS: usize = 200;

/// JSON to WGSL once; when the checked graph, the IR and the text were there.
fn compile(json: &str) -> ([Duration; 3], String) {
    let start = Instant::now();
    let texture = Texture::from_json(json).expect("the graph has no mistakes");
    let load = start.elapsed();
    let program = texture.compile(&Options::default());
    let lower = start.elapsed();
    let shader = wgsl::emit(&program, &wgsl::Options::default());
    ([load, lower, start.elapsed()], shader.source)
}

/// The fastest first compilation of a process, in milliseconds.
fn first(count: usize) -> f64 {
    let program = std::env::current_exe().expect("this program");
    let run = |_| {
        let output = Command::new(&program)
            .args([FIRST, &count.to_string()])
            .output()
            .expect("this program runs");
        let text = String::from_utf8(output.stdout).expect("a number");
        text.trim().parse::<f64>().expect("a number")
    };
    (0..PROCESSES).map(run).fold(f64::INFINITY, f64::min)
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if arguments.iter().any(|argument| argument == "--test") {
        return;
    }
    let ms = |d: Duration| d.as_secs_f64() * 1e3;
    if let [_, flag, count] = &arguments[..]
        && flag == FIRST
    {
        let json = graph(count.parse().expect("a number of nodes"));
        println!("{}", ms(compile(&json).0[2]));
        return;
    }
    println!(
        "| nodes | JSON to WGSL, ms | per 100 nodes, ms | of it to the checked graph | to the IR | first of a process, ms | WGSL, KB | naga, ms |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for count in [10, 100, 1_000, 10_000] {
        let json = graph(count);
        let runs = (RUNS * 10 / count).max(5);
        let mut fastest = [Duration::MAX; 3];
        let (_, source) = compile(&json);
        for _ in 0..runs {
            let (times, again) = compile(&json);
            assert!(again == source, "the same bytes each time");
            for (fastest, time) in fastest.iter_mut().zip(times) {
                *fastest = time.min(*fastest);
            }
        }
        let [load, lower, whole] = fastest;
        let start = Instant::now();
        let valid = target::validate(&source);
        let naga = start.elapsed();
        assert!(valid.is_ok(), "{:?}", valid.err());
        println!(
            "| {count} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {} | {:.0} |",
            ms(whole),
            ms(whole) * 100.0 / count as f64,
            ms(load),
            ms(lower.saturating_sub(load)),
            first(count),
            source.len() / 1024,
            ms(naga)
        );
    }
}
