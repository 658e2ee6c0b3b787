//! How far random graphs are from the truth.
use super::write;
use mipless::{Footprint, Options, Texture};
use mipless_tests::asked;
use mipless_tests::case::load;
use mipless_tests::measured::{Effort, Measured, band, far_bias, relative};
use mipless_tests::random_graph::of_seed;
use mipless_tests::reduce::reduced;
use mipless_tests::shown::wavelength;
use mipless_tests::tolerance::SOURCE;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::panic::{catch_unwind, set_hook};

/// How much of each graph is looked at, where it is reduced, and of a single node.
const EFFORT: Effort = Effort {
    pixels: 32,
    samples: 1024,
};
const REDUCING: Effort = Effort {
    samples: 64,
    ..EFFORT
};
const OF_NODE: Effort = Effort {
    samples: 128,
    ..EFFORT
};
/// Graphs that are listed, the worst first.
const LISTED: usize = 20;

/// Graphs that are reduced, by so many questions each.
const REDUCED: usize = 12;
const QUESTIONS: usize = 400;

/// A name, and what it means of a graph.
type Column<'a> = (&'a str, &'a dyn Fn(&Row) -> f64);

/// What is measured of a graph.
#[derive(Clone, Copy)]
struct Row {
    seed: u64,
    nodes: usize,
    wavelength: f64,
    errors: Measured,
    bias: f64,
    /// What the audit predicts of `auto`, over all components together.
    predicted: f64,
}

impl Row {
    fn of(texture: &Texture, seed: u64, nodes: usize) -> Option<Self> {
        let wavelength = wavelength(texture)?;
        Some(Self {
            seed,
            nodes,
            wavelength,
            errors: Measured::of(texture, wavelength, EFFORT),
            bias: far_bias(texture, wavelength, EFFORT),
            predicted: predicted(texture),
        })
    }

    fn excess(&self) -> f64 {
        self.errors.excess()
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
                Row::of(&texture, seed, nodes).map_or(Outcome::Flat, Outcome::Measured)
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
        ("the largest errors", |row| row.errors.auto),
        ("the largest biases far away", |row| row.bias),
    ];
    for (title, of) in orders {
        rows.sort_by(|a, b| of(b).total_cmp(&of(a)));
        header(title);
        let listed = rows.iter().take(LISTED / 2);
        listed.for_each(|row| line(row, &replaced(row.seed)));
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
        "\n{title}:\n\n| seed | nodes | wavelength | auto | point | floor | far bias | suspected, or replaced |"
    );
    println!("|---|---|---|---|---|---|---|---|");
}

fn line(row: &Row, suspect: &str) {
    println!(
        "| {} | {} | {:.2e} | {:.4} | {:.4} | {:.4} | {:.4} | {suspect} |",
        row.seed,
        row.nodes,
        row.wavelength,
        row.errors.auto,
        row.errors.point,
        row.errors.floor,
        row.bias
    );
}

fn summary(count: u64, panicked: &[u64], rows: &[Row]) {
    let worse = rows.iter().filter(|row| row.excess() > 0.0).count();
    let clearly = rows.iter().filter(|row| row.excess() > 0.005).count();
    let bad = rows.iter().filter(|row| row.errors.auto > 0.05).count();
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
    let covered = rows
        .iter()
        .filter(|row| row.errors.auto <= row.predicted)
        .count();
    let ratio = quantile(&|row| row.predicted / row.errors.auto.max(1e-3), 0.5);
    println!(
        "the prediction covers the error in {covered} of {}; its median is {ratio:.1} times the error",
        rows.len()
    );
    println!("\n| | median | 95 % | worst |\n|---|---|---|---|");
    let columns: [Column<'_>; 4] = [
        ("auto", &|row| row.errors.auto),
        ("point", &|row| row.errors.point),
        ("floor", &|row| row.errors.floor),
        ("bias of the far mean", &|row| row.bias),
    ];
    for (name, of) in columns {
        let [median, most, worst] = [0.5, 0.95, 1.0].map(|share| quantile(of, share));
        println!("| {name} | {median:.4} | {most:.4} | {worst:.4} |");
    }
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

/// Writes the smallest graph that is as much worse by `auto` than by `point`, by a half.
fn reduce(worse: &Row) {
    let (graph, _) = of_seed(worse.seed);
    let small = reduced(graph, QUESTIONS, |_, texture| {
        let run = || {
            let wavelength = wavelength(texture)?;
            Some(Measured::of(texture, wavelength, REDUCING))
        };
        let found = catch_unwind(run).ok().flatten();
        found.is_some_and(|errors| errors.excess() > 0.5 * worse.excess())
    });
    let text = serde_json::to_string_pretty(&small).expect("JSON");
    write(&format!("worse_{}", worse.seed), &text);
}

/// What `auto` does in place of closed forms.
fn replaced(seed: u64) -> String {
    let (_, texture) = of_seed(seed);
    let graph = texture.checked().graph();
    let audit = texture.audit(&Options::default());
    let each = audit.replaced.iter().map(|replaced| {
        let kind = graph.node(replaced.node).spec.name;
        let [from, to] = replaced.sizes;
        format!("{kind} {:?} {from:.1e}–{to:.1e}", replaced.remedy)
    });
    each.collect::<Vec<_>>().join(", ")
}

/// The node whose error exceeds those of its inputs most, each relative to the spread of its values.
fn suspect(row: &Row) -> String {
    let (graph, _) = of_seed(row.seed);
    let nodes = graph["nodes"].as_object().expect("nodes");
    let mut errors: BTreeMap<String, f64> = BTreeMap::new();
    let band = band(row.wavelength, OF_NODE);
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
    relative(&texture, band, OF_NODE)
}
