//! Nodes that MaterialX has not, as nodes that it has.

use super::bind::{self, literal};
use super::network::Network;
use super::{is_shared, rules};
use crate::build::{Builder, Refusal};
use crate::eval::{Call, eval};
use crate::rule::Expr;
use crate::value::{Link, Value};
use mipless_graph::{
    Binding, Diagnostic, Document, Graph, Input, InputEntry, Node, NodeEntry, NodeId, NodeSpec,
    Source, Type, resolve,
};
use rustc_hash::FxHashMap;
use serde_json::json;

/// What is left of a graph.
pub(super) struct Expanded {
    /// The graph, in which there are shared nodes and those that have a definition.
    pub(super) document: Option<Document>,
    pub(super) diagnostics: Vec<Diagnostic>,
}

/// A node that the document defines itself.
#[derive(Debug)]
pub(super) struct Function {
    /// What it is called.
    pub(super) category: String,
    pub(super) output: Type,
    /// The ports that it reads, in the order of the spec's.
    pub(super) ports: Vec<Formal>,
    pub(super) body: Network,
}

/// An input of a definition.
#[derive(Clone, Debug)]
pub(super) struct Formal {
    pub(super) name: String,
    pub(super) ty: Type,
    /// Whether it is the surface's coordinates where nothing is connected.
    pub(super) surface: bool,
}

/// The definitions by what they are of.
pub(super) struct Functions {
    specs: Vec<&'static NodeSpec>,
    by_key: FxHashMap<String, usize>,
    pub(super) all: Vec<Function>,
}

impl Functions {
    pub(super) fn new(specs: &[&'static NodeSpec]) -> Self {
        Self {
            specs: specs.to_vec(),
            by_key: FxHashMap::default(),
            all: Vec::new(),
        }
    }

    /// The definition of a node of Mipless's own.
    pub(super) fn get(&self, node: &Node) -> Option<&Function> {
        self.by_key.get(&key(node)).map(|index| &self.all[*index])
    }

    /// Makes the definition of a node, if it is not there; what is approximated in it.
    fn define(&mut self, node: &Node, rule: &'static Expr) -> Result<Vec<String>, Refusal> {
        let key = key(node);
        if self.by_key.contains_key(&key) {
            return Ok(Vec::new());
        }
        let mut builder = Builder::new(&self.specs);
        let mut call = Formally {
            node,
            read: vec![false; node.inputs.len()],
        };
        let value = eval(rule, &mut builder, &mut call)?;
        let value = builder.converted(value, node.ty)?;
        builder.hint.clear();
        builder.output("out", value)?;
        let notes = std::mem::take(&mut builder.notes);
        let (graph, mistakes) = resolve(&builder.document, &self.specs);
        let Some(graph) = graph else {
            let what = mistakes
                .first()
                .map(ToString::to_string)
                .unwrap_or_default();
            return Err(Refusal::new(
                "export-rule",
                format!("a rule of the exporter is wrong: {what}"),
            ));
        };
        let ports = (node.spec.inputs.iter().zip(&node.inputs).zip(call.read))
            .filter(|(_, read)| *read)
            .map(|((port, input), _)| Formal {
                name: port.name.to_owned(),
                ty: formal_type(input),
                surface: port.default == mipless_graph::Default::Surface,
            });
        let ports: Vec<Formal> = ports.collect();
        let mut body = Network::of(&graph, self, &ports);
        if let Some((_, refusal)) = body.refused.pop() {
            return Err(refusal);
        }
        let own = format!("mipless_{}", node.spec.name);
        let same = |function: &&Function| {
            let category = function.category.strip_prefix(&*own);
            category.is_some_and(|rest| rest.is_empty() || rest[1..].parse::<u32>().is_ok())
        };
        let category = match self.all.iter().filter(same).count() {
            0 => own.clone(),
            count => format!("{own}_{}", count + 1),
        };
        self.by_key.insert(key, self.all.len());
        self.all.push(Function {
            category,
            output: node.ty,
            ports,
            body,
        });
        Ok(notes)
    }
}

/// What tells the definitions of a node apart: its literals that decide what it is, and its types.
fn key(node: &Node) -> String {
    let mut key = format!("{} {}", node.spec.name, node.ty);
    for (port, input) in node.spec.inputs.iter().zip(&node.inputs) {
        key += &match &input.source {
            Source::Literal(literal) if port.uniform => format!(" {literal:?}"),
            _ => format!(" {}", formal_type(input)),
        };
    }
    key
}

/// The type of a port of a definition: numbers of all kinds are one.
fn formal_type(input: &Input) -> Type {
    match (&input.source, input.from) {
        (Source::Surface, _) => Type::Vector2,
        (_, Type::Integer | Type::Boolean) => Type::Float,
        (_, ty) => ty,
    }
}

/// Rules see a node of the graph.
struct Actually<'a> {
    graph: &'a Graph,
    node: &'a Node,
    made: &'a [Option<Value>],
}

impl Call for Actually<'_> {
    fn input(
        &mut self,
        builder: &mut Builder,
        name: &str,
        _: Option<&Value>,
    ) -> Result<Value, Refusal> {
        let input = &self.node.inputs[position(self.node, name)?];
        match &input.source {
            Source::Literal(value) => Ok(Value::Literal(literal(value))),
            Source::Node(id) => self.made[id.index()].clone().ok_or_else(consequence),
            Source::Parameter(id) => {
                let parameter = &self.graph.parameters[id.index()];
                Ok(Value::Link(Link {
                    binding: Binding::Input(parameter.name.clone()),
                    ty: parameter.ty,
                }))
            }
            Source::Surface => builder.node("texcoord", Vec::new(), "out"),
        }
    }

    fn is_given(&self, _: &str) -> bool {
        true
    }

    fn coordinate(&mut self, builder: &mut Builder) -> Result<Value, Refusal> {
        builder.node("texcoord", Vec::new(), "out")
    }

    fn output(&self) -> (Type, &str) {
        (self.node.ty, "out")
    }

    fn local(&self, name: &str) -> Option<&'static Expr> {
        local(self.node, name)
    }
}

/// Rules see a node whose inputs are those of a definition.
struct Formally<'a> {
    node: &'a Node,
    read: Vec<bool>,
}

impl Call for Formally<'_> {
    fn input(
        &mut self,
        builder: &mut Builder,
        name: &str,
        _: Option<&Value>,
    ) -> Result<Value, Refusal> {
        let index = position(self.node, name)?;
        let (port, input) = (&self.node.spec.inputs[index], &self.node.inputs[index]);
        if let (Source::Literal(value), true) = (&input.source, port.uniform) {
            return Ok(Value::Literal(literal(value)));
        }
        self.read[index] = true;
        let ty = formal_type(input);
        // A value that every port takes: what it is replaces it.
        let value = match ty.components() {
            1 => json!(1),
            count => vec![1; count].into(),
        };
        let entry = InputEntry {
            ty: ty.name().to_owned(),
            value,
            min: Some(f64::from(f32::MIN_POSITIVE)),
            ..InputEntry::default()
        };
        Ok(builder.input(name, entry, ty))
    }

    fn is_given(&self, _: &str) -> bool {
        true
    }

    fn coordinate(&mut self, builder: &mut Builder) -> Result<Value, Refusal> {
        self.input(builder, "texcoord", None)
    }

    fn output(&self) -> (Type, &str) {
        (self.node.ty, "out")
    }

    fn local(&self, name: &str) -> Option<&'static Expr> {
        local(self.node, name)
    }
}

fn local(node: &Node, name: &str) -> Option<&'static Expr> {
    if node.spec.input(name).is_some() {
        return None;
    }
    rules().get(&format!("{}.{name}", node.spec.name))
}

fn position(node: &Node, name: &str) -> Result<usize, Refusal> {
    node.spec.input(name).ok_or_else(|| {
        let message = format!("a rule of the exporter is wrong: there is no `{name}`");
        Refusal::new("export-rule", message)
    })
}

/// The code of a failure that was told where it began.
const CONSEQUENCE: &str = "export-consequence";

fn consequence() -> Refusal {
    Refusal::new(CONSEQUENCE, "")
}

/// The nodes that the outputs read.
fn read(graph: &Graph) -> Vec<bool> {
    let mut read = vec![false; graph.nodes.len()];
    for output in &graph.outputs {
        read[output.node.index()] = true;
    }
    // Inputs come before their users.
    for index in (0..graph.nodes.len()).rev() {
        if read[index] {
            for input in &graph.nodes[index].inputs {
                if let Source::Node(NodeId(id)) = input.source {
                    read[id as usize] = true;
                }
            }
        }
    }
    read
}

/// Makes of a graph what MaterialX has.
pub(super) fn expand(
    graph: &Graph,
    specs: &[&'static NodeSpec],
    functions: &mut Functions,
) -> Expanded {
    let mut builder = Builder::new(specs);
    let mut diagnostics = Vec::new();
    let mut made: Vec<Option<Value>> = Vec::with_capacity(graph.nodes.len());
    for parameter in &graph.parameters {
        let entry = bind::entry(parameter);
        builder.input(&parameter.name, entry, parameter.ty);
    }
    let read = read(graph);
    for (node, read) in graph.nodes.iter().zip(read) {
        if !read {
            made.push(None);
            continue;
        }
        builder.hint = bind::name(&node.name);
        let value = of_node(graph, node, &made, &mut builder, functions);
        let at = |diagnostic: Diagnostic| diagnostic.at(&*node.pointer).in_node(&*node.name);
        for note in std::mem::take(&mut builder.notes) {
            diagnostics.push(at(Diagnostic::note("export-approximated", note)));
        }
        if let Err(refusal) = &value
            && refusal.code != CONSEQUENCE
        {
            let message = format!("`{}`: {}", node.spec.name, refusal.message);
            diagnostics.push(at(Diagnostic::error(refusal.code, message)));
        }
        made.push(value.ok());
    }
    let mut complete = !diagnostics.iter().any(Diagnostic::is_error);
    builder.hint = "value".to_owned();
    for output in &graph.outputs {
        let value = made[output.node.index()].clone();
        complete &= value.is_some_and(|value| builder.output(&output.name, value).is_ok());
    }
    Expanded {
        document: complete.then_some(builder.document),
        diagnostics,
    }
}

/// A node of the graph: what a rule says, or itself.
fn of_node(
    graph: &Graph,
    node: &Node,
    made: &[Option<Value>],
    builder: &mut Builder,
    functions: &mut Functions,
) -> Result<Value, Refusal> {
    let missing =
        |input: &Input| matches!(input.source, Source::Node(id) if made[id.index()].is_none());
    let rule = rules().get(node.spec.name);
    match rule {
        Some(rule) if is_shared(node.spec.name) => {
            let mut call = Actually { graph, node, made };
            let value = eval(rule, builder, &mut call)?;
            return builder.converted(value, node.ty);
        }
        Some(rule) => builder.notes.extend(functions.define(node, rule)?),
        None if is_shared(node.spec.name) => {}
        None => {
            let message = "MaterialX has no such node, nor any of which it could be made";
            return Err(Refusal::new("export-node", message));
        }
    }
    // What was refused is told where it stands.
    if node.inputs.iter().any(missing) {
        return Err(consequence());
    }
    let mut entry = NodeEntry {
        ty: node.spec.name.to_owned(),
        ..NodeEntry::default()
    };
    for (port, input) in node.spec.inputs.iter().zip(&node.inputs) {
        let binding = match &input.source {
            Source::Literal(value) => Binding::Value(literal(value).to_json()),
            Source::Node(id) => match &made[id.index()] {
                Some(Value::Link(link)) => link.binding.clone(),
                Some(Value::Literal(literal)) => match builder.constant(literal)? {
                    Value::Link(link) => link.binding,
                    Value::Literal(literal) => Binding::Value(literal.to_json()),
                },
                None => return Err(consequence()),
            },
            Source::Parameter(id) => Binding::Input(graph.parameters[id.index()].name.clone()),
            Source::Surface => continue,
        };
        if matches!(&binding, Binding::Value(value) if value.is_null()) {
            continue;
        }
        entry.inputs.insert(port.name.to_owned(), binding);
    }
    let reference = builder.insert(entry, "out")?;
    Ok(Value::Link(Link {
        binding: Binding::Node(reference),
        ty: node.ty,
    }))
}
