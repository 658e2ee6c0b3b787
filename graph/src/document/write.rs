//! A document back into JSON. Numbers stay as they were written.

use serde_json::{Map, Value};

use super::{Binding, Body, Document, InputEntry, NodeEntry, Reference, VERSION};

/// The whole document.
pub(super) fn document(document: &Document) -> Value {
    let mut json = Map::new();
    text(&mut json, "$schema", document.schema.as_ref());
    json.insert("version".to_owned(), VERSION.into());
    text(&mut json, "name", document.name.as_ref());
    fill(&mut json, &document.body);
    if !document.graphs.is_empty() {
        let graphs = document.graphs.iter().map(|(name, graph)| {
            let mut json = Map::new();
            fill(&mut json, graph);
            (name.clone(), Value::Object(json))
        });
        json.insert("graphs".to_owned(), Value::Object(graphs.collect()));
    }
    any(&mut json, "extra", document.body.extra.as_ref());
    Value::Object(json)
}

fn text(json: &mut Map<String, Value>, key: &str, value: Option<&String>) {
    if let Some(value) = value {
        json.insert(key.to_owned(), value.clone().into());
    }
}

fn any(json: &mut Map<String, Value>, key: &str, value: Option<&Value>) {
    if let Some(value) = value {
        json.insert(key.to_owned(), value.clone());
    }
}

/// What a graph and a sub-graph have in common; `extra` comes last.
fn fill(json: &mut Map<String, Value>, body: &Body) {
    text(json, "doc", body.doc.as_ref());
    if !body.inputs.is_empty() {
        let inputs = body
            .inputs
            .iter()
            .map(|(name, entry)| (name.clone(), input(entry)));
        json.insert("inputs".to_owned(), Value::Object(inputs.collect()));
    }
    let nodes = body
        .nodes
        .iter()
        .map(|(name, entry)| (name.clone(), node(entry)));
    json.insert("nodes".to_owned(), Value::Object(nodes.collect()));
    let outputs = body
        .outputs
        .iter()
        .map(|(name, entry)| (name.clone(), reference(entry)));
    json.insert("outputs".to_owned(), Value::Object(outputs.collect()));
    any(json, "extra", body.extra.as_ref());
}

fn input(entry: &InputEntry) -> Value {
    let mut json = Map::new();
    json.insert("type".to_owned(), entry.ty.clone().into());
    json.insert("value".to_owned(), entry.value.clone());
    let bounds = [
        ("min", entry.min),
        ("max", entry.max),
        ("soft_min", entry.soft_min),
        ("soft_max", entry.soft_max),
    ];
    for (key, bound) in bounds {
        if let Some(bound) = bound {
            json.insert(key.to_owned(), number(bound));
        }
    }
    text(&mut json, "doc", entry.doc.as_ref());
    any(&mut json, "extra", entry.extra.as_ref());
    Value::Object(json)
}

/// Whole numbers are written without a fraction, as people write them.
fn number(value: f64) -> Value {
    const EXACT: f64 = 9_007_199_254_740_992.0;
    if value.fract() == 0.0 && value.abs() <= EXACT {
        (value as i64).into()
    } else {
        value.into()
    }
}

fn node(entry: &NodeEntry) -> Value {
    let mut json = Map::new();
    json.insert("type".to_owned(), entry.ty.clone().into());
    text(&mut json, "doc", entry.doc.as_ref());
    if !entry.inputs.is_empty() {
        let inputs = entry
            .inputs
            .iter()
            .map(|(name, entry)| (name.clone(), binding(entry)));
        json.insert("inputs".to_owned(), Value::Object(inputs.collect()));
    }
    any(&mut json, "extra", entry.extra.as_ref());
    Value::Object(json)
}

pub(super) fn binding(binding: &Binding) -> Value {
    match binding {
        Binding::Value(value) => value.clone(),
        Binding::Node(node) => reference(node),
        Binding::Input(name) => Map::from_iter([("input".to_owned(), name.clone().into())]).into(),
    }
}

fn reference(reference: &Reference) -> Value {
    let mut json = Map::from_iter([("node".to_owned(), reference.node.clone().into())]);
    if reference.output != "out" {
        json.insert("output".to_owned(), reference.output.clone().into());
    }
    json.into()
}
