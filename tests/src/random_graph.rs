//! Random graphs of any nodes of the catalogue, whose types fit.

use crate::random::Random;
use mipless::{NodeSpec, Type};
use mipless_graph::{OutputType, PortSpec, PortType};
use serde_json::{Map, Value, json};

/// A node that was made: its name and the type of its output.
struct Made {
    name: String,
    ty: Type,
}

/// The JSON text of a random graph of so many nodes, with an input, and with the last node and one
/// other as outputs.
///
/// # Panics
/// If there are no nodes.
pub fn text(random: &mut Random, nodes: usize) -> String {
    let catalogue = mipless::catalogue();
    let mut made: Vec<Made> = Vec::new();
    let mut entries = Map::new();
    for index in 0..nodes {
        let spec = random.choose(catalogue).spec;
        let (inputs, ty) = inputs(random, spec, &made);
        let name = format!("{}_{index}", spec.name);
        entries.insert(name.clone(), json!({ "type": spec.name, "inputs": inputs }));
        made.push(Made { name, ty });
    }
    let last = made.last().expect("at least one node");
    let other = random.choose(&made);
    let graph = json!({
        "version": 1,
        "name": "random",
        "inputs": { "knob": { "type": "float", "value": random.within(0.5, 2.0), "min": 0.5, "max": 2 } },
        "nodes": entries,
        "outputs": { "last": { "node": last.name }, "other": { "node": other.name } },
    });
    serde_json::to_string_pretty(&graph).expect("JSON")
}

/// Random inputs of a node, and the type of its output.
fn inputs(random: &mut Random, spec: &NodeSpec, made: &[Made]) -> (Map<String, Value>, Type) {
    let mut inputs = Map::new();
    let mut widest = Type::Float;
    let mut stops = Type::Float;
    for port in spec.inputs {
        let choice = random.unit();
        let typed = port.ty == PortType::Any || spec.output == OutputType::Named(port.name);
        if choice < 0.15 && !typed {
            continue;
        }
        let value = match port.ty {
            PortType::Stops => {
                let colors = random.happens(0.5);
                stops = if colors { Type::Color3 } else { Type::Float };
                random_stops(random, colors)
            }
            PortType::Choice(names) => json!(random.choose(names)),
            PortType::Exactly(ty) => {
                let from = pick(random, made, |made| made.converts_to(ty));
                match from {
                    Some(from) if !port.uniform && choice < 0.8 => json!({ "node": from.name }),
                    _ if ty == Type::Float && !port.uniform && choice > 0.95 => {
                        json!({ "input": "knob" })
                    }
                    _ => literal(random, port, ty),
                }
            }
            PortType::Any => {
                let from = pick(random, made, |made| {
                    let number = !matches!(made, Type::Boolean | Type::String | Type::Filename);
                    number && made.widest(widest).is_some()
                });
                match from {
                    Some(from) if !port.uniform && choice < 0.8 => {
                        widest = from.ty.widest(widest).expect("the types meet");
                        json!({ "node": from.name })
                    }
                    _ => literal(random, port, Type::Float),
                }
            }
        };
        inputs.insert(port.name.to_owned(), value);
    }
    let named = |port: &str| {
        let default = spec.inputs.iter().find(|input| input.name == port);
        let default = default.map(|input| match input.default {
            mipless_graph::Default::Choice(name) => name,
            other => panic!("{other:?} of {} names no type", spec.name),
        });
        let written = inputs.get(port).and_then(Value::as_str);
        let name = written.or(default).expect("a choice");
        Type::by_name(name).expect("a type")
    };
    let ty = match spec.output {
        OutputType::Exactly(ty) => ty,
        OutputType::Widest | OutputType::Whole => widest,
        OutputType::Named(port) => named(port),
        OutputType::Picture { file, named: port } if inputs.contains_key(file) => named(port),
        OutputType::Picture { .. } | OutputType::Stops => stops,
    };
    (inputs, ty)
}

fn pick<'a>(
    random: &mut Random,
    made: &'a [Made],
    fits: impl Fn(Type) -> bool,
) -> Option<&'a Made> {
    let fitting: Vec<&Made> = made.iter().filter(|made| fits(made.ty)).collect();
    if fitting.is_empty() {
        None
    } else {
        Some(fitting[random.below(fitting.len())])
    }
}

/// Sorted stops, sometimes two in one place.
fn random_stops(random: &mut Random, colors: bool) -> Value {
    let count = 1 + random.below(6);
    let mut places: Vec<f64> = (0..count).map(|_| random.within(-1.0, 1.0)).collect();
    places.sort_by(f64::total_cmp);
    if count > 2 && random.happens(0.3) {
        places[1] = places[0];
    }
    let stop = |&at: &f64| {
        let mut unit = || (1000.0 * random.unit()).round() / 1000.0;
        let value = if colors {
            json!([unit(), unit(), unit()])
        } else {
            json!(unit())
        };
        json!({ "at": at, "value": value })
    };
    places.iter().map(stop).collect()
}

/// A literal of a type, in the range of a port.
fn literal(random: &mut Random, port: &PortSpec, ty: Type) -> Value {
    match ty {
        Type::Boolean => json!(random.happens(0.5)),
        Type::Filename => json!("images/granite.png"),
        Type::String => json!(""),
        Type::Integer => json!(number(random, port).round() as i64),
        _ if ty.components() <= 1 => json!(number(random, port)),
        _ => (0..ty.components()).map(|_| number(random, port)).collect(),
    }
}

/// A number that the port accepts: mostly from its slider, sometimes from beyond or a round one.
fn number(random: &mut Random, port: &PortSpec) -> f64 {
    let range = port.range;
    let (low, high) = (f64::from(range.soft_min), f64::from(range.soft_max));
    let x = match random.below(10) {
        0 => *random.choose(&[0.0, 1.0, -1.0, 0.5, 1e-6, 1e6]),
        1 => random.within(10.0 * low - 9.0 * high, 10.0 * high - 9.0 * low),
        _ => random.within(low, high),
    };
    let x = x.clamp(f64::from(range.min), f64::from(range.max));
    if range.nonzero && x.abs() < 1e-3 {
        high.max(1.0)
    } else {
        x
    }
}
