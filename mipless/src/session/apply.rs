//! What an edit does to a document.

use super::edit::Edit;
use super::group::{group, ungroup};
use super::patch::Recorder;
use mipless_graph::{
    Binding, Body, Diagnostic, Document, InputEntry, Map, NodeEntry, Reference, Type, suggest,
};
use serde_json::{Map as Members, Value, json};

/// Why an edit was refused: a diagnostic about the edit, with the document as it was.
pub(super) type Refused = Box<Diagnostic>;

/// The types of the outputs of nodes of a body, as far as they are known.
pub(super) type Types<'a> = &'a dyn Fn(&Reference) -> Option<Type>;

pub(super) fn refuse(code: &'static str, message: impl Into<String>) -> Refused {
    Box::new(Diagnostic::error(code, message))
}

/// There is no such thing; the nearest name is offered.
pub(super) fn missing<'a>(
    code: &'static str,
    what: &str,
    name: &str,
    names: impl Iterator<Item = &'a String>,
) -> Refused {
    let near = suggest(name, names.map(String::as_str));
    let diagnostic = Diagnostic::error(code, format!("there is no {what} `{name}`"));
    Box::new(diagnostic.help_if(near.map(|near| format!("did you mean `{near}`?"))))
}

fn taken(what: &str, name: &str) -> Refused {
    refuse("name-taken", format!("there is {what} `{name}` already"))
}

/// The node of that name in the body.
fn node<'r>(body: &'r Body, name: &str) -> Result<&'r NodeEntry, Refused> {
    let missing = || missing("unknown-node", "node", name, body.nodes.keys());
    body.nodes.get(name).ok_or_else(missing)
}

/// The nodes of these names, each once, in the order of the body.
pub(super) fn chosen(body: &Body, names: &[String]) -> Result<Vec<String>, Refused> {
    let mut indices = Vec::with_capacity(names.len());
    for name in names {
        node(body, name)?;
        indices.extend(body.nodes.get_index_of(name));
    }
    indices.sort_unstable();
    indices.dedup();
    let name = |index: usize| body.nodes.get_index(index).map(|(name, _)| name.clone());
    Ok(indices.into_iter().filter_map(name).collect())
}

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

/// A name that is free: `name`, or that with a number.
pub(super) fn free(taken: impl Fn(&str) -> bool, name: &str) -> String {
    if !taken(name) {
        return name.to_owned();
    }
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let stem = stem.strip_suffix('_').unwrap_or(stem);
    (2u64..)
        .map(|number| format!("{stem}_{number}"))
        .find(|name| !taken(name))
        .expect("a number is free")
}

/// Lets `change` look at every binding of the nodes of a body and say what it becomes, nothing being its
/// default; `None` where it stays.
pub(super) fn rebind(
    recorder: &mut Recorder<'_>,
    graph: &Option<String>,
    change: impl Fn(&Binding) -> Option<Option<Binding>>,
) {
    let nodes = &recorder.body(graph).nodes;
    let changed: Vec<(String, NodeEntry)> = (nodes.iter())
        .filter(|(_, node)| {
            node.inputs
                .values()
                .any(|binding| change(binding).is_some())
        })
        .map(|(name, node)| {
            let bound = node.inputs.iter().filter_map(|(port, binding)| {
                let binding = change(binding).unwrap_or_else(|| Some(binding.clone()))?;
                Some((port.clone(), binding))
            });
            let node = NodeEntry {
                inputs: bound.collect(),
                ..node.clone()
            };
            (name.clone(), node)
        })
        .collect();
    for (name, node) in changed {
        recorder.node(graph, &name, Some(node));
    }
}

/// The same for the references of the outputs of a body; nothing removes the output.
pub(super) fn redirect(
    recorder: &mut Recorder<'_>,
    graph: &Option<String>,
    change: impl Fn(&Reference) -> Option<Option<Reference>>,
) -> Vec<String> {
    let outputs = recorder.body(graph).outputs.iter();
    let changed: Vec<(String, Option<Reference>)> = outputs
        .filter_map(|(name, reference)| Some((name.clone(), change(reference)?)))
        .collect();
    let mut removed = Vec::new();
    for (name, reference) in changed {
        if reference.is_none() {
            removed.push(name.clone());
        }
        recorder.output_at(graph, usize::MAX, &name, reference);
    }
    removed
}

/// What uses a sub-graph reads another output of it, or none.
fn follow_output(
    recorder: &mut Recorder<'_>,
    graph: &Option<String>,
    from: &str,
    to: Option<&str>,
) {
    let Some(name) = graph else { return };
    let ty = format!("graph:{name}");
    for scope in scopes(recorder.document()) {
        let users: Vec<String> = (recorder.body(&scope).nodes.iter())
            .filter(|(_, node)| node.ty == ty)
            .map(|(name, _)| name.clone())
            .collect();
        let reads =
            |reference: &Reference| reference.output == from && users.contains(&reference.node);
        let moved = |reference: &Reference| to.map(|to| Reference::to(reference.node.clone(), to));
        rebind(recorder, &scope, |binding| match binding {
            Binding::Node(reference) if reads(reference) => {
                Some(moved(reference).map(Binding::Node))
            }
            _ => None,
        });
        let removed = redirect(recorder, &scope, |reference| {
            reads(reference).then(|| moved(reference))
        });
        for output in removed {
            if scope != *graph {
                follow_output(recorder, &scope, &output, None);
            }
        }
    }
}

/// What uses a sub-graph binds another input of it, or none.
fn follow_input(recorder: &mut Recorder<'_>, graph: &Option<String>, from: &str, to: Option<&str>) {
    let Some(name) = graph else { return };
    let ty = format!("graph:{name}");
    for scope in scopes(recorder.document()) {
        let users: Vec<(String, NodeEntry)> = (recorder.body(&scope).nodes.iter())
            .filter(|(_, node)| node.ty == ty && node.inputs.contains_key(from))
            .map(|(name, node)| (name.clone(), node.clone()))
            .collect();
        for (name, mut node) in users {
            let (index, _, binding) = node.inputs.shift_remove_full(from).expect("it is bound");
            if let Some(to) = to {
                // A binding to an input that was not there yet gives way.
                let index = index.min(node.inputs.len());
                node.inputs.shift_insert(index, to.to_owned(), binding);
            }
            recorder.node(&scope, &name, Some(node));
        }
    }
}

/// The graph and its sub-graphs.
pub(super) fn scopes(document: &Document) -> Vec<Option<String>> {
    let graphs = document.graphs.keys().cloned().map(Some);
    std::iter::once(None).chain(graphs).collect()
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
