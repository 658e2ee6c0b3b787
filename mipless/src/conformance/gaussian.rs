//! A definition as a function of Gaussian signals: the heat equation, and covariance.

use super::law::{Law, Violation, watched};
use super::tolerance::{COVARIANCE, HEAT};
use super::{Breach, document, ports};
use crate::files::NoFiles;
use crate::{Catalogue, CheckOptions, Footprint, Method, Options};
use mipless_codegen::cpu::eval_program;
use mipless_codegen::{Bundle, Lower, NodeDef};
use mipless_graph::{
    Behaviour, Category, Default, Doc, Node, NodeSpec, OutputType, PortSpec, PortType, Reach, Type,
};
use serde_json::{Map, Value, json};

const fn number(name: &'static str, default: f32, doc: &'static str) -> PortSpec {
    let ty = PortType::Exactly(Type::Float);
    PortSpec::new(name, ty, Default::Float(default), doc)
}

/// A Gaussian signal, whatever the footprint.
static SPEC: NodeSpec = NodeSpec {
    name: "conformance_gaussian",
    aliases: &[],
    category: Category::Noise,
    summary: "A Gaussian signal.",
    doc: Doc {
        computes: "A signal of mean `mean` and standard deviation `sd`.",
        statistics: "Exact.",
        accuracy: "Exact.",
        references: "None.",
    },
    inputs: &[
        number("mean", 0.0, "The mean."),
        number("sd", 1.0, "The standard deviation."),
    ],
    output: OutputType::Exactly(Type::Float),
    reach: |_| Reach::ANY,
    class: |_| Behaviour::Gaussian { deviation: 0.0 },
    example: "",
};

fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
    let mut signal = lower.signal(node, "mean");
    let sd = lower.number(node, "sd");
    if lower.mode().spreads() {
        signal.range = [f32::NEG_INFINITY, f32::INFINITY];
        lower.algebra.attach_fresh(&mut signal, sd.square());
    }
    vec![signal]
}

static GAUSSIAN: NodeDef = NodeDef::new(&SPEC, lower);

/// Means at which a function is looked at.
const MEANS: [f64; 4] = [-0.6, 0.1, 0.45, 1.2];
/// Its standard deviation.
const SD: f64 = 0.35;
/// The steps of the differences, of the mean and of the variance.
const STEPS: [f64; 2] = [0.12, 0.02];

/// The means and the variances of the outputs by `local`, in f64; `None` where the graph is refused.
fn moments(catalogue: &Catalogue, graph: &str) -> Option<(Vec<f64>, Vec<f64>)> {
    let options = CheckOptions::default();
    let texture = catalogue
        .texture("conformance", graph, &options, &NoFiles)
        .ok()?;
    let program = texture.compile(&Options {
        method: Method::Local,
        moments: true,
        ..Options::default()
    });
    let parameters: Vec<f32> = Vec::new();
    let results = eval_program::<f64>(&program, &[Footprint::default()], &parameters);
    let numbers: Vec<f64> = results.iter().map(|result| result[0]).collect();
    let (means, variances) = numbers.split_at(numbers.len() / 2);
    Some((means.to_vec(), variances.to_vec()))
}

/// The nodes of a graph in which one input of the node is a Gaussian signal of this mean and deviation.
fn around(definition: &NodeDef, port: &str, [mean, sd]: [f64; 2]) -> Map<String, Value> {
    let mut nodes = Map::new();
    let mut add = |name: &str, node: Value| nodes.insert(name.to_owned(), node);
    let inputs = json!({ "mean": mean, "sd": sd });
    add("x", json!({ "type": SPEC.name, "inputs": inputs }));
    let mut inputs = Map::new();
    inputs.insert(port.to_owned(), json!({ "node": "x" }));
    add(
        "node",
        json!({ "type": definition.spec.name, "inputs": inputs }),
    );
    nodes
}

/// What of both laws a definition breaks.
pub(super) fn breaches(definition: &NodeDef, catalogue: &Catalogue) -> Vec<Breach> {
    let Ok(catalogue) = catalogue.with_nodes(&[GAUSSIAN]) else {
        return Vec::new();
    };
    let mut found = Vec::new();
    for port in ports(definition) {
        let graph = document(around(definition, port.name, [MEANS[1], SD]));
        let violations = watched(Method::Local, |report| {
            if let Some(what) = heat(definition, &catalogue, port.name) {
                report(Law::Heat, what);
            }
            if let Some(what) = covariance(definition, &catalogue, port.name) {
                report(Law::Covariance, what);
            }
        });
        found.extend(violations.into_iter().map(|violation: Violation| Breach {
            violation,
            graph: graph.clone(),
        }));
    }
    found
}

/// Whether ∂E/∂v = ½ ∂²E/∂m² (the density of a Gaussian is the heat kernel).
fn heat(definition: &NodeDef, catalogue: &Catalogue, port: &str) -> Option<String> {
    let mean = |m: f64, v: f64| {
        let graph = document(around(definition, port, [m, v.sqrt()]));
        Some(moments(catalogue, &graph)?.0)
    };
    let [k, h] = STEPS;
    let v = SD * SD;
    let mut worst: Option<(f64, String)> = None;
    for m in MEANS {
        let [here, left, right] = [mean(m, v)?, mean(m - k, v)?, mean(m + k, v)?];
        let [less, more] = [mean(m, v - h)?, mean(m, v + h)?];
        for channel in 0..here.len() {
            let in_time = (more[channel] - less[channel]) / (2.0 * h);
            let bend = (right[channel] - 2.0 * here[channel] + left[channel]) / (k * k);
            // What the function does over a deviation, and that it may be a table's.
            let extent = (right[channel] - left[channel]).abs() / (2.0 * k)
                + 0.5 * bend.abs()
                + in_time.abs();
            let off = (in_time - 0.5 * bend).abs();
            let allowed = HEAT * extent + 1e-3;
            if off > allowed && worst.as_ref().is_none_or(|(most, _)| off > *most) {
                let what = format!(
                    "by `{port}` at m = {m}, v = {v:.4}: ∂E/∂v is {in_time:.5}, ½ ∂²E/∂m² {:.5}, in \
                     channel {channel}",
                    0.5 * bend
                );
                worst = Some((off, what));
            }
        }
    }
    worst.map(|(_, what)| what)
}

/// Whether Var(X + Y) + Var(X − Y) = 2 Var X + 2 Var Y, X being what the node reads and Y what it gives.
fn covariance(definition: &NodeDef, catalogue: &Catalogue, port: &str) -> Option<String> {
    for m in MEANS {
        let mut nodes = around(definition, port, [m, SD]);
        // Beyond numbers, the first component.
        let first = json!({ "type": "extract", "inputs": { "in": { "node": "node" } } });
        nodes.insert("y".to_owned(), first);
        for (name, ty) in [("sum", "add"), ("difference", "subtract")] {
            let inputs = json!({ "in1": { "node": "y" }, "in2": { "node": "x" } });
            nodes.insert(name.to_owned(), json!({ "type": ty, "inputs": inputs }));
        }
        let outputs = ["x", "y", "sum", "difference"];
        let outputs = outputs.map(|name| (name.to_owned(), json!({ "node": name })));
        let graph = json!({
            "version": 1,
            "name": "conformance",
            "nodes": nodes,
            "outputs": Map::from_iter(outputs),
        });
        let (_, variances) = moments(catalogue, &graph.to_string())?;
        let [x, y, sum, difference] = variances[..] else {
            return None;
        };
        let off = (sum + difference - 2.0 * (x + y)).abs();
        let least = variances.iter().copied().fold(f64::INFINITY, f64::min);
        if off > COVARIANCE * (x + y) + 1e-12 || least < 0.0 {
            return Some(format!(
                "by `{port}` at m = {m}: Var X = {x:.6}, Var Y = {y:.6}, Var(X + Y) = {sum:.6}, Var(X − Y) \
                 = {difference:.6}"
            ));
        }
    }
    None
}
