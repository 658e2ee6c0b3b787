//! How far random graphs are from the truth.
//!
//! The truth of a pixel is the mean of two independent ones of 1024 samples, their own error that of
//! the two against each other over √2. Errors are the root mean square over pixels and components, of
//! what a display shows: limited to 0 to 1, and sRGB.

use super::write;
use mipless::{Footprint, Method, Options, Texture};
use mipless_tests::asked;
use mipless_tests::case::load;
use mipless_tests::random::Random;
use mipless_tests::random_graph::of_seed;
use mipless_tests::reduce::reduced;
use mipless_tests::shown::{evaluate, mean, rms, shown, truths, variance, wavelength};
use mipless_tests::tolerance::SOURCE;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::f64::consts::SQRT_2;
use std::panic::{catch_unwind, set_hook};

/// Pixels, in wavelengths.
const BAND: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];
/// The pixels of the frame far away, in wavelengths.
const FAR: f64 = 64.0;
/// Pixels of each size.
const PIXELS: usize = 32;
/// Samples of each of the two truths.
const SAMPLES: u32 = 1024;
/// Graphs that are listed, the worst first.
const LISTED: usize = 20;

/// Graphs that are reduced, by so many questions each, with so many samples.
const REDUCED: usize = 12;
const QUESTIONS: usize = 400;
const FEWER: u32 = 64;

/// A name, and what it means of a graph.
type Column<'a> = (&'a str, &'a dyn Fn(&Row) -> f64);

/// What is measured of a graph.
#[derive(Clone, Copy)]
struct Row {
    seed: u64,
    nodes: usize,
    wavelength: f64,
    auto: f64,
    point: f64,
    floor: f64,
    /// |mean of `auto` − mean of the truth| over the far frame, the largest of the components.
    bias: f64,
    /// What the audit predicts of `auto`, over all components together.
    predicted: f64,
}

impl Row {
    /// By how much `auto` is worse than `point`, beyond what the truth knows.
    fn excess(&self) -> f64 {
        self.auto - self.point - self.floor
    }
}

/// A number of a graph.
type Measure = fn(&Row) -> f64;

enum Outcome {
    Measured(Row),
    /// It is the same everywhere, or white, or black.
    Flat,
    Panicked(u64),
}

/// Measures and prints.
pub(super) fn measure(count: u64, first: u64) {
    set_hook(Box::new(|_| {}));
    let outcomes: Vec<Outcome> = (first..first + count)
        .into_par_iter()
        .map(|seed| {
            let run = || {
                let (graph, texture) = of_seed(seed);
                let nodes = graph["nodes"].as_object().map_or(0, serde_json::Map::len);
                row(&texture, SAMPLES, seed, nodes).map_or(Outcome::Flat, Outcome::Measured)
            };
            catch_unwind(run).unwrap_or(Outcome::Panicked(seed))
        })
        .collect();
    let panicked: Vec<u64> = (outcomes.iter())
        .filter_map(|outcome| match outcome {
            Outcome::Panicked(seed) => Some(*seed),
            _ => None,
        })
        .collect();
    let mut rows: Vec<Row> = (outcomes.into_iter())
        .filter_map(|outcome| match outcome {
            Outcome::Measured(row) => Some(row),
            _ => None,
        })
        .collect();
    rows.sort_by(|a, b| b.excess().total_cmp(&a.excess()));
    summary(count, &panicked, &rows);
    let worse: Vec<Row> = rows
        .iter()
        .filter(|row| row.excess() > 0.0)
        .copied()
        .collect();
    let suspects: Vec<String> = (worse.par_iter().take(2 * LISTED))
        .map(|row| catch_unwind(|| suspect(row)).unwrap_or_else(|_| "a panic".to_owned()))
        .collect();
    header("worse than a point");
    for (row, suspect) in worse.iter().zip(&suspects).take(LISTED) {
        line(row, suspect);
    }
    let orders: [(&str, Measure); 2] = [
        ("the largest errors", |row| row.auto),
        ("the largest biases far away", |row| row.bias),
    ];
    for (title, of) in orders {
        rows.sort_by(|a, b| of(b).total_cmp(&of(a)));
        header(title);
        rows.iter().take(LISTED / 2).for_each(|row| line(row, ""));
    }
    if !asked("FAST") {
        worse.par_iter().take(REDUCED).for_each(reduce);
    }
    let mut kinds: BTreeMap<&str, usize> = BTreeMap::new();
    for suspect in &suspects {
        let kind = suspect.split(" (").nth(1).unwrap_or(suspect);
        *kinds.entry(kind.trim_end_matches(')')).or_default() += 1;
    }
    let mut kinds: Vec<(&str, usize)> = kinds.into_iter().collect();
    kinds.sort_by_key(|&(_, count)| std::cmp::Reverse(count));
    let kinds: Vec<String> = (kinds.iter())
        .map(|(kind, count)| format!("{kind} {count}"))
        .collect();
    println!(
        "\nSuspected in the worst {}: {}",
        suspects.len(),
        kinds.join(", ")
    );
}

fn header(title: &str) {
    println!(
        "\n{title}:\n\n| seed | nodes | wavelength | auto | point | floor | far bias | suspected |"
    );
    println!("|---|---|---|---|---|---|---|---|");
}

fn line(row: &Row, suspect: &str) {
    println!(
        "| {} | {} | {:.2e} | {:.4} | {:.4} | {:.4} | {:.4} | {suspect} |",
        row.seed, row.nodes, row.wavelength, row.auto, row.point, row.floor, row.bias
    );
}

fn summary(count: u64, panicked: &[u64], rows: &[Row]) {
    let worse = rows.iter().filter(|row| row.excess() > 0.0).count();
    let clearly = rows.iter().filter(|row| row.excess() > 0.005).count();
    let bad = rows.iter().filter(|row| row.auto > 0.05).count();
    let quantile = |of: &dyn Fn(&Row) -> f64, share: f64| {
        let mut values: Vec<f64> = rows.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        let place = share * (values.len().max(1) - 1) as f64;
        values.get(place.round() as usize).copied().unwrap_or(0.0)
    };
    println!("{count} graphs, of which {} show something", rows.len());
    println!("panics: {} {panicked:?}", panicked.len());
    println!("`auto` worse than `point` by more than the floor: {worse}; by 0.005 more: {clearly}");
    println!("`auto` above 0.05: {bad}");
    let covered = rows.iter().filter(|row| row.auto <= row.predicted).count();
    let ratio = quantile(&|row| row.predicted / row.auto.max(1e-3), 0.5);
    println!(
        "the prediction covers the error in {covered} of {}; its median is {ratio:.1} times the error",
        rows.len()
    );
    println!("\n| | median | 95 % | worst |\n|---|---|---|---|");
    let columns: [Column<'_>; 4] = [
        ("auto", &|row| row.auto),
        ("point", &|row| row.point),
        ("floor", &|row| row.floor),
        ("bias of the far mean", &|row| row.bias),
    ];
    for (name, of) in columns {
        let [median, most, worst] = [0.5, 0.95, 1.0].map(|share| quantile(of, share));
        println!("| {name} | {median:.4} | {most:.4} | {worst:.4} |");
    }
}

/// Pixels of some sizes at random places, a third of them eight times as long as wide and askew.
fn pixels(sizes: &[f64], wavelength: f64) -> Vec<Footprint> {
    let mut random = Random::new(4);
    let mut all = Vec::new();
    for size in sizes {
        let size = (size * wavelength) as f32;
        for pixel in 0..PIXELS {
            let reach = 20.0 * wavelength.max(0.4);
            let [x, y] = [0, 1].map(|_| random.within(-reach, reach));
            let (du, dv) = if pixel % 3 == 2 {
                let narrow = size / 8.0;
                ([0.8 * size, 0.6 * size], [-0.6 * narrow, 0.8 * narrow])
            } else {
                ([size, 0.0], [0.0, size])
            };
            all.push(Footprint {
                du,
                dv,
                ..Footprint::point([x, y])
            });
        }
    }
    all
}

/// The root mean square over components of the errors that the audit predicts; where every rule is
/// exact, what filtering the sources themselves is off by.
fn predicted(texture: &Texture) -> f64 {
    let audit = texture.audit(&Options::default());
    let (mut squares, mut count) = (0.0, 0.0);
    for (index, output) in texture.outputs().iter().enumerate() {
        let audited = audit.outputs.iter().find(|audited| audited.output == index);
        let error = audited.map_or(SOURCE, |audited| audited.predicted());
        let components = output.ty.components() as f64;
        squares += components * error * error;
        count += components;
    }
    f64::sqrt(squares / f64::max(count, 1.0))
}

fn row(texture: &Texture, samples: u32, seed: u64, nodes: usize) -> Option<Row> {
    let wavelength = wavelength(texture)?;
    let band = pixels(&BAND, wavelength);
    let truths_shown = truths(texture, samples, &band).map(shown);
    let truth = mean(&truths_shown);
    let error = |method| rms(&shown(evaluate(texture, method, 0, &band)), &truth);

    let frame = pixels(&[FAR, FAR], wavelength);
    let far_truth = mean(&truths(texture, samples, &frame).map(shown));
    let far = shown(evaluate(texture, Method::Auto, 0, &frame));
    let average = |values: &Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
    let biases = (far.iter().zip(&far_truth)).map(|(a, b)| (average(a) - average(b)).abs());
    Some(Row {
        seed,
        nodes,
        wavelength,
        auto: error(Method::Auto),
        point: error(Method::Point),
        floor: rms(&truths_shown[0], &truths_shown[1]) / SQRT_2,
        bias: biases.fold(0.0, f64::max),
        predicted: predicted(texture),
    })
}

/// Writes the smallest graph that is as much worse by `auto` than by `point`, by a half.
fn reduce(worse: &Row) {
    let (graph, _) = of_seed(worse.seed);
    let small = reduced(graph, QUESTIONS, |_, texture| {
        let run = || row(texture, FEWER, worse.seed, 0);
        let found = catch_unwind(run).ok().flatten();
        found.is_some_and(|row| row.excess() > 0.5 * worse.excess())
    });
    let text = serde_json::to_string_pretty(&small).expect("JSON");
    write(&format!("worse_{}", worse.seed), &text);
}

/// The node whose error exceeds those of its inputs most, each relative to the spread of its values.
fn suspect(row: &Row) -> String {
    let (graph, _) = of_seed(row.seed);
    let nodes = graph["nodes"].as_object().expect("nodes");
    let mut errors: BTreeMap<String, f64> = BTreeMap::new();
    let band = pixels(&BAND, row.wavelength);
    for name in nodes.keys() {
        let error = of_node(&graph, name, &band).unwrap_or(0.0);
        errors.insert(name.clone(), error);
    }
    let excess = |name: &String| {
        let inputs = nodes[name]["inputs"].as_object();
        let inputs = inputs.into_iter().flat_map(serde_json::Map::values);
        let before = inputs
            .filter_map(|input| errors.get(input.get("node")?.as_str()?))
            .fold(0.0_f64, |most, &error| most.max(error));
        errors[name] - before
    };
    let names = nodes.keys().filter(|name| is_read(&graph, name));
    let worst = names.max_by(|a, b| excess(a).total_cmp(&excess(b)));
    worst.map_or_else(String::new, |name| {
        let ty = nodes[name]["type"].as_str().unwrap_or("?");
        format!("{name} ({ty})")
    })
}

/// Whether an output depends on a node.
fn is_read(graph: &Value, name: &str) -> bool {
    let mut stack: Vec<&str> = vec![name];
    let mut seen = Vec::new();
    let reads = |value: &Value, node: &str| value.get("node").is_some_and(|n| n == node);
    while let Some(node) = stack.pop() {
        let outputs = graph["outputs"].as_object().expect("outputs");
        if outputs.values().any(|output| reads(output, node)) {
            return true;
        }
        for (reader, entry) in graph["nodes"].as_object().expect("nodes") {
            let inputs = entry["inputs"].as_object();
            let mut inputs = inputs.into_iter().flat_map(serde_json::Map::values);
            if !seen.contains(&reader) && inputs.any(|input| reads(input, node)) {
                seen.push(reader);
                stack.push(reader);
            }
        }
    }
    false
}

/// The error of one node's output, relative to the spread of its values.
fn of_node(graph: &Value, name: &str, band: &[Footprint]) -> Option<f64> {
    let mut alone = graph.clone();
    let ty = alone["nodes"][name]["type"].as_str()?;
    let output = match ty.strip_prefix("graph:") {
        Some(sub) => alone["graphs"][sub]["outputs"]
            .as_object()?
            .keys()
            .next()?
            .clone(),
        None => "out".to_owned(),
    };
    alone["outputs"] = json!({ "out": { "node": name, "output": output } });
    let texture = load(&alone.to_string()).ok()?;
    let exact = |values: Vec<Vec<f32>>| -> Vec<Vec<f64>> {
        let of = |values: Vec<f32>| values.into_iter().map(f64::from).collect();
        values.into_iter().map(of).collect()
    };
    let spread = variance(&exact(evaluate(&texture, Method::Point, 0, band))).sqrt();
    let truth = mean(&truths(&texture, 128, band).map(exact));
    let found = exact(evaluate(&texture, Method::Auto, 0, band));
    let error = rms(&found, &truth) / spread.max(1e-6);
    error.is_finite().then_some(error)
}
