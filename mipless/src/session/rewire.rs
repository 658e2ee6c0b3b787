//! What edits share: names that are there or free, and what reads what.

use super::patch::Recorder;
use mipless_graph::{Binding, Body, Diagnostic, Document, NodeEntry, Reference, Type, suggest};

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

pub(super) fn taken(what: &str, name: &str) -> Refused {
    refuse("name-taken", format!("there is {what} `{name}` already"))
}

/// The node of that name in the body.
pub(super) fn node<'r>(body: &'r Body, name: &str) -> Result<&'r NodeEntry, Refused> {
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

/// The nodes of a scope that use a sub-graph.
fn users(recorder: &Recorder<'_>, scope: &Option<String>, name: &str) -> Vec<(String, NodeEntry)> {
    let ty = format!("graph:{name}");
    let nodes = recorder.body(scope).nodes.iter();
    nodes
        .filter(|(_, node)| node.ty == ty)
        .map(|(name, node)| (name.clone(), node.clone()))
        .collect()
}

/// What uses a sub-graph reads another output of it, or none.
pub(super) fn follow_output(
    recorder: &mut Recorder<'_>,
    graph: &Option<String>,
    from: &str,
    to: Option<&str>,
) {
    let Some(name) = graph else { return };
    for scope in scopes(recorder.document()) {
        let users = users(recorder, &scope, name);
        let is_user = |node: &str| users.iter().any(|(user, _)| user == node);
        let reads = |reference: &Reference| reference.output == from && is_user(&reference.node);
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
pub(super) fn follow_input(
    recorder: &mut Recorder<'_>,
    graph: &Option<String>,
    from: &str,
    to: Option<&str>,
) {
    let Some(graph) = graph else { return };
    for scope in scopes(recorder.document()) {
        for (name, mut node) in users(recorder, &scope, graph) {
            let Some((index, _, binding)) = node.inputs.shift_remove_full(from) else {
                continue;
            };
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
