//! Nodes become a sub-graph, and a sub-graph its nodes.

use super::patch::Recorder;
use super::rewire::{Refused, Types, chosen, free, rebind, redirect, refuse, scopes};
use mipless_graph::{Binding, Body, Diagnostic, InputEntry, Map, NodeEntry, Reference, Type};
use serde_json::Value;

/// Makes a sub-graph of the nodes.
///
/// What they read of others becomes an input of it, each thing once, of the type that it has; what others
/// read of them becomes an output.
pub(super) fn group(
    recorder: &mut Recorder<'_>,
    graph: &Option<String>,
    nodes: &[String],
    name: &str,
    types: Types<'_>,
) -> Result<(), Refused> {
    let body = recorder.body(graph);
    let inside = chosen(body, nodes)?;
    if inside.is_empty() {
        return Err(refuse(
            "no-nodes",
            "a sub-graph is made of at least one node",
        ));
    }
    if recorder.document().graphs.contains_key(name) {
        let message = format!("there is a sub-graph `{name}` already");
        return Err(refuse("name-taken", message));
    }
    if body.nodes.contains_key(name) && !inside.iter().any(|node| node == name) {
        return Err(refuse(
            "name-taken",
            format!("there is a node `{name}` already"),
        ));
    }
    if outside_between(body, &inside) {
        return Err(Box::new(
            Diagnostic::error("group-cycle", "what they read reads one of them")
                .because("the sub-graph would need itself")
                .help("group what lies between them too"),
        ));
    }

    let mut inner = Body::default();
    let mut bound: Map<Binding> = Map::default();
    for node in &inside {
        let mut entry = body.nodes[node].clone();
        for binding in entry.inputs.values_mut() {
            let is_outside = match &*binding {
                Binding::Node(reference) => !inside.contains(&reference.node),
                Binding::Input(_) => true,
                Binding::Value(_) => false,
            };
            if !is_outside {
                continue;
            }
            let known = bound.iter().find(|(_, known)| *known == binding);
            let input = match known {
                Some((input, _)) => input.clone(),
                None => {
                    let (wished, entry) = input(body, binding, graph, types)?;
                    let input = free(|name| bound.contains_key(name), &wished);
                    inner.inputs.insert(input.clone(), entry);
                    bound.insert(input.clone(), binding.clone());
                    input
                }
            };
            *binding = Binding::Input(input);
        }
        inner.nodes.insert(node.clone(), entry);
    }

    // What is read of them, in the order in which it is read.
    let outside = body.nodes.iter().filter(|(node, _)| !inside.contains(node));
    let read = outside.flat_map(|(_, node)| node.inputs.values());
    let read = read.filter_map(|binding| match binding {
        Binding::Node(reference) => Some(reference),
        _ => None,
    });
    let mut outputs: Vec<&Reference> = Vec::new();
    for reference in read.chain(body.outputs.values()) {
        if inside.contains(&reference.node) && !outputs.contains(&reference) {
            outputs.push(reference);
        }
    }
    let last = inside.last().expect("there is a node").clone();
    let unread = Reference::new(last);
    if outputs.is_empty() {
        outputs.push(&unread);
    }
    if outputs.iter().any(|reference| types(reference).is_none()) {
        // A material is all of its parts, which a sub-graph cannot pass on; and of what has mistakes
        // nobody knows what it would be.
        return Err(Box::new(
            Diagnostic::error(
                "group-unknown",
                "what is read of these nodes is no single value",
            )
            .because("a node among them is a material, or has mistakes")
            .help("leave it outside of the sub-graph"),
        ));
    }
    let outputs: Vec<(Reference, String)> = {
        let single = outputs.len() == 1;
        let mut named: Vec<(Reference, String)> = Vec::new();
        for reference in outputs {
            let wished = match &*reference.output {
                _ if single => "out".to_owned(),
                "out" => reference.node.clone(),
                output => format!("{}_{output}", reference.node),
            };
            let output = free(|name| named.iter().any(|(_, known)| known == name), &wished);
            named.push((reference.clone(), output));
        }
        named
    };
    for (reference, output) in &outputs {
        inner.outputs.insert(output.clone(), reference.clone());
    }

    let index = body.nodes.get_index_of(&inside[0]).expect("it is there");
    for node in &inside {
        recorder.node(graph, node, None);
    }
    recorder.graph(name, Some(inner));
    let node = NodeEntry {
        ty: format!("graph:{name}"),
        inputs: bound,
        ..NodeEntry::default()
    };
    recorder.node_at(graph, index, name, Some(node));
    let moved = |reference: &Reference| {
        let (_, output) = outputs.iter().find(|(known, _)| known == reference)?;
        Some(Reference::to(name, output.clone()))
    };
    rebind(recorder, graph, |binding| match binding {
        Binding::Node(reference) => moved(reference).map(|moved| Some(Binding::Node(moved))),
        _ => None,
    });
    redirect(recorder, graph, |reference| moved(reference).map(Some));
    Ok(())
}

/// Whether a node outside reads one inside and is read by one.
fn outside_between(body: &Body, inside: &[String]) -> bool {
    let is_inside = |name: &str| inside.iter().any(|node| node == name);
    let reads = |node: &NodeEntry| -> Vec<String> {
        let nodes = node.inputs.values().filter_map(|binding| match binding {
            Binding::Node(reference) => Some(reference.node.clone()),
            _ => None,
        });
        nodes.collect()
    };
    let mut pending: Vec<String> = (inside.iter())
        .flat_map(|node| reads(&body.nodes[node]))
        .filter(|node| !is_inside(node))
        .collect();
    let mut seen: Map<()> = Map::default();
    while let Some(name) = pending.pop() {
        if is_inside(&name) {
            return true;
        }
        if seen.insert(name.clone(), ()).is_none()
            && let Some(node) = body.nodes.get(&name)
        {
            pending.extend(reads(node));
        }
    }
    false
}

/// The input of a sub-graph that stands for what is read outside of it, and the name that suits it.
fn input(
    body: &Body,
    binding: &Binding,
    graph: &Option<String>,
    types: Types<'_>,
) -> Result<(String, InputEntry), Refused> {
    match binding {
        Binding::Input(name) => {
            let entry = body.inputs.get(name).cloned();
            let entry = entry.ok_or_else(|| {
                let message = format!("there is no input `{name}` that the nodes read");
                refuse("unknown-input", message)
            })?;
            Ok((name.clone(), entry))
        }
        Binding::Node(reference) => {
            let ty = types(reference).ok_or_else(|| {
                let node = &reference.node;
                let place = match graph {
                    Some(graph) => format!(" of `{graph}`"),
                    None => String::new(),
                };
                let diagnostic = Diagnostic::error(
                    "group-unknown",
                    format!("the type of what is read of `{node}`{place} is not known"),
                );
                Box::new(diagnostic.help("mend the mistakes of the graph first"))
            })?;
            let entry = InputEntry {
                ty: ty.name().to_owned(),
                value: zero(ty),
                ..InputEntry::default()
            };
            Ok((reference.node.clone(), entry))
        }
        Binding::Value(_) => unreachable!("a literal stays where it is"),
    }
}

/// The literal 0 of a type.
fn zero(ty: Type) -> Value {
    match ty {
        Type::Boolean => false.into(),
        Type::Float | Type::Integer => 0.into(),
        _ => vec![0; ty.components()].into(),
    }
}

/// Puts the nodes of a sub-graph in the place of a node that uses it.
pub(super) fn ungroup(
    recorder: &mut Recorder<'_>,
    graph: &Option<String>,
    name: &str,
) -> Result<(), Refused> {
    let body = recorder.body(graph);
    let [node] = &chosen(body, &[name.to_owned()])?[..] else {
        unreachable!("one name is one node")
    };
    let user = body.nodes[node].clone();
    let sub = user.ty.strip_prefix("graph:").map(str::to_owned);
    let inner = sub
        .as_ref()
        .and_then(|sub| recorder.document().graphs.get(sub));
    let (Some(sub), Some(inner)) = (sub.clone(), inner.cloned()) else {
        let message = format!("`{name}` is not the node of a sub-graph of this document");
        return Err(refuse("no-sub-graph", message));
    };
    if graph.as_ref() == Some(&sub) {
        return Err(refuse(
            "cycle",
            format!("`{name}` is inside of its own sub-graph"),
        ));
    }

    let index = body.nodes.get_index_of(node).expect("it is there");
    let mut names: Map<String> = Map::default();
    for own in inner.nodes.keys() {
        let is_taken = |free: &str| {
            (free != name && body.nodes.contains_key(free))
                || names.values().any(|known| known == free)
        };
        let free = free(is_taken, own);
        names.insert(own.clone(), free);
    }
    recorder.node(graph, name, None);
    for (offset, (own, mut entry)) in inner.nodes.into_iter().enumerate() {
        let inputs = std::mem::take(&mut entry.inputs);
        for (port, binding) in inputs {
            let binding = match binding {
                Binding::Value(_) => Some(binding),
                Binding::Node(reference) => names
                    .get(&reference.node)
                    .map(|moved| Binding::Node(Reference::to(moved, reference.output))),
                Binding::Input(input) => user.inputs.get(&input).cloned().or_else(|| {
                    let entry = inner.inputs.get(&input)?;
                    Some(Binding::Value(spread(entry)))
                }),
            };
            entry.inputs.extend(binding.map(|binding| (port, binding)));
        }
        recorder.node_at(graph, index + offset, &names[&own], Some(entry));
    }
    let outputs: Map<Reference> = inner.outputs;
    let moved =
        |reference: &Reference| {
            if reference.node != name {
                return None;
            }
            let inner = outputs.get(&reference.output);
            Some(inner.and_then(|inner| {
                Some(Reference::to(names.get(&inner.node)?, inner.output.clone()))
            }))
        };
    // The new nodes may be called as the old one was: they read none of it.
    let own: Vec<&String> = names.values().collect();
    let readers: Vec<(String, NodeEntry)> = (recorder.body(graph).nodes.iter())
        .filter(|(node, _)| !own.contains(node))
        .map(|(node, entry)| (node.clone(), entry.clone()))
        .collect();
    for (node, mut entry) in readers {
        let before = entry.clone();
        entry.inputs.retain(|_, binding| match binding {
            Binding::Node(reference) => match moved(reference) {
                Some(Some(to)) => {
                    *reference = to;
                    true
                }
                Some(None) => false,
                None => true,
            },
            _ => true,
        });
        if entry != before {
            recorder.node(graph, &node, Some(entry));
        }
    }
    redirect(recorder, graph, moved);

    let ty = user.ty;
    let is_used = scopes(recorder.document()).iter().any(|scope| {
        recorder
            .body(scope)
            .nodes
            .values()
            .any(|node| node.ty == ty)
    });
    if !is_used {
        recorder.graph(&sub, None);
    }
    Ok(())
}

/// The default of an input as a literal that has the input's type wherever it stands.
fn spread(entry: &InputEntry) -> Value {
    let components = Type::by_name(&entry.ty).map_or(0, Type::components);
    match &entry.value {
        Value::Number(_) if components > 1 => vec![entry.value.clone(); components].into(),
        value => value.clone(),
    }
}
