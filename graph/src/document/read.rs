//! A tree of JSON into a document, with every mistake of its structure.

use rustc_hash::FxHashSet;
use serde_json::Value;

use super::tree::{Json, Lines, Member, Tree};
use super::{Binding, Body, Document, InputEntry, Map, NodeEntry, Reference, VERSION, upgrade};
use crate::Diagnostic;
use crate::diagnostic::{did_you_mean, escape};

const DOCUMENT: &[&str] = &[
    "$schema", "version", "name", "doc", "inputs", "nodes", "outputs", "graphs", "extra",
];
const GRAPH: &[&str] = &["doc", "inputs", "nodes", "outputs", "extra"];
const INPUT: &[&str] = &[
    "type", "value", "min", "max", "soft_min", "soft_max", "doc", "extra",
];
const NODE: &[&str] = &["type", "inputs", "doc", "extra"];
const REFERENCE: &[&str] = &["node", "output"];
const BINDING: &[&str] = &["node", "output", "input"];

/// Reads the document, after upgrading the tree.
pub(super) fn read(text: &str, tree: &mut Tree) -> (Option<Document>, Vec<Diagnostic>) {
    let version = {
        let mut reader = Reader::new(text);
        match reader.version(tree) {
            Some(version) => version,
            None => return (None, reader.diagnostics),
        }
    };
    upgrade::upgrade(tree, version);
    let mut reader = Reader::new(text);
    let document = reader.document(tree);
    (Some(document), reader.diagnostics)
}

/// Whether the numbers of a literal are finite as f32; else what to say of one that is not.
pub(super) fn finite(literal: &Value) -> Result<(), String> {
    // JSON that serde has read is at most 128 deep, so that this stack stays small.
    let mut rest = vec![literal];
    while let Some(value) = rest.pop() {
        match value {
            Value::Number(number) => {
                let finite = |number: f64| (number as f32).is_finite();
                if !number.as_f64().is_some_and(finite) {
                    return Err(format!("{number} is not finite as a 32-bit float"));
                }
            }
            Value::Array(items) => rest.extend(items),
            Value::Object(members) => rest.extend(members.values()),
            Value::Null | Value::Bool(_) | Value::String(_) => {}
        }
    }
    Ok(())
}

/// A segment of the pointer to the value that is being read.
#[derive(Clone, Copy)]
enum Segment<'t> {
    Key(&'t str),
    Index(usize),
}

struct Reader<'t> {
    text: &'t str,
    /// Made at the first mistake: most documents have none.
    lines: Option<Lines<'t>>,
    path: Vec<Segment<'t>>,
    diagnostics: Vec<Diagnostic>,
}

impl<'t> Reader<'t> {
    fn new(text: &'t str) -> Self {
        Self {
            text,
            lines: None,
            path: Vec::new(),
            diagnostics: Vec::new(),
        }
    }

    /// Reports a mistake at the current path, which lies at this byte.
    fn report(&mut self, at: usize, mut diagnostic: Diagnostic) {
        let mut pointer = String::new();
        for segment in &self.path {
            pointer.push('/');
            match segment {
                Segment::Key(key) => pointer.push_str(&escape(key)),
                Segment::Index(index) => pointer.push_str(&index.to_string()),
            }
        }
        let inside = match self.path.as_slice() {
            [Segment::Key("graphs"), _, inside @ ..] | inside => inside,
        };
        if let [Segment::Key("nodes"), Segment::Key(node), rest @ ..] = inside {
            diagnostic = diagnostic.in_node(*node);
            if let [Segment::Key("inputs"), Segment::Key(port), ..] = rest {
                diagnostic = diagnostic.in_port(*port);
            }
        }
        let text = self.text;
        let lines = self.lines.get_or_insert_with(|| Lines::new(text));
        let (line, column) = lines.position(at);
        self.diagnostics
            .push(diagnostic.at(pointer).at_line(line, column));
    }

    /// Does something one step deeper.
    fn within<T>(&mut self, segment: Segment<'t>, inner: impl FnOnce(&mut Self) -> T) -> T {
        self.path.push(segment);
        let result = inner(self);
        self.path.pop();
        result
    }

    fn wrong(&mut self, tree: &Tree, wanted: &str) {
        let message = format!("{wanted} is wanted here, not {}", tree.value.kind());
        self.report(tree.at, Diagnostic::error("wrong-json-type", message));
    }

    /// The first of the members of each name; `None` if it is no object. `known` lists the keys
    /// that there may be, or nothing where they are names.
    fn members(&mut self, tree: &'t Tree, known: &[&'static str]) -> Option<Vec<&'t Member>> {
        /// Below this, looking through the list is faster than hashing.
        const FEW: usize = 12;
        let Some(members) = tree.members() else {
            self.wrong(tree, "an object");
            return None;
        };
        let mut seen = FxHashSet::default();
        let mut kept: Vec<&Member> = Vec::with_capacity(members.len());
        for member in members {
            let key = member.key.as_str();
            let duplicate = if members.len() > FEW {
                !seen.insert(key)
            } else {
                kept.iter().any(|other| other.key == key)
            };
            if duplicate {
                let message = format!("the key `{key}` is written twice");
                let diagnostic = Diagnostic::error("duplicate-key", message);
                self.within(Segment::Key(key), |reader| {
                    reader.report(member.key_at, diagnostic)
                });
                continue;
            }
            if !known.is_empty() && !known.contains(&key) {
                let help = did_you_mean(key, known.iter().copied());
                let message = format!("the key `{key}` is not known here");
                let diagnostic = Diagnostic::error("unknown-key", message).help_if(help);
                self.within(Segment::Key(key), |reader| {
                    reader.report(member.key_at, diagnostic)
                });
                // It counts as seen, so that writing it twice is reported too.
            }
            kept.push(member);
        }
        Some(kept)
    }

    fn field<T>(
        &mut self,
        members: &[&'t Member],
        key: &str,
        read: impl FnOnce(&mut Self, &'t Tree) -> T,
    ) -> Option<T> {
        let member = members.iter().find(|member| member.key == key)?;
        Some(self.within(Segment::Key(&member.key), |reader| {
            read(reader, &member.tree)
        }))
    }

    /// The pointer names the member that is not there.
    fn missing(&mut self, tree: &Tree, key: &'static str, help: &str) {
        let message = format!("the key `{key}` is missing");
        let diagnostic = Diagnostic::error("missing-key", message).help(help);
        self.within(Segment::Key(key), |reader| {
            reader.report(tree.at, diagnostic)
        });
    }

    fn text(&mut self, tree: &'t Tree) -> Option<String> {
        match &tree.value {
            Json::Text(text) => Some(text.clone()),
            _ => {
                self.wrong(tree, "a string");
                None
            }
        }
    }

    fn number(&mut self, tree: &'t Tree) -> Option<f64> {
        match &tree.value {
            Json::Number(_) => self.value(tree).as_f64(),
            _ => {
                self.wrong(tree, "a number");
                None
            }
        }
    }

    /// A literal; its numbers must be finite as f32.
    fn value(&mut self, tree: &'t Tree) -> Value {
        match &tree.value {
            Json::Number(number) => {
                let finite = number
                    .as_f64()
                    .is_some_and(|number| (number as f32).is_finite());
                if !finite {
                    let message = format!("{number} is not finite as a 32-bit float");
                    let diagnostic = Diagnostic::error("number-not-finite", message)
                        .help("the largest is 3.4028235e38");
                    self.report(tree.at, diagnostic);
                }
                Value::Number(number.clone())
            }
            Json::Array(items) => {
                let items = items.iter().enumerate().map(|(index, item)| {
                    self.within(Segment::Index(index), |reader| reader.value(item))
                });
                Value::Array(items.collect())
            }
            Json::Object(_) => {
                let members = self.members(tree, &[]).unwrap_or_default();
                let members = members.into_iter().map(|member| {
                    let segment = Segment::Key(&member.key);
                    let value = self.within(segment, |reader| reader.value(&member.tree));
                    (member.key.clone(), value)
                });
                Value::Object(members.collect())
            }
            _ => self.extra(tree),
        }
    }

    /// Whatever an editor wants to keep: any JSON; duplicate keys cannot be kept.
    fn extra(&mut self, tree: &'t Tree) -> Value {
        match &tree.value {
            Json::Null => Value::Null,
            Json::Boolean(value) => Value::Bool(*value),
            Json::Number(number) => Value::Number(number.clone()),
            Json::Text(text) => Value::String(text.clone()),
            Json::Array(items) => {
                let items = items.iter().enumerate().map(|(index, item)| {
                    self.within(Segment::Index(index), |reader| reader.extra(item))
                });
                Value::Array(items.collect())
            }
            Json::Object(_) => {
                let members = self.members(tree, &[]).unwrap_or_default();
                let members = members.into_iter().map(|member| {
                    let segment = Segment::Key(&member.key);
                    let value = self.within(segment, |reader| reader.extra(&member.tree));
                    (member.key.clone(), value)
                });
                Value::Object(members.collect())
            }
        }
    }

    /// The version; `None`, reported, if there is no known one.
    fn version(&mut self, tree: &'t Tree) -> Option<u64> {
        let Some(members) = tree.members() else {
            self.wrong(tree, "a graph, which is an object,");
            return None;
        };
        let Some(member) = members.iter().find(|member| member.key == "version") else {
            // The rest is read as the present version, so that its mistakes are found too.
            return Some(VERSION);
        };
        let version = match &member.tree.value {
            Json::Number(number) => number.as_u64(),
            _ => None,
        };
        if version.is_some_and(|version| version <= VERSION) {
            return version;
        }
        self.within(Segment::Key("version"), |reader| {
            let shown = match &member.tree.value {
                Json::Number(number) => format!("version {number}"),
                other => format!("a version that is {}", other.kind()),
            };
            let message =
                format!("{shown} is not supported: it must be a whole number up to {VERSION}");
            let help = match version {
                Some(_) => {
                    "the document was written for a later release; update this one".to_owned()
                }
                None => format!("write `\"version\": {VERSION}`"),
            };
            let diagnostic = Diagnostic::error("unsupported-version", message).help(help);
            reader.report(member.tree.at, diagnostic);
        });
        None
    }

    fn document(&mut self, tree: &'t Tree) -> Document {
        let mut document = Document::default();
        let Some(members) = self.members(tree, DOCUMENT) else {
            return document;
        };
        if self.field(&members, "version", |_, _| ()).is_none() {
            let help = format!("write `\"version\": {VERSION}`");
            self.missing(tree, "version", &help);
        }
        document.schema = self
            .field(&members, "$schema", |_, tree| match &tree.value {
                // It is ignored, whatever it is.
                Json::Text(text) => Some(text.clone()),
                _ => None,
            })
            .flatten();
        document.name = self.field(&members, "name", Self::text).flatten();
        document.body = self.body(tree, &members);
        document.graphs = self
            .field(&members, "graphs", |reader, tree| {
                reader.map(tree, |reader, tree| {
                    let members = reader.members(tree, GRAPH).unwrap_or_default();
                    reader.body(tree, &members)
                })
            })
            .unwrap_or_default();
        document
    }

    /// An object of named things.
    fn map<V>(&mut self, tree: &'t Tree, mut read: impl FnMut(&mut Self, &'t Tree) -> V) -> Map<V> {
        let members = self.members(tree, &[]).unwrap_or_default();
        let mut map = Map::with_capacity_and_hasher(members.len(), Default::default());
        for member in members {
            let segment = Segment::Key(&member.key);
            let value = self.within(segment, |reader| read(reader, &member.tree));
            map.insert(member.key.clone(), value);
        }
        map
    }

    fn body(&mut self, tree: &'t Tree, members: &[&'t Member]) -> Body {
        let doc = self.field(members, "doc", Self::text).flatten();
        let inputs = self.field(members, "inputs", |reader, tree| {
            reader.map(tree, Self::input)
        });
        let nodes = self.field(members, "nodes", |reader, tree| {
            reader.map(tree, Self::node)
        });
        let outputs = self.field(members, "outputs", |reader, tree| {
            reader.map(tree, |reader, tree| reader.reference(tree))
        });
        if nodes.is_none() && tree.members().is_some() {
            self.missing(
                tree,
                "nodes",
                "write `\"nodes\": { \"NAME\": { \"type\": … } }`",
            );
        }
        if outputs.is_none() && tree.members().is_some() {
            let help = "write `\"outputs\": { \"base_color\": { \"node\": NAME } }`";
            self.missing(tree, "outputs", help);
        }
        // A node that could not be read keeps its name, so that references to it are not
        // reported as well; an output that could not be read refers to nothing.
        let outputs = outputs.unwrap_or_default();
        let extra = self.field(members, "extra", Self::extra);
        Body {
            doc,
            inputs: inputs.unwrap_or_default(),
            nodes: nodes.unwrap_or_default(),
            outputs,
            extra,
        }
    }

    fn input(&mut self, tree: &'t Tree) -> InputEntry {
        let Some(members) = self.members(tree, INPUT) else {
            return InputEntry::default();
        };
        let ty = self.field(&members, "type", Self::text);
        if ty.is_none() {
            self.missing(tree, "type", "write `\"type\": \"float\"`, or another type");
        }
        let value = self.field(&members, "value", Self::value);
        if value.is_none() {
            self.missing(tree, "value", "every input has a default");
        }
        InputEntry {
            ty: ty.flatten().unwrap_or_default(),
            value: value.unwrap_or_default(),
            min: self.field(&members, "min", Self::number).flatten(),
            max: self.field(&members, "max", Self::number).flatten(),
            soft_min: self.field(&members, "soft_min", Self::number).flatten(),
            soft_max: self.field(&members, "soft_max", Self::number).flatten(),
            doc: self.field(&members, "doc", Self::text).flatten(),
            extra: self.field(&members, "extra", Self::extra),
        }
    }

    fn node(&mut self, tree: &'t Tree) -> NodeEntry {
        let Some(members) = self.members(tree, NODE) else {
            return NodeEntry::default();
        };
        let ty = self.field(&members, "type", Self::text);
        if ty.is_none() {
            self.missing(
                tree,
                "type",
                "write `\"type\": …` with the name of a node type",
            );
        }
        let inputs = self.field(&members, "inputs", |reader, tree| {
            reader.map(tree, Self::binding)
        });
        NodeEntry {
            ty: ty.flatten().unwrap_or_default(),
            inputs: inputs.unwrap_or_default(),
            doc: self.field(&members, "doc", Self::text).flatten(),
            extra: self.field(&members, "extra", Self::extra),
        }
    }

    fn reference(&mut self, tree: &'t Tree) -> Reference {
        let nothing = Reference {
            node: String::new(),
            output: "out".to_owned(),
        };
        let Some(members) = self.members(tree, REFERENCE) else {
            return nothing;
        };
        let node = self.field(&members, "node", Self::text);
        if node.is_none() {
            self.missing(tree, "node", "write `{ \"node\": NAME }`");
        }
        let output = self.field(&members, "output", Self::text).flatten();
        Reference {
            node: node.flatten().unwrap_or_default(),
            output: output.unwrap_or_else(|| "out".to_owned()),
        }
    }

    fn binding(&mut self, tree: &'t Tree) -> Binding {
        if tree.members().is_none() {
            return Binding::Value(self.value(tree));
        }
        let members = self.members(tree, BINDING).unwrap_or_default();
        let node = self.field(&members, "node", Self::text);
        let output = self.field(&members, "output", Self::text);
        let input = self.field(&members, "input", Self::text);
        match (node, output, input) {
            (Some(Some(node)), output, None) => {
                let output = output.flatten().unwrap_or_else(|| "out".to_owned());
                Binding::Node(Reference { node, output })
            }
            (None, None, Some(Some(input))) => Binding::Input(input),
            (Some(None), ..) | (.., Some(None)) => Binding::Value(Value::Null),
            _ => {
                let message = "a connection names either a node or an input of the graph";
                let help = "write `{ \"node\": NAME }` or `{ \"input\": NAME }`";
                self.report(
                    tree.at,
                    Diagnostic::error("wrong-connection", message).help(help),
                );
                Binding::Value(Value::Null)
            }
        }
    }
}
