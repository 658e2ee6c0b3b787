//! What an edit does to a document.

use super::edit::Edit;
use super::group::{group, ungroup};
use super::patch::Recorder;
use super::rewire::{
    Refused, Types, chosen, follow_input, follow_output, free, missing, node, rebind, redirect,
    refuse, taken,
};
use mipless_graph::{Binding, Body, Diagnostic, Document, InputEntry, Map, NodeEntry, Reference};
use serde_json::{Map as Members, Value, json};

/// Reads part of a document by the reader of documents, so that it means the same.
fn fragment(json: &Value) -> Result<Document, Refused> {
    let (document, mistakes) = Document::parse(&json.to_string());
    match (document, mistakes.into_iter().next()) {
        (Some(document), None) => Ok(document),
        (_, Some(mistake)) => Err(Box::new(Diagnostic {
            line: None,
            column: None,
            ..mistake
        })),
        (None, None) => Err(refuse("syntax", "it is no part of a graph")),
    }
}

fn nodes_of(nodes: &Members<String, Value>) -> Result<Map<NodeEntry>, Refused> {
    let json = json!({ "version": 1, "nodes": nodes, "outputs": {} });
    Ok(fragment(&json)?.body.nodes)
}

/// Sets or takes an input of a node.
fn bind(
    recorder: &mut Recorder<'_>,
    graph: &Option<String>,
    name: &str,
    input: &str,
    binding: Option<Binding>,
) -> Result<(), Refused> {
    let mut entry = node(recorder.body(graph), name)?.clone();
    match binding {
        Some(binding) => {
            entry.inputs.insert(input.to_owned(), binding);
        }
        None => {
            let absent = || missing("unknown-port", "binding of", input, entry.inputs.keys());
            if !entry.inputs.contains_key(input) {
                return Err(Box::new(absent().in_node(name)));
            }
            entry.inputs.shift_remove(input);
        }
    }
    recorder.node(graph, name, Some(entry));
    Ok(())
}

/// The stops of an input of a node.
fn stops(body: &Body, name: &str, input: &str) -> Result<Vec<Value>, Refused> {
    match node(body, name)?.inputs.get(input) {
        Some(Binding::Value(Value::Array(stops))) => Ok(stops.clone()),
        _ => Err(Box::new(
            Diagnostic::error("no-stops", format!("`{input}` of `{name}` holds no stops"))
                .in_node(name)
                .in_port(input)
                .help("set all of them first: `[{ \"at\": 0, \"value\": 0 }, { \"at\": 1, \"value\": 1 }]`"),
        )),
    }
}

fn binding(json: &Value) -> Result<Binding, Refused> {
    Binding::from_json(json).map_err(|reason| refuse("wrong-connection", reason))
}

/// A literal that a graph may have as the value of an input.
fn literal(json: &Value) -> Result<Value, Refused> {
    match binding(json)? {
        Binding::Value(value) => Ok(value),
        Binding::Node(_) | Binding::Input(_) => Err(refuse(
            "wrong-connection",
            "the value of an input of a graph is a literal",
        )),
    }
}

/// Removes a binding to what is not there.
fn without_strangers(entry: &mut NodeEntry, body: &Body, also: impl Fn(&str) -> bool) {
    entry.inputs.retain(|_, binding| match binding {
        Binding::Node(reference) => {
            body.nodes.contains_key(&reference.node) || also(&reference.node)
        }
        Binding::Input(input) => body.inputs.contains_key(input),
        Binding::Value(_) => true,
    });
}

/// Adds nodes under names that are free, with what they read of each other.
fn paste(recorder: &mut Recorder<'_>, graph: &Option<String>, nodes: Map<NodeEntry>) {
    let mut names: Map<String> = Map::default();
    for name in nodes.keys() {
        let body = recorder.body(graph);
        let is_taken =
            |free: &str| body.nodes.contains_key(free) || names.values().any(|known| known == free);
        names.insert(name.clone(), free(is_taken, name));
    }
    for (name, mut entry) in nodes {
        without_strangers(&mut entry, recorder.body(graph), |node| {
            names.contains_key(node)
        });
        for binding in entry.inputs.values_mut() {
            if let Binding::Node(reference) = binding
                && let Some(copy) = names.get(&reference.node)
            {
                reference.node.clone_from(copy);
            }
        }
        recorder.node(graph, &names[&name], Some(entry));
    }
}

/// Does the edit; where it is refused, what the recorder has done is to be taken back.
pub(super) fn apply(
    recorder: &mut Recorder<'_>,
    edit: &Edit,
    types: Types<'_>,
) -> Result<(), Refused> {
    if let Some(graph) = scope(edit)
        && !recorder.document().graphs.contains_key(graph)
    {
        let names = recorder.document().graphs.keys();
        return Err(missing("unknown-graph", "sub-graph", graph, names));
    }
    match edit {
        Edit::Add { graph, nodes } => {
            for (name, entry) in nodes_of(nodes)? {
                if recorder.body(graph).nodes.contains_key(&name) {
                    return Err(taken("a node", &name));
                }
                recorder.node(graph, &name, Some(entry));
            }
        }
        Edit::Paste { graph, nodes } => paste(recorder, graph, nodes_of(nodes)?),
        Edit::Duplicate { graph, nodes } => {
            let body = recorder.body(graph);
            let copies = chosen(body, nodes)?.into_iter();
            let copies = copies.map(|name| (name.clone(), body.nodes[&name].clone()));
            let copies = copies.collect();
            paste(recorder, graph, copies);
        }
        Edit::Remove { graph, nodes } => {
            let removed = chosen(recorder.body(graph), nodes)?;
            for name in &removed {
                recorder.node(graph, name, None);
            }
            let gone = |reference: &Reference| removed.contains(&reference.node);
            rebind(recorder, graph, |binding| match binding {
                Binding::Node(reference) if gone(reference) => Some(None),
                _ => None,
            });
            let outputs = redirect(recorder, graph, |reference| gone(reference).then_some(None));
            for output in outputs {
                follow_output(recorder, graph, &output, None);
            }
        }
        Edit::Rename {
            graph,
            node: name,
            to,
        } => {
            let body = recorder.body(graph);
            let entry = node(body, name)?.clone();
            if name == to {
                return Ok(());
            }
            if body.nodes.contains_key(to) {
                return Err(taken("a node", to));
            }
            let index = body.nodes.get_index_of(name).expect("it is there");
            recorder.node(graph, name, None);
            recorder.node_at(graph, index, to, Some(entry));
            let moved = |reference: &Reference| {
                (reference.node == *name).then(|| Reference::to(to, reference.output.clone()))
            };
            rebind(recorder, graph, |binding| match binding {
                Binding::Node(reference) => {
                    moved(reference).map(|reference| Some(Binding::Node(reference)))
                }
                _ => None,
            });
            redirect(recorder, graph, |reference| moved(reference).map(Some));
        }
        Edit::Connect {
            graph,
            node: name,
            input,
            from,
            output,
        } => {
            node(recorder.body(graph), from)?;
            let output = output.as_deref().unwrap_or("out");
            let reference = Binding::Node(Reference::to(from, output));
            bind(recorder, graph, name, input, Some(reference))?;
        }
        Edit::Disconnect {
            graph,
            node: name,
            input,
        } => bind(recorder, graph, name, input, None)?,
        Edit::Set {
            graph,
            node: name,
            input,
            value,
        } => {
            let binding = binding(value)?;
            match &binding {
                Binding::Node(reference) => {
                    node(recorder.body(graph), &reference.node)?;
                }
                Binding::Input(input) => {
                    input_entry(recorder.body(graph), input)?;
                }
                Binding::Value(_) => {}
            }
            bind(recorder, graph, name, input, Some(binding))?;
        }
        Edit::SetStop {
            graph,
            node: name,
            input,
            index,
            at,
            value,
        } => {
            let input = input.as_deref().unwrap_or("stops");
            let mut stops = stops(recorder.body(graph), name, input)?;
            let mut stop = match stops.get(*index) {
                Some(Value::Object(stop)) => stop.clone(),
                _ => Members::new(),
            };
            if *index > stops.len() {
                return Err(no_stop(name, *index, stops.len()));
            }
            if let Some(at) = at {
                stop.insert("at".to_owned(), json!(at));
            }
            if let Some(value) = value {
                stop.insert("value".to_owned(), value.clone());
            }
            let stop = Value::Object(stop);
            match stops.get_mut(*index) {
                Some(known) => *known = stop,
                None => stops.push(stop),
            }
            let binding = binding(&Value::Array(stops))?;
            bind(recorder, graph, name, input, Some(binding))?;
        }
        Edit::RemoveStop {
            graph,
            node: name,
            input,
            index,
        } => {
            let input = input.as_deref().unwrap_or("stops");
            let mut stops = stops(recorder.body(graph), name, input)?;
            if *index >= stops.len() {
                return Err(no_stop(name, *index, stops.len()));
            }
            stops.remove(*index);
            let binding = Binding::Value(Value::Array(stops));
            bind(recorder, graph, name, input, Some(binding))?;
        }
        Edit::SetInput {
            graph,
            input,
            value,
        } => {
            let entry = input_entry(recorder.body(graph), input)?;
            let entry = InputEntry {
                value: literal(value)?,
                ..entry.clone()
            };
            recorder.input_at(graph, usize::MAX, input, Some(entry));
        }
        Edit::PutInput {
            graph,
            input,
            entry,
        } => {
            let json = json!({
                "version": 1,
                "inputs": Members::from_iter([(input.clone(), entry.clone())]),
                "nodes": {},
                "outputs": {},
            });
            let entry = fragment(&json)?.body.inputs.shift_remove(input);
            recorder.input_at(graph, usize::MAX, input, entry);
        }
        Edit::RemoveInput { graph, input } => {
            input_entry(recorder.body(graph), input)?;
            recorder.input_at(graph, usize::MAX, input, None);
            rebind(recorder, graph, |binding| match binding {
                Binding::Input(name) if name == input => Some(None),
                _ => None,
            });
            follow_input(recorder, graph, input, None);
        }
        Edit::RenameInput { graph, input, to } => {
            let body = recorder.body(graph);
            let entry = input_entry(body, input)?.clone();
            if input == to {
                return Ok(());
            }
            if body.inputs.contains_key(to) {
                return Err(taken("an input", to));
            }
            let index = body.inputs.get_index_of(input).expect("it is there");
            recorder.input_at(graph, usize::MAX, input, None);
            recorder.input_at(graph, index, to, Some(entry));
            rebind(recorder, graph, |binding| match binding {
                Binding::Input(name) if name == input => Some(Some(Binding::Input(to.clone()))),
                _ => None,
            });
            follow_input(recorder, graph, input, Some(to));
        }
        Edit::PutOutput {
            graph,
            output,
            node: name,
            port,
        } => {
            node(recorder.body(graph), name)?;
            let reference = Reference::to(name, port.as_deref().unwrap_or("out"));
            recorder.output_at(graph, usize::MAX, output, Some(reference));
        }
        Edit::RemoveOutput { graph, output } => {
            output_of(recorder.body(graph), output)?;
            recorder.output_at(graph, usize::MAX, output, None);
            follow_output(recorder, graph, output, None);
        }
        Edit::RenameOutput { graph, output, to } => {
            let body = recorder.body(graph);
            let reference = output_of(body, output)?.clone();
            if output == to {
                return Ok(());
            }
            if body.outputs.contains_key(to) {
                return Err(taken("an output", to));
            }
            let index = body.outputs.get_index_of(output).expect("it is there");
            recorder.output_at(graph, usize::MAX, output, None);
            recorder.output_at(graph, index, to, Some(reference));
            follow_output(recorder, graph, output, Some(to));
        }
        Edit::Group { graph, nodes, name } => group(recorder, graph, nodes, name, types)?,
        Edit::Ungroup { graph, node } => ungroup(recorder, graph, node)?,
        Edit::SetName { name } => recorder.name(name.clone()),
        Edit::SetDoc {
            graph,
            node: Some(name),
            doc,
        } => {
            let mut entry = node(recorder.body(graph), name)?.clone();
            entry.doc.clone_from(doc);
            recorder.node(graph, name, Some(entry));
        }
        Edit::SetDoc {
            graph,
            node: None,
            doc,
        } => recorder.doc(graph, doc.clone()),
        Edit::SetExtra {
            graph,
            node: Some(name),
            extra,
        } => {
            let mut entry = node(recorder.body(graph), name)?.clone();
            entry.extra.clone_from(extra);
            recorder.node(graph, name, Some(entry));
        }
        Edit::SetExtra {
            graph,
            node: None,
            extra,
        } => recorder.extra(graph, extra.clone()),
    }
    Ok(())
}

fn no_stop(node: &str, index: usize, count: usize) -> Refused {
    let message = format!("`{node}` has no stop {index}: it has {count}");
    refuse("no-stop", message)
}

fn input_entry<'r>(body: &'r Body, name: &str) -> Result<&'r InputEntry, Refused> {
    let missing = || missing("unknown-input", "input", name, body.inputs.keys());
    body.inputs.get(name).ok_or_else(missing)
}

fn output_of<'r>(body: &'r Body, name: &str) -> Result<&'r Reference, Refused> {
    let missing = || missing("unknown-output", "output", name, body.outputs.keys());
    body.outputs.get(name).ok_or_else(missing)
}

/// The sub-graph that an edit is in.
fn scope(edit: &Edit) -> Option<&String> {
    match edit {
        Edit::Add { graph, .. }
        | Edit::Paste { graph, .. }
        | Edit::Duplicate { graph, .. }
        | Edit::Remove { graph, .. }
        | Edit::Rename { graph, .. }
        | Edit::Connect { graph, .. }
        | Edit::Disconnect { graph, .. }
        | Edit::Set { graph, .. }
        | Edit::SetStop { graph, .. }
        | Edit::RemoveStop { graph, .. }
        | Edit::SetInput { graph, .. }
        | Edit::PutInput { graph, .. }
        | Edit::RemoveInput { graph, .. }
        | Edit::RenameInput { graph, .. }
        | Edit::PutOutput { graph, .. }
        | Edit::RemoveOutput { graph, .. }
        | Edit::RenameOutput { graph, .. }
        | Edit::Group { graph, .. }
        | Edit::Ungroup { graph, .. }
        | Edit::SetDoc { graph, .. }
        | Edit::SetExtra { graph, .. } => graph.as_ref(),
        Edit::SetName { .. } => None,
    }
}
