//! The JSON document: what is written in a file, by name and without meaning. A tool edits it and
//! saves it again; [`resolve`](crate::resolve()) gives it meaning.

mod read;
pub(crate) mod tree;
mod upgrade;
mod write;

use indexmap::IndexMap;
use rustc_hash::FxBuildHasher;
use serde_json::Value;

use crate::Diagnostic;
pub(crate) use tree::{Tree, locate};

/// A map that keeps the order in which things were written.
pub type Map<V> = IndexMap<String, V, FxBuildHasher>;

/// The version of the format that this crate writes; older ones are upgraded when they are read.
pub const VERSION: u64 = 1;

/// A document.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Document {
    /// The `$schema` for editors; no meaning here.
    pub schema: Option<String>,
    /// The name, after which the generated functions are named. A document without one is called as
    /// its file is, which whoever reads the file knows.
    pub name: Option<String>,
    /// The graph.
    pub body: Body,
    /// The sub-graphs, used as node type `graph:NAME`.
    pub graphs: Map<Body>,
}

/// A graph or a sub-graph.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Body {
    /// What it is.
    pub doc: Option<String>,
    /// What may be set from outside.
    pub inputs: Map<InputEntry>,
    /// The nodes.
    pub nodes: Map<NodeEntry>,
    /// What it computes.
    pub outputs: Map<Reference>,
    /// Whatever an editor wants to keep.
    pub extra: Option<Value>,
}

/// An input of a graph.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InputEntry {
    /// The name of its type.
    pub ty: String,
    /// The default.
    pub value: Value,
    /// The smallest value that may be set, a component.
    pub min: Option<f64>,
    /// The largest value that may be set, a component.
    pub max: Option<f64>,
    /// Where a slider starts.
    pub soft_min: Option<f64>,
    /// Where a slider ends.
    pub soft_max: Option<f64>,
    /// What it means.
    pub doc: Option<String>,
    /// Whatever an editor wants to keep.
    pub extra: Option<Value>,
}

/// A node.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NodeEntry {
    /// The name of a node type, or `graph:NAME`.
    pub ty: String,
    /// What its inputs hold; the others hold their defaults.
    pub inputs: Map<Binding>,
    /// What it is for.
    pub doc: Option<String>,
    /// Whatever an editor wants to keep.
    pub extra: Option<Value>,
}

/// The output of a node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reference {
    /// The name of the node.
    pub node: String,
    /// The name of its output: `out` unless the node is a sub-graph.
    pub output: String,
}

impl Reference {
    /// The output `out` of a node.
    pub fn new(node: impl Into<String>) -> Self {
        Self::to(node, "out")
    }

    /// An output of a node.
    pub fn to(node: impl Into<String>, output: impl Into<String>) -> Self {
        Self {
            node: node.into(),
            output: output.into(),
        }
    }
}

/// What an input of a node holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Binding {
    /// A literal: a number, an array of numbers, a string, a truth value, stops.
    Value(Value),
    /// The output of a node.
    Node(Reference),
    /// An input of the graph.
    Input(String),
}

impl Binding {
    /// What the JSON of an input of a node says.
    ///
    /// # Errors
    /// What is wrong with it, in one line: a connection that names neither a node nor an input of the
    /// graph or names both, or a number that is not finite as f32.
    pub fn from_json(json: &Value) -> Result<Self, String> {
        let Value::Object(members) = json else {
            read::finite(json)?;
            return Ok(Self::Value(json.clone()));
        };
        let text = |key: &str| members.get(key).map(Value::as_str);
        let known = ["node", "output", "input"];
        let all_known = members.keys().all(|key| known.contains(&key.as_str()));
        match (text("node"), text("output"), text("input")) {
            (Some(Some(node)), output, None) if all_known && output != Some(None) => Ok(
                Self::Node(Reference::to(node, output.flatten().unwrap_or("out"))),
            ),
            (None, None, Some(Some(input))) if all_known => Ok(Self::Input(input.to_owned())),
            _ => Err(
                "a connection is `{ \"node\": NAME }`, with the name of an output if it is not `out`, or \
                 `{ \"input\": NAME }`"
                    .to_owned(),
            ),
        }
    }

    /// The JSON of an input of a node.
    pub fn to_json(&self) -> Value {
        write::binding(self)
    }
}

/// The text without the byte order mark that some editors put before it: it is no part of the
/// document, and editors do not count it as a column.
pub(crate) fn unmarked(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

impl Document {
    /// Reads a document from text, with every mistake of its structure. What could be read is
    /// there even if something else could not; there is no document only where the text is not
    /// JSON, is not an object, or is of an unknown version. A byte order mark is passed over.
    pub fn parse(text: &str) -> (Option<Self>, Vec<Diagnostic>) {
        let text = unmarked(text);
        match Tree::parse(text) {
            Ok(mut tree) => Self::from_tree(text, &mut tree),
            Err(diagnostic) => (None, vec![*diagnostic]),
        }
    }

    /// The same for text that is parsed already; the tree is upgraded to the present version.
    pub(crate) fn from_tree(text: &str, tree: &mut Tree) -> (Option<Self>, Vec<Diagnostic>) {
        read::read(text, tree)
    }

    /// The document as JSON of the present version; keys in the customary order.
    pub fn to_json(&self) -> Value {
        write::document(self)
    }

    /// The document as indented text that ends with a line feed.
    pub fn to_text(&self) -> String {
        let json = self.to_json();
        let mut text = serde_json::to_string_pretty(&json).expect("a JSON value always serialises");
        text.push('\n');
        text
    }
}
