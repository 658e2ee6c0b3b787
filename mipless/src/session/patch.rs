//! The smallest changes of a document, each with the one that takes it back.

use mipless_graph::{Body, Document, InputEntry, Map, NodeEntry, Reference};
use serde_json::Value;

/// What a place of a list holds, or that it is not there.
#[derive(Clone, Debug)]
pub(super) struct Slot<V> {
    index: usize,
    name: String,
    value: Option<V>,
}

/// One place of a document and what it is to hold. `graph` names a sub-graph.
#[derive(Clone, Debug)]
pub(super) enum Patch {
    Node(Option<String>, Slot<NodeEntry>),
    Input(Option<String>, Slot<InputEntry>),
    Output(Option<String>, Slot<Reference>),
    Graph(Slot<Body>),
    Name(Option<String>),
    Doc(Option<String>, Option<String>),
    Extra(Option<String>, Option<Value>),
}

/// A document while it is edited, and what takes back what has been done to it.
pub(super) struct Recorder<'d> {
    document: &'d mut Document,
    inverse: Vec<Patch>,
}

/// Puts a value in its place, and gives what was there.
fn put<V>(map: &mut Map<V>, slot: Slot<V>) -> Slot<V> {
    let Slot { index, name, value } = slot;
    match (map.get_index_of(&name), value) {
        (Some(index), Some(value)) => {
            let before = std::mem::replace(&mut map[index], value);
            Slot {
                index,
                name,
                value: Some(before),
            }
        }
        (Some(index), None) => Slot {
            index,
            value: map.shift_remove(&name),
            name,
        },
        (None, Some(value)) => {
            let index = index.min(map.len());
            map.shift_insert(index, name.clone(), value);
            Slot {
                index,
                name,
                value: None,
            }
        }
        (None, None) => Slot {
            index,
            name,
            value: None,
        },
    }
}

/// The graph, or the sub-graph of that name.
pub(super) fn body<'d>(document: &'d Document, graph: &Option<String>) -> &'d Body {
    match graph {
        None => &document.body,
        Some(name) => &document.graphs[name],
    }
}

fn body_mut<'d>(document: &'d mut Document, graph: &Option<String>) -> &'d mut Body {
    match graph {
        None => &mut document.body,
        Some(name) => &mut document.graphs[name],
    }
}

impl Patch {
    /// Changes the document, and gives what takes the change back.
    pub(super) fn apply(self, document: &mut Document) -> Self {
        match self {
            Self::Node(graph, slot) => {
                let before = put(&mut body_mut(document, &graph).nodes, slot);
                Self::Node(graph, before)
            }
            Self::Input(graph, slot) => {
                let before = put(&mut body_mut(document, &graph).inputs, slot);
                Self::Input(graph, before)
            }
            Self::Output(graph, slot) => {
                let before = put(&mut body_mut(document, &graph).outputs, slot);
                Self::Output(graph, before)
            }
            Self::Graph(slot) => Self::Graph(put(&mut document.graphs, slot)),
            Self::Name(name) => Self::Name(std::mem::replace(&mut document.name, name)),
            Self::Doc(graph, doc) => {
                let before = std::mem::replace(&mut body_mut(document, &graph).doc, doc);
                Self::Doc(graph, before)
            }
            Self::Extra(graph, extra) => {
                let before = std::mem::replace(&mut body_mut(document, &graph).extra, extra);
                Self::Extra(graph, before)
            }
        }
    }
}

/// Applies what takes changes back, the last first.
pub(super) fn revert(document: &mut Document, inverse: Vec<Patch>) {
    for patch in inverse.into_iter().rev() {
        patch.apply(document);
    }
}

impl<'d> Recorder<'d> {
    pub(super) fn new(document: &'d mut Document) -> Self {
        Self {
            document,
            inverse: Vec::new(),
        }
    }

    pub(super) fn document(&self) -> &Document {
        self.document
    }

    pub(super) fn body(&self, graph: &Option<String>) -> &Body {
        body(self.document, graph)
    }

    fn apply(&mut self, patch: Patch) {
        let inverse = patch.apply(self.document);
        self.inverse.push(inverse);
    }

    /// What takes back all that has been done.
    pub(super) fn finish(self) -> Vec<Patch> {
        self.inverse
    }

    pub(super) fn node(&mut self, graph: &Option<String>, name: &str, node: Option<NodeEntry>) {
        self.node_at(graph, usize::MAX, name, node);
    }

    /// A new node at a place among the others.
    pub(super) fn node_at(
        &mut self,
        graph: &Option<String>,
        index: usize,
        name: &str,
        value: Option<NodeEntry>,
    ) {
        let name = name.to_owned();
        self.apply(Patch::Node(graph.clone(), Slot { index, name, value }));
    }

    pub(super) fn input_at(
        &mut self,
        graph: &Option<String>,
        index: usize,
        name: &str,
        value: Option<InputEntry>,
    ) {
        let name = name.to_owned();
        self.apply(Patch::Input(graph.clone(), Slot { index, name, value }));
    }

    pub(super) fn output_at(
        &mut self,
        graph: &Option<String>,
        index: usize,
        name: &str,
        value: Option<Reference>,
    ) {
        let name = name.to_owned();
        self.apply(Patch::Output(graph.clone(), Slot { index, name, value }));
    }

    pub(super) fn graph(&mut self, name: &str, value: Option<Body>) {
        let (index, name) = (usize::MAX, name.to_owned());
        self.apply(Patch::Graph(Slot { index, name, value }));
    }

    pub(super) fn name(&mut self, name: Option<String>) {
        self.apply(Patch::Name(name));
    }

    pub(super) fn doc(&mut self, graph: &Option<String>, doc: Option<String>) {
        self.apply(Patch::Doc(graph.clone(), doc));
    }

    pub(super) fn extra(&mut self, graph: &Option<String>, extra: Option<Value>) {
        self.apply(Patch::Extra(graph.clone(), extra));
    }
}
