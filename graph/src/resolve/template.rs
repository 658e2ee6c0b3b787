//! The bodies of a document with names turned into positions: everything that can be known of a
//! body without knowing who uses it.

pub(super) mod material;

use rustc_hash::FxHashMap;
use serde_json::Value;

use super::Context;
use crate::diagnostic::escape;
use crate::document::{Binding, Body, Document, NodeEntry, Reference};
use crate::{Diagnostic, Type};

/// A body of the document; position 0 is the graph itself, the others are `document.graphs`.
pub(super) struct Template<'d> {
    /// The JSON pointer of the body.
    pub(super) pointer: String,
    /// The name of the sub-graph; empty for the graph.
    pub(super) name: &'d str,
    pub(super) body: &'d Body,
    /// The types of the inputs; `None` where they are wrong, which is reported.
    pub(super) inputs: Vec<Option<Type>>,
    pub(super) nodes: Vec<TemplateNode<'d>>,
    /// The outputs of the body; `None` where they are wrong, which is reported. Of a sub-graph they
    /// are those that it names; of the graph, a material is each of its parts.
    pub(super) outputs: Vec<Option<Port>>,
    /// Their names.
    pub(super) output_names: Vec<&'d str>,
    /// The nodes in topological order; filled by `order`.
    pub(super) order: Vec<u32>,
}

/// A node of a body.
pub(super) struct TemplateNode<'d> {
    pub(super) name: &'d str,
    pub(super) kind: Kind,
    /// What is connected or written, by the position of the port in the spec (of the input in the
    /// sub-graph).
    pub(super) wires: Vec<(u32, Wire<'d>)>,
    /// The outputs that are read, where the node has several; empty for `out` alone.
    pub(super) outputs: Vec<u32>,
}

/// What a node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// The node type at this position of the catalogue.
    Spec(usize),
    /// The template at this position.
    Graph(usize),
    /// Something wrong, which is reported.
    Broken,
}

/// An output of a node of the same body: of a node of the catalogue, 0 for `out`, then those that
/// its choice `output` names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Port {
    pub(super) node: u32,
    pub(super) output: u32,
}

/// Where an input of a node comes from, within the body.
#[derive(Clone, Copy, Debug)]
pub(super) enum Wire<'d> {
    Literal(&'d Value),
    Node(Port),
    Input(u32),
    /// Something wrong, which is reported.
    Broken,
}

impl Template<'_> {
    /// The JSON pointer of a node.
    pub(super) fn node_pointer(&self, node: usize) -> String {
        format!("{}/nodes/{}", self.pointer, escape(self.nodes[node].name))
    }

    /// The JSON pointer of an input of a node.
    pub(super) fn port_pointer(&self, node: usize, port: &str) -> String {
        format!("{}/inputs/{}", self.node_pointer(node), escape(port))
    }
}

/// Looks up every name of the document.
pub(super) fn build<'d>(context: &mut Context<'_>, document: &'d Document) -> Vec<Template<'d>> {
    let graphs = document.graphs.iter();
    let bodies = std::iter::once(("", &document.body, String::new())).chain(
        graphs.map(|(name, body)| (name.as_str(), body, format!("/graphs/{}", escape(name)))),
    );
    bodies
        .map(|(name, body, pointer)| template(context, document, name, body, pointer))
        .collect()
}

fn template<'d>(
    context: &mut Context<'_>,
    document: &'d Document,
    name: &'d str,
    body: &'d Body,
    pointer: String,
) -> Template<'d> {
    let inputs = body.inputs.iter().map(|(input, entry)| {
        let ty = Type::by_name(&entry.ty).filter(|ty| ty.components() > 0);
        if ty.is_none() {
            let at = format!("{pointer}/inputs/{}/type", escape(input));
            let names = Type::ALL.into_iter().filter(|ty| ty.components() > 0);
            let names: Vec<&str> = names.map(Type::name).collect();
            let help = context.nearest(&entry.ty, names.iter().copied());
            let message = format!(
                "`{}` is no type that an input of a graph can have",
                entry.ty
            );
            context.report(
                Diagnostic::error("unknown-type", message)
                    .at(at)
                    .help_if(help),
            );
        }
        ty
    });
    let inputs = inputs.collect();
    let mut template = Template {
        pointer,
        name,
        body,
        inputs,
        nodes: Vec::with_capacity(body.nodes.len()),
        outputs: Vec::with_capacity(body.outputs.len()),
        output_names: Vec::with_capacity(body.outputs.len()),
        order: Vec::new(),
    };
    // The kinds first: a wire looks at the kind of the node that it comes from.
    for (name, entry) in &body.nodes {
        let node = TemplateNode {
            name,
            kind: Kind::Broken,
            wires: Vec::new(),
            outputs: Vec::new(),
        };
        template.nodes.push(node);
        let index = template.nodes.len() - 1;
        template.nodes[index].kind = kind(context, document, &template, index, entry);
    }
    for (index, entry) in body.nodes.values().enumerate() {
        template.nodes[index].wires = wires(context, document, &template, index, entry);
    }
    for (name, reference) in &body.outputs {
        let at = format!("{}/outputs/{}", template.pointer, escape(name));
        let place = Diagnostic::error("", "").at(at);
        let port = self::reference(context, document, &template, reference, &place);
        let parts = port.and_then(|port| material::parts(context, &template, port, name, &place));
        match parts {
            Some(parts) => {
                for (name, port) in parts {
                    template.output_names.push(name);
                    template.outputs.push(Some(port));
                }
            }
            None => {
                template.output_names.push(name);
                template.outputs.push(port);
            }
        }
    }
    select(context, &mut template);
    if body.outputs.is_empty() {
        let at = format!("{}/outputs", template.pointer);
        let help = "write `\"outputs\": { \"base_color\": { \"node\": NAME } }`";
        let message = "the graph has no output";
        context.report(Diagnostic::error("no-outputs", message).at(at).help(help));
    }
    template
}

/// Notes which outputs of nodes with several are read.
fn select(context: &Context<'_>, template: &mut Template<'_>) {
    let wires = template.nodes.iter().flat_map(|node| &node.wires);
    let wired = wires.filter_map(|(_, wire)| match wire {
        Wire::Node(port) => Some(*port),
        _ => None,
    });
    let ports: Vec<Port> = wired
        .chain(template.outputs.iter().flatten().copied())
        .collect();
    for port in ports {
        let node = &mut template.nodes[port.node as usize];
        let several =
            matches!(node.kind, Kind::Spec(spec) if context.specs[spec].selector().is_some());
        if several && !node.outputs.contains(&port.output) {
            node.outputs.push(port.output);
        }
    }
}

fn kind(
    context: &mut Context<'_>,
    document: &Document,
    template: &Template<'_>,
    index: usize,
    entry: &NodeEntry,
) -> Kind {
    if let Some(spec) = context.by_name.get(entry.ty.as_str()) {
        return Kind::Spec(*spec);
    }
    let node = template.nodes[index].name;
    let at = format!("{}/type", template.node_pointer(index));
    if let Some(name) = entry.ty.strip_prefix("graph:") {
        if let Some(graph) = document.graphs.get_index_of(name) {
            return Kind::Graph(graph + 1);
        }
        let help = context.nearest(name, document.graphs.keys().map(String::as_str));
        let message = format!("there is no sub-graph `{name}`");
        let diagnostic = Diagnostic::error("unknown-graph", message);
        context.report(diagnostic.at(at).in_node(node).help_if(help));
        return Kind::Broken;
    }
    let help = super::synonym::node(&entry.ty).or_else(|| context.nearest_type(&entry.ty));
    let help = help.or_else(|| {
        let graph = document.graphs.get_full(&entry.ty)?.1;
        Some(format!("the sub-graph is used as `graph:{graph}`"))
    });
    let message = format!("there is no node type `{}`", entry.ty);
    let diagnostic = Diagnostic::error("unknown-node-type", message);
    context.report(diagnostic.at(at).in_node(node).help_if(help));
    Kind::Broken
}

fn wires<'d>(
    context: &mut Context<'_>,
    document: &'d Document,
    template: &Template<'d>,
    index: usize,
    entry: &'d NodeEntry,
) -> Vec<(u32, Wire<'d>)> {
    let node = &template.nodes[index];
    let mut wires = Vec::with_capacity(entry.inputs.len());
    for (port, binding) in &entry.inputs {
        let (position, uniform) = match node.kind {
            Kind::Spec(spec) => {
                let spec = context.specs[spec];
                let position = spec.input(port);
                (
                    position,
                    position.is_some_and(|position| spec.inputs[position].uniform),
                )
            }
            Kind::Graph(graph) => (document.graphs[graph - 1].inputs.get_index_of(port), false),
            // Its references are looked up all the same.
            Kind::Broken => (Some(0), false),
        };
        let place = |code: &'static str, message: String| {
            let at = template.port_pointer(index, port);
            Diagnostic::error(code, message)
                .at(at)
                .in_node(node.name)
                .in_port(port)
        };
        let Some(position) = position else {
            let help = match node.kind {
                Kind::Spec(spec) => {
                    let spec = context.specs[spec];
                    let names = spec.inputs.iter().map(|port| port.name);
                    super::synonym::port(port, spec).or_else(|| context.nearest(port, names))
                }
                Kind::Graph(graph) => {
                    let names = document.graphs[graph - 1].inputs.keys();
                    context.nearest(port, names.map(String::as_str))
                }
                Kind::Broken => None,
            };
            let message = format!("`{}` has no input `{port}`", entry.ty);
            context.report(place("unknown-port", message).help_if(help));
            continue;
        };
        let wire = match binding {
            Binding::Value(value) => Wire::Literal(value),
            _ if uniform => {
                let message = format!("`{port}` takes a literal only");
                let reason = format!("`{port}` of `{}` shapes the generated code", entry.ty);
                context.report(place("not-uniform", message).because(reason));
                Wire::Broken
            }
            Binding::Node(reference) => {
                let place = place("", String::new());
                self::reference(context, document, template, reference, &place)
                    .filter(|port| !material::is_read(context, template, *port, &place))
                    .map_or(Wire::Broken, Wire::Node)
            }
            Binding::Input(name) => match template.body.inputs.get_index_of(name) {
                Some(input) => Wire::Input(position_u32(input)),
                None => {
                    let names = template.body.inputs.keys().map(String::as_str);
                    let help = context.nearest(name, names);
                    let message = format!("the graph has no input `{name}`");
                    context.report(place("unknown-input", message).help_if(help));
                    Wire::Broken
                }
            },
        };
        wires.push((position_u32(position), wire));
    }
    wires
}

/// Looks up a reference to an output of a node; reports at `place`.
fn reference(
    context: &mut Context<'_>,
    document: &Document,
    template: &Template<'_>,
    reference: &Reference,
    place: &Diagnostic,
) -> Option<Port> {
    let Some(node) = template.body.nodes.get_index_of(&reference.node) else {
        let names = template.body.nodes.keys().map(String::as_str);
        let help = if template.body.inputs.contains_key(&reference.node) {
            Some(format!(
                "an input of the graph is written `{{ \"input\": \"{}\" }}`",
                reference.node
            ))
        } else {
            context.nearest(&reference.node, names)
        };
        let message = format!("there is no node `{}`", reference.node);
        let place = place.clone();
        context.report(
            Diagnostic {
                code: "unknown-node",
                message,
                ..place
            }
            .help_if(help),
        );
        return None;
    };
    let output = match template.nodes[node].kind {
        Kind::Spec(_) if reference.output == "out" => Some(0),
        Kind::Spec(spec) => (context.specs[spec].selector())
            .and_then(|(_, names)| names.iter().position(|name| *name == reference.output))
            .map(|position| position + 1),
        Kind::Graph(graph) => document.graphs[graph - 1]
            .outputs
            .get_index_of(&reference.output),
        Kind::Broken => Some(0),
    };
    if output.is_none() {
        let help = match template.nodes[node].kind {
            Kind::Graph(graph) => {
                let names = document.graphs[graph - 1]
                    .outputs
                    .keys()
                    .map(String::as_str);
                context.nearest(&reference.output, names)
            }
            Kind::Spec(spec) => match context.specs[spec].selector() {
                Some((_, names)) => {
                    let names: Vec<&str> = ["out"].iter().chain(names).copied().collect();
                    context.nearest(&reference.output, names.iter().copied())
                }
                None => Some("its output is `out`".to_owned()),
            },
            Kind::Broken => None,
        };
        let message = format!("`{}` has no output `{}`", reference.node, reference.output);
        let place = place.clone();
        context.report(
            Diagnostic {
                code: "unknown-output",
                message,
                ..place
            }
            .help_if(help),
        );
    }
    output.map(|output| Port {
        node: position_u32(node),
        output: position_u32(output),
    })
}

/// A document of 2³² nodes does not fit into memory.
pub(super) fn position_u32(position: usize) -> u32 {
    u32::try_from(position).expect("fewer than 2^32 things in a document")
}

/// Warns of nodes, inputs and sub-graphs that no output needs.
pub(super) fn find_unused(context: &mut Context<'_>, templates: &[Template<'_>]) {
    let mut used_graphs = vec![false; templates.len()];
    used_graphs[0] = true;
    let mut warnings: FxHashMap<usize, Vec<Diagnostic>> = FxHashMap::default();
    let mut pending = vec![0];
    while let Some(position) = pending.pop() {
        let template = &templates[position];
        let mut used = vec![false; template.nodes.len()];
        let mut used_inputs = vec![false; template.body.inputs.len()];
        let mut stack: Vec<u32> = template
            .outputs
            .iter()
            .flatten()
            .map(|port| port.node)
            .collect();
        while let Some(node) = stack.pop() {
            let node = node as usize;
            if std::mem::replace(&mut used[node], true) {
                continue;
            }
            for (_, wire) in &template.nodes[node].wires {
                match wire {
                    Wire::Node(port) => stack.push(port.node),
                    Wire::Input(input) => used_inputs[*input as usize] = true,
                    Wire::Literal(_) | Wire::Broken => {}
                }
            }
        }
        let found = warnings.entry(position).or_default();
        for (index, node) in template.nodes.iter().enumerate() {
            // A sub-graph is used if it is mentioned: the warning is about the node.
            if let Kind::Graph(graph) = node.kind
                && !std::mem::replace(&mut used_graphs[graph], true)
            {
                pending.push(graph);
            }
            if !used[index] {
                let message = format!("no output needs the node `{}`", node.name);
                let diagnostic = Diagnostic::warning("unused-node", message);
                found.push(
                    diagnostic
                        .at(template.node_pointer(index))
                        .in_node(node.name),
                );
            }
        }
        for ((input, _), used) in template.body.inputs.iter().zip(used_inputs) {
            if !used {
                let at = format!("{}/inputs/{}", template.pointer, escape(input));
                let message = format!("no output needs the input `{input}`");
                found.push(Diagnostic::warning("unused-input", message).at(at));
            }
        }
    }
    for (position, template) in templates.iter().enumerate() {
        for warning in warnings.remove(&position).unwrap_or_default() {
            context.report(warning);
        }
        if !used_graphs[position] {
            let message = format!("no node uses the sub-graph `{}`", template.name);
            let diagnostic = Diagnostic::warning("unused-graph", message);
            context.report(diagnostic.at(template.pointer.clone()));
        }
    }
}
