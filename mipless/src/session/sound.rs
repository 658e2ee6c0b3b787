//! The part of a graph that no mistake reaches.

use mipless_graph::{Diagnostic, Graph, Literal, Node, NodeId, Source, Type};
use rustc_hash::FxHashSet;

/// The places of errors.
#[derive(Default)]
struct Broken<'d> {
    /// Pointers of nodes.
    nodes: FxHashSet<&'d str>,
    /// Beginnings of the pointers of all nodes of sub-graphs, `/graphs/NAME/`.
    graphs: Vec<String>,
    /// Names of nodes, one of which may be a sub-graph of which all nodes are meant.
    names: FxHashSet<String>,
    /// Names of inputs and of outputs of the graph.
    inputs: FxHashSet<String>,
    outputs: FxHashSet<String>,
    /// Whether a mistake has no place among these.
    everything: bool,
}

fn unescaped(segment: &str) -> String {
    segment.replace("~1", "/").replace("~0", "~")
}

impl<'d> Broken<'d> {
    fn of(diagnostics: &'d [Diagnostic]) -> Self {
        let mut broken = Self::default();
        for diagnostic in diagnostics.iter().filter(|d| d.is_error()) {
            let pointer = diagnostic.pointer.as_deref().unwrap_or_default();
            let segments: Vec<&str> = pointer.split('/').skip(1).collect();
            match segments[..] {
                ["nodes", name, ..] => {
                    broken.nodes.insert(&pointer[..7 + name.len()]);
                    broken.names.insert(unescaped(name));
                }
                ["graphs", graph, "nodes", name, ..] => {
                    let length = "/graphs/".len() + graph.len() + "/nodes/".len() + name.len();
                    broken.nodes.insert(&pointer[..length]);
                    broken.names.insert(unescaped(name));
                }
                ["graphs", graph, ..] => broken.graphs.push(format!("/graphs/{graph}/")),
                ["inputs", name, ..] => {
                    broken.inputs.insert(unescaped(name));
                }
                ["outputs", name, ..] => {
                    broken.outputs.insert(unescaped(name));
                }
                // Without any output there is nothing to keep either.
                ["outputs"] => {}
                _ => broken.everything = true,
            }
        }
        broken
    }

    fn has(&self, node: &Node) -> bool {
        // The path of a node in sub-graphs names the nodes that they are.
        let inside = |name: &String| {
            let path = node.name.as_str();
            path.match_indices(name.as_str()).any(|(at, _)| {
                let before = at == 0 || path[..at].ends_with('/');
                before && path[at + name.len()..].starts_with('/')
            })
        };
        self.nodes.contains(node.pointer.as_str())
            || (self.graphs.iter()).any(|graph| node.pointer.starts_with(graph))
            || (node.name.contains('/') && self.names.iter().any(inside))
    }

    fn is_empty(&self) -> bool {
        self.nodes.is_empty()
            && self.graphs.is_empty()
            && self.inputs.is_empty()
            && self.outputs.is_empty()
            && !self.everything
    }
}

fn reads(node: &Node) -> impl Iterator<Item = NodeId> {
    node.inputs.iter().filter_map(|input| match input.source {
        Source::Node(id) => Some(id),
        _ => None,
    })
}

/// Leaves of a graph the outputs that no error reaches, and the nodes that they need.
pub(super) fn keep_sound(graph: &mut Graph, diagnostics: &[Diagnostic]) {
    let broken = Broken::of(diagnostics);
    if broken.everything {
        graph.outputs.clear();
        return;
    }
    if !broken.is_empty() {
        let mut reached = vec![false; graph.nodes.len()];
        let is_reached = |node: &Node, reached: &[bool]| {
            let by_input = node.inputs.iter().any(|input| match input.source {
                Source::Parameter(id) => broken.inputs.contains(&graph.parameters[id.index()].name),
                _ => false,
            });
            by_input || broken.has(node) || reads(node).any(|id| reached[id.index()])
        };
        for index in 0..graph.nodes.len() {
            reached[index] = is_reached(&graph.nodes[index], &reached);
        }
        graph.materials.retain(|node| !is_reached(node, &reached));
        graph.outputs.retain(|output| {
            !reached[output.node.index()] && !broken.outputs.contains(&output.name)
        });
    }
    keep_needed(graph);
}

/// Leaves of a graph the nodes that its outputs need, in their order, so that what nothing reads changes
/// nothing.
fn keep_needed(graph: &mut Graph) {
    let mut needed = vec![false; graph.nodes.len()];
    for output in &graph.outputs {
        needed[output.node.index()] = true;
    }
    for material in &graph.materials {
        for id in reads(material) {
            needed[id.index()] = true;
        }
    }
    for index in (0..graph.nodes.len()).rev() {
        if needed[index] {
            for id in reads(&graph.nodes[index]) {
                needed[id.index()] = true;
            }
        }
    }
    if needed.iter().all(|needed| *needed) {
        return;
    }
    let mut next = 0;
    let moved: Vec<NodeId> = (needed.iter())
        .map(|&needed| {
            let id = NodeId(next);
            next += u32::from(needed);
            id
        })
        .collect();
    let mut at = 0;
    graph.nodes.retain(|_| {
        at += 1;
        needed[at - 1]
    });
    for node in graph.nodes.iter_mut().chain(&mut graph.materials) {
        for input in &mut node.inputs {
            if let Source::Node(id) = &mut input.source {
                *id = moved[id.index()];
            }
        }
    }
    for output in &mut graph.outputs {
        output.node = moved[output.node.index()];
    }
    let named: FxHashSet<&str> = (graph.nodes.iter().chain(&graph.materials))
        .flat_map(|node| &node.inputs)
        .filter(|input| input.ty == Type::Filename)
        .filter_map(|input| match &input.source {
            Source::Literal(Literal::Text(name)) => Some(name.as_str()),
            _ => None,
        })
        .collect();
    let mut images = mipless_graph::Images::default();
    for name in graph.images.names().filter(|name| named.contains(name)) {
        if let Some(picture) = graph.images.get(name) {
            images.insert(name, picture.clone());
        }
    }
    graph.images = images;
}
