//! The laws that a node of a tool's own is held to, before anybody's graph has it.
//!
//! [`check`] builds graphs around a definition: with its inputs at their defaults, with each of them read
//! from a noise and from a position, and its own example. Every method of them is held to the [`Law`]s:
//! it compiles for every target and never panics; a footprint that vanishes gives the value of the point, one
//! that grows the mean of the texture; no number is infinite, no variance is negative, and f32 gives
//! what f64 does; as a function of a Gaussian signal its mean keeps the heat equation, and with what it reads
//! it has a covariance.
//!
//! ```
//! use mipless::conformance::check;
//!
//! let absval = mipless::catalogue().iter().find(|def| def.spec.name == "absval").expect("it is there");
//! assert!(check(absval).is_empty());
//! ```

mod gaussian;
mod law;
pub mod random;
pub mod tolerance;

pub use law::{Bounds, Law, Violation, violations};

use crate::files::NoFiles;
use crate::{Catalogue, CatalogueError, CheckOptions, Method};
use mipless_codegen::NodeDef;
use mipless_graph::{Category, Node, PortSpec, PortType, Type};
use serde_json::{Map, Value, json};
use std::fmt;

/// The laws of a graph that a node is held to.
const LAWS: [Law; 8] = [
    Law::Panics,
    Law::Ir,
    Law::Shader,
    Law::Finite,
    Law::Variance,
    Law::Vanishing,
    Law::Far,
    Law::Rounding,
];

/// By these methods.
const METHODS: [Method; 7] = [
    Method::Point,
    Method::Naive,
    Method::Ensemble,
    Method::Local,
    Method::Quad,
    Method::Auto,
    Method::Split(4),
];

/// A law that a definition breaks, and the graph in which it does.
#[derive(Clone, Debug)]
pub struct Breach {
    /// The law, the method, and what was found.
    pub violation: Violation,
    /// The JSON of the graph.
    pub graph: String,
}

impl fmt::Display for Breach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}\n{}", self.violation, self.graph)
    }
}

/// What a definition breaks; nothing if it keeps all laws. A definition that is one of this crate's is
/// itself, any other one is added to them.
pub fn check(definition: &NodeDef) -> Vec<Breach> {
    let shipped = Catalogue::shipped();
    let is_shipped = |known: &NodeDef| std::ptr::eq(known.spec, definition.spec);
    let own: &[NodeDef] = if shipped.definitions().iter().any(is_shipped) {
        &[]
    } else {
        std::slice::from_ref(definition)
    };
    match shipped.with_nodes(own) {
        Ok(catalogue) => breaches(definition, &catalogue),
        Err(error) => vec![refused(definition, &error)],
    }
}

/// A definition that no catalogue takes.
fn refused(definition: &NodeDef, error: &CatalogueError) -> Breach {
    Breach {
        violation: Violation {
            law: Law::Ir,
            method: Method::Point,
            what: format!("`{}` is no definition: {error}", definition.spec.name),
        },
        graph: String::new(),
    }
}

fn breaches(definition: &NodeDef, catalogue: &Catalogue) -> Vec<Breach> {
    let mut found = Vec::new();
    for graph in graphs(definition) {
        let options = CheckOptions::default();
        let name = definition.spec.name;
        // A graph that the check refuses is no case: the node says itself what it takes.
        if let Ok(texture) = catalogue.texture(name, &graph, &options, &NoFiles) {
            let bounds = |_: &Node| None;
            let violations = violations(&texture, &LAWS, &METHODS, &bounds);
            found.extend(violations.into_iter().map(|violation| Breach {
                violation,
                graph: graph.clone(),
            }));
        }
    }
    if !is_source(definition) {
        found.extend(gaussian::breaches(definition, catalogue));
    }
    found
}

/// Whether the node is random, or a pattern, whatever it reads.
fn is_source(definition: &NodeDef) -> bool {
    matches!(
        definition.spec.category,
        Category::Noise | Category::Pattern | Category::Input
    )
}

/// Inputs that signals can be given to.
fn ports(definition: &NodeDef) -> impl Iterator<Item = &PortSpec> {
    let is_signal = |port: &&PortSpec| {
        let takes = !matches!(
            port.ty,
            PortType::Choice(_)
                | PortType::Stops
                | PortType::Matrix
                | PortType::Exactly(Type::String | Type::Filename)
        );
        !port.uniform && takes
    };
    definition.spec.inputs.iter().filter(is_signal)
}

/// What a port reads that takes so many components: a position has two.
fn position(port: &PortSpec) -> Value {
    match port.ty {
        PortType::Exactly(Type::Vector2) => json!({ "node": "place" }),
        _ => json!({ "node": "u" }),
    }
}

fn document(nodes: Map<String, Value>) -> String {
    let graph = json!({
        "version": 1,
        "name": "conformance",
        "nodes": nodes,
        "outputs": { "out": { "node": "node" } },
    });
    graph.to_string()
}

/// The graphs that a definition is looked at in.
fn graphs(definition: &NodeDef) -> Vec<String> {
    let name = definition.spec.name;
    let with = |inputs: Value| {
        let mut nodes = Map::new();
        let mut add = |name: &str, node: Value| nodes.insert(name.to_owned(), node);
        add("place", json!({ "type": "texcoord" }));
        add(
            "u",
            json!({ "type": "extract", "inputs": { "in": { "node": "place" } } }),
        );
        add(
            "noise",
            json!({ "type": "noise2d", "inputs": {
            "frequency": 3, "amplitude": 1, "pivot": 0.4 } }),
        );
        add("node", json!({ "type": name, "inputs": inputs }));
        document(nodes)
    };
    let mut all = vec![definition.spec.example.to_owned(), with(json!({}))];
    for port in ports(definition) {
        let mut inputs = Map::new();
        inputs.insert(port.name.to_owned(), json!({ "node": "noise" }));
        all.push(with(Value::Object(inputs.clone())));
        inputs.insert(port.name.to_owned(), position(port));
        all.push(with(Value::Object(inputs)));
    }
    all
}
