//! A node alone: what a preview shows of a document.

use super::rewire::{Refused, missing, refuse};
use mipless_graph::{Binding, Document, Graph, Map, NodeEntry, Output, Reference};

/// What the output of a preview is called.
const PREVIEW: &str = "preview";

/// The node of the graph itself that a path names or leads into. A node may be called as the beginning of
/// another one's path: the longest name counts.
fn outermost<'d>(document: &'d Document, path: &str) -> Option<(&'d str, &'d NodeEntry)> {
    let ends = path.match_indices('/').map(|(end, _)| end);
    let ends: Vec<usize> = ends.chain([path.len()]).collect();
    (ends.into_iter().rev())
        .find_map(|end| document.body.nodes.get_key_value(&path[..end]))
        .map(|(name, entry)| (name.as_str(), entry))
}

/// The document of what a node needs, with the node as its output, and whether the node is inside of a
/// sub-graph.
pub(super) fn alone(
    document: &Document,
    path: &str,
    port: &str,
) -> Result<(Document, bool), Refused> {
    let Some((top, entry)) = outermost(document, path) else {
        let names = document.body.nodes.keys();
        return Err(missing("unknown-node", "node", path, names));
    };
    let inner = top.len() < path.len();
    let sub = entry.ty.strip_prefix("graph:");
    if inner && sub.is_none() {
        return Err(refuse("unknown-node", format!("`{top}` is no sub-graph")));
    }
    let outputs = sub.and_then(|name| Some(&document.graphs.get(name)?.outputs));
    let output = match outputs {
        Some(outputs) if inner || !outputs.contains_key(port) => {
            outputs.keys().next().map_or(port, String::as_str)
        }
        _ => port,
    };
    let mut alone = Document {
        name: document.name.clone(),
        graphs: document.graphs.clone(),
        ..Document::default()
    };
    alone.body.inputs = document.body.inputs.clone();
    let mut needed: Map<()> = Map::default();
    let mut pending = vec![top];
    while let Some(name) = pending.pop() {
        let Some(entry) = document.body.nodes.get(name) else {
            continue;
        };
        if needed.insert(name.to_owned(), ()).is_some() {
            continue;
        }
        pending.extend(entry.inputs.values().filter_map(|binding| match binding {
            Binding::Node(reference) => Some(reference.node.as_str()),
            _ => None,
        }));
    }
    let nodes = document.body.nodes.iter();
    alone.body.nodes = nodes
        .filter(|(name, _)| needed.contains_key(*name))
        .map(|(name, entry)| (name.clone(), entry.clone()))
        .collect();
    let reference = Reference::to(top, output);
    alone.body.outputs.insert(PREVIEW.to_owned(), reference);
    Ok((alone, inner))
}

/// Makes a node inside of a sub-graph the only output.
pub(super) fn choose(graph: &mut Graph, path: &str, port: &str) -> bool {
    let selected = format!("{path}.{port}");
    let is_it = |name: &str| {
        if port == "out" {
            name == path
        } else {
            name == selected
        }
    };
    let Some(index) = graph.nodes.iter().position(|node| is_it(&node.name)) else {
        return false;
    };
    graph.outputs = vec![Output {
        name: PREVIEW.to_owned(),
        node: mipless_graph::NodeId(u32::try_from(index).expect("fewer nodes than 2^32")),
        ty: graph.nodes[index].ty,
    }];
    graph.materials.clear();
    true
}
