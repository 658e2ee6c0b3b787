//! What makes a failing graph small: nodes are left out, inputs become literals and numbers simple,
//! one after the other, as long as it still fails.

use crate::case::load;
use mipless::Texture;
use serde_json::{Map, Value, json};

/// The smallest graph that is found from this one for which `fails` still holds, with at most so many
/// questions.
pub fn reduced(
    graph: Value,
    mut questions: usize,
    mut fails: impl FnMut(&Value, &Texture) -> bool,
) -> Value {
    let mut best = graph;
    let mut next = 0;
    loop {
        let candidates = smaller(&best);
        let found = candidates
            .iter()
            .enumerate()
            .skip(next)
            .find(|(_, candidate)| {
                if questions == 0 || **candidate == best {
                    return false;
                }
                questions -= 1;
                load(&candidate.to_string()).is_ok_and(|texture| fails(candidate, &texture))
            });
        match found {
            Some((index, candidate)) => {
                best = candidate.clone();
                // What was asked before is asked again only when nothing else is left.
                next = index;
            }
            None if next > 0 && questions > 0 => next = 0,
            None => return best,
        }
    }
}

/// Graphs that are a step smaller, large steps first.
fn smaller(graph: &Value) -> Vec<Value> {
    let mut all = Vec::new();
    let mut with = |edit: &dyn Fn(&mut Value)| {
        let mut candidate = graph.clone();
        edit(&mut candidate);
        prune(&mut candidate);
        all.push(candidate);
    };
    for body in bodies(graph) {
        for output in keys(graph, &format!("{body}/outputs")) {
            with(&|graph| {
                let outputs = object(graph, &format!("{body}/outputs"));
                if outputs.len() > 1 {
                    outputs.shift_remove(&output);
                }
            });
        }
        let names = keys(graph, &format!("{body}/nodes"));
        for name in names.iter().rev() {
            let entry = &graph.pointer(&body).expect("a body")["nodes"][name];
            let inputs = entry["inputs"].as_object();
            let sources = inputs.into_iter().flat_map(Map::values);
            let mut others: Vec<Value> = sources.filter(|s| is_reference(s)).cloned().collect();
            others.extend([json!(0.5), json!([0.3, 0.6]), json!([0.2, 0.5, 0.8])]);
            for other in others {
                with(&|graph| replace(graph, &body, name, &other));
            }
        }
        for name in &names {
            let entry = &graph.pointer(&body).expect("a body")["nodes"][name];
            for (port, value) in entry["inputs"].as_object().into_iter().flatten() {
                let set = |graph: &mut Value, value: Option<Value>| {
                    let node = &mut graph.pointer_mut(&body).expect("a body")["nodes"][name];
                    let inputs = node["inputs"].as_object_mut().expect("inputs");
                    match value {
                        Some(value) => inputs.insert(port.clone(), value),
                        None => inputs.shift_remove(port),
                    };
                };
                with(&|graph| set(graph, None));
                for simple in simpler(value, graph) {
                    with(&|graph| set(graph, Some(simple.clone())));
                }
            }
        }
    }
    all
}

/// The JSON pointers of the graph and of its sub-graphs.
fn bodies(graph: &Value) -> Vec<String> {
    let subs = graph["graphs"].as_object().into_iter().flat_map(Map::keys);
    std::iter::once(String::new())
        .chain(subs.map(|name| format!("/graphs/{}", escaped(name))))
        .collect()
}

fn escaped(name: &str) -> String {
    name.replace('~', "~0").replace('/', "~1")
}

fn keys(graph: &Value, pointer: &str) -> Vec<String> {
    let entries = graph.pointer(pointer).and_then(Value::as_object);
    entries.into_iter().flat_map(Map::keys).cloned().collect()
}

fn object<'a>(graph: &'a mut Value, pointer: &str) -> &'a mut Map<String, Value> {
    let found = graph.pointer_mut(pointer).and_then(Value::as_object_mut);
    found.expect("the pointer came from the graph")
}

fn is_reference(value: &Value) -> bool {
    value.get("node").is_some() || value.get("input").is_some()
}

/// Puts something else in the place of a node, wherever the body reads it.
fn replace(graph: &mut Value, body: &str, name: &str, other: &Value) {
    let reads = |value: &Value| value.get("node").is_some_and(|node| node == name);
    let body = graph.pointer_mut(body).expect("a body");
    let sections = body.as_object_mut().expect("a body is an object");
    if let Some(Value::Object(nodes)) = sections.get_mut("nodes") {
        for node in nodes.values_mut() {
            if let Some(Value::Object(inputs)) = node.get_mut("inputs") {
                for input in inputs.values_mut().filter(|input| reads(input)) {
                    *input = other.clone();
                }
            }
        }
    }
    if let Some(Value::Object(outputs)) = sections.get_mut("outputs")
        && other.get("node").is_some()
    {
        for output in outputs.values_mut().filter(|output| reads(output)) {
            *output = other.clone();
        }
    }
}

/// What an input could hold instead.
fn simpler(value: &Value, graph: &Value) -> Vec<Value> {
    if let Some(input) = value.get("input").and_then(Value::as_str) {
        let default = graph["inputs"][input]["value"].clone();
        return if default.is_null() {
            Vec::new()
        } else {
            vec![default]
        };
    }
    if is_reference(value) {
        return vec![json!(0.5), json!([0.3, 0.6]), json!([0.2, 0.5, 0.8])];
    }
    let shorter = |x: f64| {
        let numbers = [0.0, 1.0, 0.5, x.round()];
        let one: f64 = format!("{x:.0e}").parse().expect("a number");
        let two: f64 = format!("{x:.1e}").parse().expect("a number");
        let digits = format!("{x}").len();
        (numbers.into_iter().chain([one, two]))
            .filter(move |y| format!("{y}").len() < digits)
            .collect::<Vec<f64>>()
    };
    match value {
        Value::Number(number) if number.is_f64() => {
            let x = number.as_f64().expect("a number");
            shorter(x).into_iter().map(|x| json!(x)).collect()
        }
        Value::Number(number) => {
            let x = number.as_i64().unwrap_or(0);
            let smaller = [0, 1, x / 2];
            (smaller.into_iter().filter(|y| y.abs() < x.abs()))
                .map(|x| json!(x))
                .collect()
        }
        Value::Array(items) if items.iter().all(Value::is_object) && items.len() > 1 => {
            // Stops.
            (0..items.len())
                .map(|left_out| {
                    let mut fewer = items.clone();
                    fewer.remove(left_out);
                    Value::Array(fewer)
                })
                .collect()
        }
        Value::Array(items) => {
            let mut all = vec![items[0].clone()];
            for (index, item) in items.iter().enumerate() {
                for x in item.as_f64().map(shorter).unwrap_or_default() {
                    let mut changed = items.clone();
                    changed[index] = json!(x);
                    all.push(Value::Array(changed));
                }
            }
            all
        }
        _ => Vec::new(),
    }
}

/// Leaves out nodes, sub-graphs and inputs that nothing reads.
fn prune(graph: &mut Value) {
    loop {
        let mut changed = false;
        for body in bodies(graph) {
            let Some(text) = graph.pointer(&body).cloned() else {
                continue;
            };
            let mut read = Vec::new();
            references(&text["nodes"], "node", &mut read);
            references(&text["outputs"], "node", &mut read);
            changed |= retain(graph, &format!("{body}/nodes"), &read);
            if body.is_empty() {
                let mut inputs = Vec::new();
                references(&text["nodes"], "input", &mut inputs);
                changed |= retain(graph, "/inputs", &inputs);
            }
        }
        let mut types = Vec::new();
        references(graph, "type", &mut types);
        let used: Vec<String> = (types.iter())
            .filter_map(|ty| ty.strip_prefix("graph:").map(str::to_owned))
            .collect();
        changed |= retain(graph, "/graphs", &used);
        if !changed {
            return;
        }
    }
}

fn retain(graph: &mut Value, pointer: &str, used: &[String]) -> bool {
    let Some(Value::Object(entries)) = graph.pointer_mut(pointer) else {
        return false;
    };
    let before = entries.len();
    entries.retain(|name, _| used.contains(name));
    entries.len() < before
}

/// All texts under a key, at any depth.
fn references(value: &Value, key: &str, found: &mut Vec<String>) {
    match value {
        Value::Object(entries) => {
            for (name, entry) in entries {
                match entry {
                    Value::String(text) if name == key => found.push(text.clone()),
                    _ => references(entry, key, found),
                }
            }
        }
        Value::Array(items) => items.iter().for_each(|item| references(item, key, found)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random_graph::of_seed;

    #[test]
    fn a_graph_is_reduced_to_what_makes_it_fail() {
        let holds = |graph: &Value| graph["nodes"].to_string().contains("\"type\":\"mix\"");
        // What no output reads goes with the first step.
        let graph = (0..100)
            .map(|seed| {
                let mut graph = of_seed(seed).0;
                prune(&mut graph);
                graph
            })
            .find(|graph| holds(graph) && graph["nodes"].as_object().unwrap().len() > 20)
            .expect("a large graph with a mixture");
        let small = reduced(graph, 2000, |candidate, _| holds(candidate));
        let nodes = small["nodes"].as_object().expect("nodes");
        assert_eq!(nodes.len(), 1, "{small:#}");
        assert!(
            small
                .get("graphs")
                .is_none_or(|g| g.as_object().unwrap().is_empty())
        );
        let inputs = nodes.values().next().expect("one")["inputs"].as_object();
        assert!(inputs.is_none_or(Map::is_empty), "{small:#}");
    }
}
