//! Random edits of a document: of things that are there most of the time, and of others now and then.

use crate::random::Random;
use mipless::session::Edit;
use mipless::{Body, Document, specs};
use serde_json::{Value, json};

/// An edit of the document, as data.
pub fn edit(random: &mut Random, document: &Document) -> Edit {
    let json = as_json(random, document);
    serde_json::from_value(json.clone()).unwrap_or_else(|error| panic!("{json}: {error}"))
}

/// One of the names, or one that is not there.
fn name<'a>(random: &mut Random, names: impl Iterator<Item = &'a String>) -> String {
    let names: Vec<&String> = names.collect();
    if names.is_empty() || random.happens(0.03) {
        return "nowhere".to_owned();
    }
    (*random.choose(&names)).clone()
}

/// A name that is free most of the time.
fn fresh(random: &mut Random) -> String {
    let odd = ["größe", "a/b~c", "out", "", "x 1"];
    if random.happens(0.1) {
        (*random.choose(&odd)).to_owned()
    } else {
        format!("new{}", random.bits() % 100)
    }
}

/// What an input may be given.
fn literal(random: &mut Random) -> Value {
    let number = (random.within(-2.0, 6.0) * 8.0).round() / 8.0;
    match random.bits() % 10 {
        0 => json!("#c08a52"),
        1 => json!([number, 0.5]),
        2 => json!([0.25, number, 1]),
        3 => json!(true),
        4 => json!("linear"),
        5 => json!([{ "at": 0, "value": number }, { "at": 1, "value": 1 }]),
        6 => json!(number as i64),
        _ => json!(number),
    }
}

/// An input of a node: one that its type has, most of the time.
fn port(random: &mut Random, document: &Document, body: &Body, node: &str) -> String {
    let Some(entry) = body.nodes.get(node) else {
        return "in".to_owned();
    };
    let mut ports: Vec<String> = match entry.ty.strip_prefix("graph:") {
        Some(sub) => (document.graphs.get(sub))
            .map(|sub| sub.inputs.keys().cloned().collect())
            .unwrap_or_default(),
        None => (specs().iter())
            .find(|spec| spec.name == entry.ty)
            .map(|spec| {
                spec.inputs
                    .iter()
                    .map(|port| port.name.to_owned())
                    .collect()
            })
            .unwrap_or_default(),
    };
    ports.extend(entry.inputs.keys().cloned());
    if ports.is_empty() || random.happens(0.03) {
        return "nothing".to_owned();
    }
    random.choose(&ports).clone()
}

fn as_json(random: &mut Random, document: &Document) -> Value {
    let graph = if !document.graphs.is_empty() && random.happens(0.25) {
        Some(name(random, document.graphs.keys()))
    } else {
        None
    };
    let known = graph.as_ref().map(|graph| document.graphs.get(graph));
    let empty = Body::default();
    let body = match known {
        None => &document.body,
        Some(sub) => sub.unwrap_or(&empty),
    };
    let node = name(random, body.nodes.keys());
    let input = port(random, document, body, &node);
    let few = |random: &mut Random| -> Vec<String> {
        let count = 1 + random.bits() % 4;
        (0..count)
            .map(|_| name(random, body.nodes.keys()))
            .collect()
    };
    let mut edit = match random.bits() % 26 {
        0 | 1 => {
            let all = specs();
            let spec = *random.choose(&all);
            json!({ "edit": "add", "nodes": { fresh(random): { "type": spec.name } } })
        }
        2 => json!({ "edit": "paste", "nodes": {
            node.clone(): { "type": "absval", "inputs": { "in": { "node": node } } } } }),
        3 => json!({ "edit": "duplicate", "nodes": few(random) }),
        4 => json!({ "edit": "remove", "nodes": [node] }),
        5 | 6 => json!({ "edit": "rename", "node": node, "to": fresh(random) }),
        7..=9 => json!({ "edit": "connect", "node": node, "input": input,
            "from": name(random, body.nodes.keys()) }),
        10 => json!({ "edit": "disconnect", "node": node, "input": input }),
        11..=13 => json!({ "edit": "set", "node": node, "input": input, "value": literal(random) }),
        14 => json!({ "edit": "set_stop", "node": node, "index": random.bits() % 3,
            "at": random.unit(), "value": literal(random) }),
        15 => json!({ "edit": "remove_stop", "node": node, "index": random.bits() % 3 }),
        16 | 17 => json!({ "edit": "set_input", "input": name(random, body.inputs.keys()),
            "value": literal(random) }),
        18 => json!({ "edit": "put_input", "input": fresh(random),
            "entry": { "type": "float", "value": 1, "min": 0.5, "max": 2 } }),
        19 => json!({ "edit": "remove_input", "input": name(random, body.inputs.keys()) }),
        20 => json!({ "edit": "rename_input", "input": name(random, body.inputs.keys()),
            "to": fresh(random) }),
        21 => json!({ "edit": "put_output", "output": fresh(random), "node": node }),
        22 => json!({ "edit": "rename_output", "output": name(random, body.outputs.keys()),
            "to": fresh(random) }),
        23 => json!({ "edit": "group", "nodes": few(random), "name": fresh(random) }),
        24 => json!({ "edit": "ungroup", "node": node }),
        _ => json!({ "edit": "set_extra", "node": node, "extra": [random.unit(), 40] }),
    };
    if let Some(graph) = graph {
        edit["graph"] = graph.into();
    }
    edit
}
