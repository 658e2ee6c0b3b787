//! The resolved graph: names are ids, sub-graphs are expanded, types are promoted, and nodes stand
//! in topological order.

use crate::{Images, Literal, MaterialPart, NodeSpec, Type};

/// A node of a graph, by its position: inputs come before their users.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeId(pub u32);

impl NodeId {
    /// The position in [`Graph::nodes`].
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// An input of a graph, by its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ParameterId(pub u32);

impl ParameterId {
    /// The position in [`Graph::parameters`].
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// Where the value of a node's input comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A literal of the input's own type (not yet promoted further); defaults are literals too.
    Literal(Literal),
    /// The output `out` of a node.
    Node(NodeId),
    /// An input of the graph: the same everywhere on the surface, changed live.
    Parameter(ParameterId),
    /// The surface's texture coordinates, a `vector2`.
    Surface,
}

/// An input of a node.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// Where the value comes from.
    pub source: Source,
    /// The type of the source.
    pub from: Type,
    /// The type that the node sees: `from` is promoted to it (floats broadcast, a colour gains an
    /// alpha of 1). [`Type::String`] for choices and stops.
    pub ty: Type,
}

/// A node.
#[derive(Clone, Debug)]
pub struct Node {
    /// The name in the document; inside sub-graphs, the path `outer/inner`.
    pub name: String,
    /// The JSON pointer of the node in the document.
    pub pointer: String,
    /// The position of its definition in the catalogue that the graph was resolved with.
    pub definition: usize,
    /// Its spec.
    pub spec: &'static NodeSpec,
    /// The type of `out`.
    pub ty: Type,
    /// The inputs, in the order of the spec's.
    pub inputs: Vec<Input>,
}

impl Node {
    /// The input of that name.
    ///
    /// # Panics
    /// If the spec has no such input: a bug of the caller.
    pub fn input(&self, name: &str) -> &Input {
        let index = self.spec.input(name);
        &self.inputs[index.unwrap_or_else(|| panic!("{} has no input {name}", self.spec.name))]
    }

    /// The literal of a uniform input.
    ///
    /// # Panics
    /// If the input is not uniform: a bug of the caller.
    pub fn literal(&self, name: &str) -> &Literal {
        match &self.input(name).source {
            Source::Literal(literal) => literal,
            other => panic!(
                "input {name} of {} is not uniform: {other:?}",
                self.spec.name
            ),
        }
    }

    /// The part of a material that the node is.
    pub fn part(&self) -> Option<&'static MaterialPart> {
        let (_, parts) = self.spec.material()?;
        match self.literal("output") {
            Literal::Text(chosen) => parts.iter().find(|part| part.name == chosen),
            _ => None,
        }
    }

    /// Whether the mean of the node's values at points is what is right over a footprint.
    pub fn is_mean(&self) -> bool {
        self.part().is_none_or(|part| part.is_mean)
    }
}

/// An input of the graph.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// The name in the document.
    pub name: String,
    /// A float, integer, boolean, vector or colour.
    pub ty: Type,
    /// The default.
    pub value: Literal,
    /// The smallest value that may be set, a component.
    pub min: Option<f32>,
    /// The largest value that may be set, a component.
    pub max: Option<f32>,
    /// Where a slider starts.
    pub soft_min: Option<f32>,
    /// Where a slider ends.
    pub soft_max: Option<f32>,
    /// What it means.
    pub doc: String,
}

/// An output of the graph.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// The name in the document.
    pub name: String,
    /// The node whose `out` it is.
    pub node: NodeId,
    /// Its type.
    pub ty: Type,
}

/// A resolved graph without errors of names, cycles, types or ranges.
#[derive(Clone, Debug)]
pub struct Graph {
    /// The document's name; where it has none, [`Graph::NAMELESS`], which whoever reads a file
    /// replaces by the file's name.
    pub name: String,
    /// The graph's inputs, in the document's order.
    pub parameters: Vec<Parameter>,
    /// The nodes; inputs before their users.
    pub nodes: Vec<Node>,
    /// The outputs, in the document's order; at least one.
    pub outputs: Vec<Output>,
    /// The nodes that give materials, with all of their inputs, whatever parts are outputs:
    /// [`Graph::with_parts`].
    pub materials: Vec<Node>,
    /// The pictures that the nodes name, as far as whoever owns the files has put them here.
    pub images: Images,
}

impl Graph {
    /// What the graph of a document is called that has no name and is no file.
    pub const NAMELESS: &str = "texture";

    /// The node `id`.
    pub fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.index()]
    }

    /// The graph with those of its outputs alone that have these names, in their order; what no other
    /// output needs is then not computed.
    pub fn with_outputs(&self, names: &[&str]) -> Self {
        let named = |name: &&str| self.outputs.iter().find(|output| output.name == **name);
        Self {
            outputs: names.iter().filter_map(named).cloned().collect(),
            ..self.clone()
        }
    }
    /// The graph in which these inputs are constants for good: what follows from them alone is worked
    /// out when it is compiled, and nobody can set them any more.
    ///
    /// # Panics
    /// If a literal is not of its input's type: a bug of the caller.
    pub fn with_constants(&self, constants: &[(ParameterId, Literal)]) -> Self {
        let constant = |id: ParameterId| constants.iter().find(|(of, _)| *of == id);
        let mut graph = self.clone();
        // Where each of the inputs that are left stands now.
        let mut places = Vec::with_capacity(self.parameters.len());
        graph.parameters.clear();
        for (index, parameter) in (0..).zip(&self.parameters) {
            places.push(ParameterId(graph.parameters.len() as u32));
            match constant(ParameterId(index)) {
                Some((_, literal)) => assert_eq!(
                    literal.ty(),
                    parameter.ty,
                    "the type of the input {}",
                    parameter.name
                ),
                None => graph.parameters.push(parameter.clone()),
            }
        }
        let nodes = graph.nodes.iter_mut().chain(&mut graph.materials);
        for input in nodes.flat_map(|node| &mut node.inputs) {
            if let Source::Parameter(id) = input.source {
                input.source = match constant(id) {
                    Some((_, literal)) => Source::Literal(literal.clone()),
                    None => Source::Parameter(places[id.index()]),
                };
            }
        }
        graph
    }
}
