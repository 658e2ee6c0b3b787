//! An edit is data: what a tool says, what goes over a pipe, and what is kept to do it again.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// A change of a document. In JSON it is an object whose member `edit` names the variant, in snake case.
///
/// `graph` names the sub-graph that is meant; without it, it is the graph itself. Nodes, inputs and
/// bindings are written as in a document. An edit that names something that is not there, or that takes
/// a name twice, is refused and changes nothing; one that makes a graph with mistakes is done, and
/// [`Change`](super::Change) says what they are.
///
/// ```
/// use mipless::session::Edit;
///
/// let edit: Edit = serde_json::from_str(r#"{ "edit": "set", "node": "noise", "input": "octaves", "value": 5 }"#)?;
/// assert!(matches!(&edit, Edit::Set { node, .. } if node == "noise"));
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "edit", rename_all = "snake_case", deny_unknown_fields)]
pub enum Edit {
    /// Adds nodes under names that are free:
    /// `{ "edit": "add", "nodes": { "noise": { "type": "noise2d" } } }`.
    Add {
        /// The sub-graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// The nodes as in a document, by their names.
        nodes: Map<String, Value>,
    },
    /// Adds nodes, those whose names are taken under others that are free; what reads one of them among
    /// the nodes follows. A binding to a node that is neither here nor there is left out.
    Paste {
        /// The sub-graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// The nodes as in a document, by their names.
        nodes: Map<String, Value>,
    },
    /// Adds a copy of each of the nodes. What one of them reads of another, its copy reads of the copy:
    /// `{ "edit": "duplicate", "nodes": ["noise", "ramp"] }`.
    Duplicate {
        /// The sub-graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// Their names.
        nodes: Vec<String>,
    },
    /// Removes nodes; inputs that read them hold their defaults again, outputs that read them are removed:
    /// `{ "edit": "remove", "nodes": ["noise"] }`.
    Remove {
        /// The sub-graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// Their names.
        nodes: Vec<String>,
    },
    /// Renames a node, and all that reads it: `{ "edit": "rename", "node": "noise", "to": "clouds" }`.
    Rename {
        /// The sub-graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// Its name.
        node: String,
        /// The name that it takes.
        to: String,
    },
    /// Gives an input of a node the output of another one:
    /// `{ "edit": "connect", "node": "ramp", "input": "in", "from": "noise" }`.
    Connect {
        /// The sub-graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// The node that reads.
        node: String,
        /// Its input.
        input: String,
        /// The node that is read.
        from: String,
        /// Its output, `out` if it is not said.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        output: Option<String>,
    },
    /// Takes from an input of a node whatever it holds, so that it holds its default.
    Disconnect {
        /// The sub-graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// The node.
        node: String,
        /// Its input.
        input: String,
    },
    /// Gives an input of a node a literal (a number, a colour, a file's name, stops), or an input of the
    /// graph, `{ "input": NAME }`: `{ "edit": "set", "node": "noise", "input": "octaves", "value": 5 }`.
    Set {
        /// The sub-graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// The node.
        node: String,
        /// Its input.
        input: String,
        /// The literal.
        value: Value,
    },
    /// Changes one stop of a ramp, or adds one after the last:
    /// `{ "edit": "set_stop", "node": "ramp", "index": 0, "at": 0.2, "value": "#ffffff" }`.
    SetStop {
        /// The sub-graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// The node.
        node: String,
        /// Its input, `stops` if it is not said.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        input: Option<String>,
        /// Which stop, from 0; their number is a new one.
        index: usize,
        /// Where it is; where it was if it is not said.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        at: Option<f64>,
        /// Its value; what it was if it is not said.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        value: Option<Value>,
    },
    /// Removes one stop of a ramp: `{ "edit": "remove_stop", "node": "ramp", "index": 1 }`.
    RemoveStop {
        /// The sub-graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// The node.
        node: String,
        /// Its input, `stops` if it is not said.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        input: Option<String>,
        /// Which stop, from 0.
        index: usize,
    },
    /// Changes the value of an input of the graph: `{ "edit": "set_input", "input": "scale", "value": 8 }`.
    /// Of the graph itself this compiles nothing: it is a uniform.
    SetInput {
        /// The sub-graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// The input.
        input: String,
        /// The value.
        value: Value,
    },
    /// Adds an input of the graph, or changes all of one:
    /// `{ "edit": "put_input", "input": "scale", "entry": { "type": "float", "value": 4, "min": 1, "max": 64 } }`.
    PutInput {
        /// The sub-graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// The input.
        input: String,
        /// All that a document says of it.
        entry: Value,
    },
    /// Removes an input of the graph; what holds it holds its default again.
    RemoveInput {
        /// The sub-graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// The input.
        input: String,
    },
    /// Renames an input of the graph, and whatever holds it.
    RenameInput {
        /// The sub-graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// The input.
        input: String,
        /// The name that it takes.
        to: String,
    },
    /// Adds an output, or changes what one is of:
    /// `{ "edit": "put_output", "output": "base_color", "node": "ramp" }`.
    PutOutput {
        /// The sub-graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// The output of the graph.
        output: String,
        /// The node.
        node: String,
        /// The node's output, `out` if it is not said.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        port: Option<String>,
    },
    /// Removes an output; of a sub-graph, what reads it holds its default again.
    RemoveOutput {
        /// The sub-graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// The output of the graph.
        output: String,
    },
    /// Renames an output, and whatever reads it of a sub-graph.
    RenameOutput {
        /// The sub-graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// The output of the graph.
        output: String,
        /// The name that it takes.
        to: String,
    },
    /// Makes a sub-graph of nodes, and one node that uses it in their place:
    /// `{ "edit": "group", "nodes": ["noise", "ramp"], "name": "sky" }`. The texture stays the same.
    Group {
        /// The sub-graph that they are in.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// Their names.
        nodes: Vec<String>,
        /// What the new sub-graph and the node are called.
        name: String,
    },
    /// Puts the nodes of a sub-graph in the place of a node that uses it; the sub-graph is removed when
    /// nothing uses it any more.
    Ungroup {
        /// The sub-graph that the node is in.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// The node.
        node: String,
    },
    /// Names the graph, or with nothing takes its name away.
    SetName {
        /// The name.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        name: Option<String>,
    },
    /// Says what a node, or the graph, is for; nothing takes it away.
    SetDoc {
        /// The sub-graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// The node; without one it is the graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        node: Option<String>,
        /// The text.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        doc: Option<String>,
    },
    /// Keeps whatever an editor wants to keep of a node, or of the graph: places, colours, comments.
    SetExtra {
        /// The sub-graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        graph: Option<String>,
        /// The node; without one it is the graph.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        node: Option<String>,
        /// Any JSON; nothing takes it away.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        extra: Option<Value>,
    },
}

impl Edit {
    /// Whether the two are one gesture: values of one slider, one after the other, of which the last one
    /// is what the first was on its way to.
    pub(super) fn continues(&self, before: &Self) -> bool {
        match (before, self) {
            (
                Self::Set {
                    graph, node, input, ..
                },
                Self::Set {
                    graph: g,
                    node: n,
                    input: i,
                    ..
                },
            ) => (graph, node, input) == (g, n, i),
            (
                Self::SetInput { graph, input, .. },
                Self::SetInput {
                    graph: g, input: i, ..
                },
            ) => (graph, input) == (g, i),
            (
                Self::SetExtra { graph, node, .. },
                Self::SetExtra {
                    graph: g, node: n, ..
                },
            ) => (graph, node) == (g, n),
            (
                Self::SetStop {
                    graph,
                    node,
                    input,
                    index,
                    at: Some(_),
                    value: None,
                },
                Self::SetStop {
                    graph: g,
                    node: n,
                    input: i,
                    index: j,
                    at: Some(_),
                    value: None,
                },
            )
            | (
                Self::SetStop {
                    graph,
                    node,
                    input,
                    index,
                    at: None,
                    value: Some(_),
                },
                Self::SetStop {
                    graph: g,
                    node: n,
                    input: i,
                    index: j,
                    at: None,
                    value: Some(_),
                },
            ) => (graph, node, input, index) == (g, n, i, j),
            _ => false,
        }
    }
}
