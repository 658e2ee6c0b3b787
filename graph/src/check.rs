//! The Gaussian-statistics check: the class of every signal, why it has it, what it depends on, and
//! how far its filtered value is expected to be from the truth.
//!
//! | inputs that vary | linear | product, function |
//! |---|---|---|
//! | none | constant | constant |
//! | Gaussian | Gaussian | function of them, if they are at most two; else moments only |
//! | functions of one Gaussian | function of it | function of it |
//! | functions of two | moments only | function of them; else moments only |
//! | moments only | moments only | moments only |
//! | unknown | unknown | unknown |
//!
//! *Gaussians* are counted as signals, not as sources: the sum of a hundred noises is one Gaussian
//! that can be fused into what follows it. The position counts as two, one of its components as
//! one.

mod class;
mod closure;
mod material;
mod pole;
mod reached;
mod report;
mod sources;

use crate::{
    Behaviour, Diagnostic, Graph, Input, InputView, Literal, Node, NodeId, Picture, PortType,
    Reach, Source, Type,
};
pub use class::Class;
use class::{Incoming, Reason};
pub use sources::Sources;
use std::sync::Arc;

/// What the check lets pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CheckOptions {
    /// Whether signals without statistics may be sampled; otherwise they are errors.
    pub allow_sampling: bool,
}

/// The statistics of the output of a node.
#[derive(Clone, Debug)]
pub struct Signal {
    /// Its class.
    pub class: Class,
    /// The sources that it depends on.
    pub sources: Sources,
    /// The pairs of inputs of the node that depend on a common source, whose covariance is carried.
    pub correlations: Vec<Correlation>,
    /// The predicted error of closing the moments, root mean square over images on [0, 1],
    /// dimensionless; the error of the sources' own filtering is not in it. An estimate from
    /// measured cascades, not a bound.
    pub error: f32,
    /// What values it can have, as far as is known; of a noise, those within four standard
    /// deviations of its mean.
    pub reach: Reach,
    /// Whether nothing is known of its values because it, or what it depends on, has been reported to
    /// have no moments: what follows from that is not reported again.
    follows: bool,
    /// Whether it depends on the position in space.
    space: bool,
    /// Why it has this class.
    reason: Reason,
    /// The input that decided the class, unless the node did.
    decided_by: Option<NodeId>,
    /// The Gaussian signals that it is a function of, at most two, each with how many Gaussian
    /// numbers it holds.
    entries: class::Entries,
}

/// Two inputs of a node that depend on a common source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Correlation {
    /// The one.
    pub first: &'static str,
    /// The other.
    pub second: &'static str,
    /// A common source; `None` for the position.
    pub source: Option<NodeId>,
}

/// A graph that has passed the check, with the statistics of its signals. Only [`check()`] makes it.
#[derive(Clone, Debug)]
pub struct Checked {
    graph: Graph,
    signals: Vec<Signal>,
    warnings: Vec<Diagnostic>,
}

impl Checked {
    /// The graph.
    pub fn graph(&self) -> &Graph {
        &self.graph
    }

    /// The signals, one a node, in the order of the nodes.
    pub fn signals(&self) -> &[Signal] {
        &self.signals
    }

    /// The signal of a node.
    pub fn signal(&self, node: NodeId) -> &Signal {
        &self.signals[node.index()]
    }

    /// What is doubtful but compiles.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// The chain of reasons for the class of a node's signal, from the node to where it was
    /// decided; long chains are cut.
    pub fn because(&self, node: NodeId) -> Vec<String> {
        because(&self.graph, &self.signals, node)
    }
}

/// What a class rule sees of a node.
struct View<'a> {
    graph: &'a Graph,
    node: &'a Node,
    signals: &'a [Signal],
}

/// Whether an input varies over the surface.
fn varies(signals: &[Signal], input: &Input) -> bool {
    match input.source {
        Source::Node(node) => signals[node.index()].class != Class::Constant,
        Source::Surface => true,
        Source::Literal(_) | Source::Parameter(_) => false,
    }
}

/// Whether an input depends on the position in space.
fn in_space(signals: &[Signal], input: &Input) -> bool {
    match input.source {
        Source::Node(node) => signals[node.index()].space,
        Source::Surface => input.ty == Type::Vector3,
        Source::Literal(_) | Source::Parameter(_) => false,
    }
}

/// Whether nothing is known of an input because of something that has been reported.
fn follows(signals: &[Signal], input: &Input) -> bool {
    matches!(input.source, Source::Node(node) if signals[node.index()].follows)
}

impl InputView for View<'_> {
    fn varies(&self, port: &str) -> bool {
        varies(self.signals, self.node.input(port))
    }

    fn flag(&self, port: &str) -> bool {
        match self.node.literal(port) {
            Literal::Boolean(flag) => *flag,
            other => panic!(
                "{port} of {} is no truth value: {other:?}",
                self.node.spec.name
            ),
        }
    }

    fn choice(&self, port: &str) -> &str {
        match self.node.literal(port) {
            Literal::Text(name) => name,
            other => panic!("{port} of {} is no choice: {other:?}", self.node.spec.name),
        }
    }

    fn number(&self, port: &str) -> f32 {
        match self.node.literal(port) {
            Literal::Integer(number) => *number as f32,
            other => other.numbers()[0],
        }
    }

    fn in_space(&self, port: &str) -> bool {
        in_space(self.signals, self.node.input(port))
    }

    fn stops(&self, port: &str) -> Vec<[f32; 2]> {
        match self.node.literal(port) {
            Literal::Stops(stops) => stops.means(),
            other => panic!("{port} of {} is no list: {other:?}", self.node.spec.name),
        }
    }

    fn matrix(&self, port: &str) -> Vec<f32> {
        match self.node.literal(port) {
            Literal::Matrix(numbers) => numbers.clone(),
            other => panic!("{port} of {} is no matrix: {other:?}", self.node.spec.name),
        }
    }

    fn picture(&self, port: &str) -> Option<&Picture> {
        self.graph.images.get(self.choice(port)).map(Arc::as_ref)
    }

    fn same(&self, first: &str, second: &str) -> bool {
        let [first, second] = [first, second].map(|port| &self.node.input(port).source);
        matches!((first, second), (Source::Node(x), Source::Node(y)) if x == y)
    }

    fn components(&self, port: &str) -> usize {
        self.node.input(port).ty.components()
    }

    fn reach(&self, port: &str) -> Reach {
        reached::of(self.graph, self.signals, self.node.input(port))
    }
}

/// Finds the statistics of every signal.
///
/// # Errors
/// `unknown-statistics` for each node without statistics that an output needs, unless sampling is
/// allowed, when it is a warning of the [`Checked`]; `out-of-range` for each port that divides by a
/// number that is or may be 0, the same everywhere; `unread-file` for each file that such a node
/// names and whose picture is not in [`Graph::images`].
pub fn check(graph: Graph, options: &CheckOptions) -> Result<Checked, Vec<Diagnostic>> {
    let needed = needed(&graph);
    let mut signals: Vec<Signal> = Vec::with_capacity(graph.nodes.len());
    let mut errors = Vec::new();
    let mut warnings = Vec::new();
    let mut incoming = Vec::new();
    for (index, node) in graph.nodes.iter().enumerate() {
        let id = NodeId(u32::try_from(index).expect("no more nodes than are allowed"));
        let view = View {
            graph: &graph,
            node,
            signals: &signals,
        };
        let pole = pole::divided(&view);
        let behaviour = match (node.spec.class)(&view) {
            own @ (Behaviour::Unknown(_) | Behaviour::Refused { .. }) => own,
            own => pole.as_ref().and_then(pole::Pole::behaviour).unwrap_or(own),
        };
        let reach = (node.spec.reach)(&view);
        incoming.clear();
        for (port, input) in node.spec.inputs.iter().zip(&node.inputs) {
            if varies(&signals, input) {
                incoming.push(match input.source {
                    Source::Node(source) => {
                        Incoming::node(port.name, source, &signals[source.index()])
                    }
                    _ => Incoming::surface(port.name),
                });
            }
        }
        let position = behaviour == Behaviour::Position && node.ty == Type::Vector3;
        let space = position || node.inputs.iter().any(|input| in_space(&signals, input));
        let signal = class::signal(id, node, behaviour, &incoming);
        let known = node.inputs.iter().all(|input| !follows(&signals, input));
        let singular = matches!(behaviour, Behaviour::NoMoments { .. });
        let bounded = reach.whole(node.ty.components()).is_bounded();
        signals.push(Signal {
            space,
            reach,
            follows: singular || (!known && !bounded),
            ..signal
        });
        if !needed[index] {
            continue;
        }
        let mistakes = pole::diagnostics(&graph, &signals, node, pole.as_ref(), behaviour);
        for diagnostic in mistakes {
            let list = if diagnostic.is_error() {
                &mut errors
            } else {
                &mut warnings
            };
            list.push(diagnostic);
        }
        if let Behaviour::Refused { port, reason } = behaviour {
            let message = format!("`{port}` of `{}` does not fit its other inputs", node.name);
            errors.push(
                Diagnostic::error("inputs-disagree", message)
                    .at(format!("{}/inputs/{port}", node.pointer))
                    .in_node(&*node.name)
                    .in_port(port)
                    .because(reason),
            );
        }
        if let Behaviour::Unknown(reason) = behaviour {
            let message = format!("`{}` (`{}`) has no statistics", node.name, node.spec.name);
            let diagnostic = if options.allow_sampling {
                Diagnostic::warning("unknown-statistics", message).help("it will be sampled")
            } else {
                let help = "allow sampling, or use a node that has statistics";
                Diagnostic::error("unknown-statistics", message).help(help)
            };
            let diagnostic = diagnostic
                .at(&*node.pointer)
                .in_node(&*node.name)
                .because(reason);
            let list = if options.allow_sampling {
                &mut warnings
            } else {
                &mut errors
            };
            list.push(diagnostic);
        }
        errors.extend(unread_files(&graph, node));
        warnings.extend(diagonal_position(&graph, node, behaviour));
        // Several nodes are parts of one material.
        for warning in material::warnings(&graph, &signals, node) {
            let known =
                |other: &Diagnostic| other.code == warning.code && other.pointer == warning.pointer;
            if !warnings.iter().any(known) {
                warnings.push(warning);
            }
        }
    }
    if errors.is_empty() {
        Ok(Checked {
            graph,
            signals,
            warnings,
        })
    } else {
        errors.extend(warnings);
        Err(errors)
    }
}

/// The files that the node names and that nobody has read: lowering relies on there being none.
fn unread_files(graph: &Graph, node: &Node) -> Vec<Diagnostic> {
    let ports = node.spec.inputs.iter().zip(&node.inputs);
    ports
        .filter(|(port, _)| port.ty == PortType::Exactly(Type::Filename))
        .filter_map(|(port, input)| match &input.source {
            Source::Literal(Literal::Text(name)) if !name.is_empty() => {
                graph.images.get(name).is_none().then_some((port, name))
            }
            _ => None,
        })
        .map(|(port, name)| {
            Diagnostic::error("unread-file", format!("the file `{name}` was not read"))
                .at(format!("{}/inputs/{}", node.pointer, port.name))
                .in_node(&*node.name)
                .in_port(port.name)
                .help("load the graph from its file, or give the pictures with the text")
        })
        .collect()
}

/// One number where a position is wanted stands for both coordinates, which is seldom meant.
fn diagonal_position(graph: &Graph, node: &Node, behaviour: Behaviour) -> Option<Diagnostic> {
    if !matches!(
        behaviour,
        Behaviour::Gaussian { .. } | Behaviour::Random { .. } | Behaviour::Pattern
    ) {
        return None;
    }
    let ports = node.spec.inputs.iter().zip(&node.inputs);
    for (port, input) in ports {
        let Source::Node(source) = input.source else {
            continue;
        };
        if port.unit == "uv" && input.ty.components() > 1 && input.from.components() == 1 {
            let source = &graph.node(source).name;
            let message = format!(
                "`{}` of `{}` is a position, but `{source}` is one number",
                port.name, node.name
            );
            return Some(
                Diagnostic::warning("diagonal-position", message)
                    .at(format!("{}/inputs/{}", node.pointer, port.name))
                    .in_node(&*node.name)
                    .in_port(port.name)
                    .because("one number stands for both coordinates: the pattern is read along its diagonal"),
            );
        }
    }
    None
}

/// Which nodes an output needs.
fn needed(graph: &Graph) -> Vec<bool> {
    let mut needed = vec![false; graph.nodes.len()];
    for output in &graph.outputs {
        needed[output.node.index()] = true;
    }
    for index in (0..graph.nodes.len()).rev() {
        if needed[index] {
            for input in &graph.nodes[index].inputs {
                if let Source::Node(source) = input.source {
                    needed[source.index()] = true;
                }
            }
        }
    }
    needed
}

/// The chain of reasons of a signal.
fn because(graph: &Graph, signals: &[Signal], node: NodeId) -> Vec<String> {
    /// Nobody reads more.
    const LINKS: usize = 16;
    let mut reasons = Vec::new();
    let mut here = Some(node);
    while let Some(id) = here {
        if reasons.len() == LINKS {
            reasons.push("… and so on upstream".to_owned());
            break;
        }
        let signal = &signals[id.index()];
        reasons.push(signal.reason.text(graph, graph.node(id), signal));
        here = signal.decided_by;
    }
    reasons
}
