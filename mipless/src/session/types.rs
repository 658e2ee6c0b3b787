//! The types of what nodes give, looked up by what a document says.

use mipless_graph::{Document, Graph, Reference, Type};

/// The type of an output of a node of a body; in a sub-graph, that which it has where it is used first.
/// `None` for a material, and for what has mistakes.
pub(super) fn of(
    graph: &Graph,
    document: &Document,
    scope: &Option<String>,
    reference: &Reference,
) -> Option<Type> {
    let mut scope = scope.clone();
    let mut reference = reference.clone();
    // Sub-graphs contain each other without a circle, or there is no graph.
    for _ in 0..=document.graphs.len() {
        let body = match &scope {
            None => &document.body,
            Some(name) => document.graphs.get(name)?,
        };
        let entry = body.nodes.get(&reference.node)?;
        let Some(inner) = entry.ty.strip_prefix("graph:") else {
            let node = escaped(&reference.node);
            let pointer = match &scope {
                None => format!("/nodes/{node}"),
                Some(name) => format!("/graphs/{}/nodes/{node}", escaped(name)),
            };
            let output = (reference.output != "out").then(|| format!(".{}", reference.output));
            let path = format!("/{}", reference.node);
            let is_it = |name: &str| match &output {
                Some(output) => name.ends_with(output.as_str()),
                None => name == reference.node || name.ends_with(&path),
            };
            let found =
                (graph.nodes.iter()).find(|node| node.pointer == pointer && is_it(&node.name))?;
            return found.part().is_none().then_some(found.ty);
        };
        let outputs = &document.graphs.get(inner)?.outputs;
        reference = outputs.get(&reference.output)?.clone();
        scope = Some(inner.to_owned());
    }
    None
}

/// A segment of a JSON pointer (RFC 6901 §3).
fn escaped(segment: &str) -> String {
    segment.replace('~', "~0").replace('/', "~1")
}
