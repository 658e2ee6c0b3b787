//! A graph as MaterialX's elements: every node as the definition that its types choose, with what
//! converts between types where a definition wants another one.

use super::bind;
use super::expand::{Formal, Functions};
use super::is_shared;
use crate::build::Refusal;
use crate::materialx::definition::{Definition, Definitions, Input as Port};
use mipless_graph::{
    Default as PortDefault, Graph, Input, Literal, Node, PortSpec, PortType, Source, Type,
};
use rustc_hash::{FxHashMap, FxHashSet};

/// What an input or an output holds.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Holds {
    Value(String),
    Node(String),
    Interface(String),
}

/// An input, or an output, of an element.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub(super) name: String,
    pub(super) ty: String,
    pub(super) holds: Holds,
    pub(super) attributes: Vec<(&'static str, String)>,
}

/// A node.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub(super) category: String,
    pub(super) name: String,
    pub(super) ty: String,
    /// The definition, where types do not choose it.
    pub(super) nodedef: Option<String>,
    pub(super) entries: Vec<Entry>,
}

/// What stands in a nodegraph.
#[derive(Debug, Default)]
pub(super) struct Network {
    pub(super) inputs: Vec<Entry>,
    pub(super) elements: Vec<Element>,
    pub(super) outputs: Vec<Entry>,
    /// Nodes that have no definition, by name.
    pub(super) refused: Vec<(String, Refusal)>,
}

/// What an element gives: its name and its type.
type Made = (Holds, String);

struct Writer<'a> {
    graph: &'a Graph,
    functions: &'a Functions,
    network: Network,
    names: FxHashSet<String>,
    inputs: Vec<String>,
    made: Vec<Made>,
    /// Values as other types.
    converted: FxHashMap<(Holds, String), Holds>,
    coordinates: Option<String>,
}

impl Network {
    /// The elements of a graph; `formals` are the inputs of the definition that it is the body of.
    pub(super) fn of(graph: &Graph, functions: &Functions, formals: &[Formal]) -> Self {
        let mut writer = Writer {
            graph,
            functions,
            network: Self::default(),
            names: FxHashSet::default(),
            inputs: Vec::new(),
            made: Vec::with_capacity(graph.nodes.len()),
            converted: FxHashMap::default(),
            coordinates: None,
        };
        for parameter in &graph.parameters {
            let name = writer.unused(&parameter.name);
            writer.inputs.push(name.clone());
            if formals.is_empty() {
                writer.network.inputs.push(interface(parameter, name));
            }
        }
        for node in &graph.nodes {
            let made = writer.node(node).unwrap_or_else(|refusal| {
                writer.network.refused.push((node.name.clone(), refusal));
                (Holds::Value("0".to_owned()), node.ty.name().to_owned())
            });
            writer.made.push(made);
        }
        for output in &graph.outputs {
            let (holds, ty) = writer.made[output.node.index()].clone();
            let wanted = output.ty.name();
            let holds = writer.converted(holds, &ty, wanted);
            let name = writer.unused(&output.name);
            let holds = holds.unwrap_or_else(|refusal| {
                let node = graph.node(output.node).name.clone();
                writer.network.refused.push((node, refusal));
                Holds::Value("0".to_owned())
            });
            writer.network.outputs.push(Entry {
                name,
                ty: wanted.to_owned(),
                holds,
                attributes: Vec::new(),
            });
        }
        writer.network
    }
}

/// An input of the graph.
fn interface(parameter: &mipless_graph::Parameter, name: String) -> Entry {
    let ty = parameter.ty.name();
    let mut attributes = Vec::new();
    let bounds = [
        ("uimin", parameter.min),
        ("uimax", parameter.max),
        ("uisoftmin", parameter.soft_min),
        ("uisoftmax", parameter.soft_max),
    ];
    for (key, bound) in bounds {
        let text = bound.and_then(|bound| bind::value(&Literal::float(bound), ty));
        attributes.extend(text.map(|text| (key, text)));
    }
    if !parameter.doc.is_empty() {
        attributes.push(("doc", parameter.doc.clone()));
    }
    Entry {
        name,
        ty: ty.to_owned(),
        holds: Holds::Value(bind::value(&parameter.value, ty).unwrap_or_default()),
        attributes,
    }
}

impl Writer<'_> {
    /// A name that no other element has.
    fn unused(&mut self, hint: &str) -> String {
        let hint = bind::name(hint);
        let mut name = hint.clone();
        let mut count = 1;
        while !self.names.insert(name.clone()) {
            count += 1;
            name = format!("{hint}_{count}");
        }
        name
    }

    fn push(&mut self, hint: &str, category: &str, ty: &str, entries: Vec<Entry>) -> Holds {
        let name = self.unused(hint);
        self.network.elements.push(Element {
            category: category.to_owned(),
            name: name.clone(),
            ty: ty.to_owned(),
            nodedef: None,
            entries,
        });
        Holds::Node(name)
    }

    /// A value of a type as another type.
    fn converted(&mut self, holds: Holds, from: &str, to: &str) -> Result<Holds, Refusal> {
        if from == to || matches!(holds, Holds::Value(_)) {
            return Ok(holds);
        }
        let key = (holds.clone(), to.to_owned());
        if let Some(done) = self.converted.get(&key) {
            return Ok(done.clone());
        }
        let hint = match &holds {
            Holds::Node(name) | Holds::Interface(name) => format!("{name}_{to}"),
            Holds::Value(_) => to.to_owned(),
        };
        let entry = |name: &str, ty: &str, holds: Holds| Entry {
            name: name.to_owned(),
            ty: ty.to_owned(),
            holds,
            attributes: Vec::new(),
        };
        let done = match (from, to) {
            // There is no other way from a number to a whole one, or to a truth value.
            ("float", "integer") => self.push(&hint, "floor", to, vec![entry("in", from, holds)]),
            ("float", "boolean") => {
                let half = Holds::Value("0.5".to_owned());
                let entries = vec![entry("value1", from, holds), entry("value2", from, half)];
                self.push(&hint, "ifgreater", to, entries)
            }
            _ if converts(from, to) => {
                self.push(&hint, "convert", to, vec![entry("in", from, holds)])
            }
            _ => {
                let message = format!("MaterialX has nothing that makes a `{to}` of a `{from}`");
                return Err(Refusal::new("export-type", message));
            }
        };
        self.converted.insert(key, done.clone());
        Ok(done)
    }

    /// What an input reads, and its type; a literal is none.
    fn read(&mut self, input: &Input) -> Option<Made> {
        match &input.source {
            Source::Literal(_) => None,
            Source::Node(id) => Some(self.made[id.index()].clone()),
            Source::Parameter(id) => {
                let ty = self.graph.parameters[id.index()].ty;
                let name = self.inputs[id.index()].clone();
                Some((Holds::Interface(name), ty.name().to_owned()))
            }
            Source::Surface => {
                let name = match &self.coordinates {
                    Some(name) => name.clone(),
                    None => {
                        let made = self.push("texcoord", "texcoord", "vector2", Vec::new());
                        let Holds::Node(name) = made else {
                            return None;
                        };
                        self.coordinates = Some(name.clone());
                        name
                    }
                };
                Some((Holds::Node(name), "vector2".to_owned()))
            }
        }
    }

    fn node(&mut self, node: &Node) -> Result<Made, Refusal> {
        if let Some(function) = self.functions.get(node) {
            let (category, ports) = (function.category.clone(), function.ports.clone());
            let mut entries = Vec::new();
            for formal in ports {
                let Some(index) = node.spec.input(&formal.name) else {
                    continue;
                };
                let input = &node.inputs[index];
                if input.source == Source::Surface {
                    continue;
                }
                entries.push(self.entry(&formal.name, formal.ty.name(), formal.surface, input)?);
            }
            let ty = node.ty.name();
            let made = self.push(&node.name, &category, ty, entries);
            return Ok((made, ty.to_owned()));
        }
        if !is_shared(node.spec.name) {
            let message = "a rule of the exporter is wrong: it makes what MaterialX has not";
            return Err(Refusal::new("export-rule", message));
        }
        // What is of the type already is not converted.
        if node.spec.name == "convert"
            && let Some(input) = node.inputs.first()
            && let Some((holds, ty)) = self.read(input)
            && ty == node.ty.name()
        {
            return Ok((holds, ty));
        }
        let definition = self.definition(node)?;
        let mut entries = Vec::new();
        for port in &definition.inputs {
            let Some(index) = node.spec.input(&port.name) else {
                continue;
            };
            let (spec, input) = (&node.spec.inputs[index], &node.inputs[index]);
            let surface = port.geometric.is_some();
            if input.source == Source::Surface && surface {
                continue;
            }
            if let Some(entry) = self.choice(node, spec, port, input) {
                entries.push(entry);
            } else {
                entries.push(self.entry(&port.name, &port.ty, surface, input)?);
            }
        }
        let ty = definition.outputs.first().map_or("", |(_, ty)| ty.as_str());
        let made = self.push(&node.name, node.spec.name, ty, entries);
        if is_ambiguous(definition)
            && let Some(element) = self.network.elements.last_mut()
        {
            element.nodedef = Some(definition.name.clone());
        }
        Ok((made, ty.to_owned()))
    }

    /// An input that holds one of several names, or a file.
    fn choice(&self, node: &Node, spec: &PortSpec, port: &Port, input: &Input) -> Option<Entry> {
        let Source::Literal(Literal::Text(text)) = &input.source else {
            return None;
        };
        let value = match spec.ty {
            // Numbers name choices in the order of the list.
            PortType::Choice(names) if port.ty == "integer" => {
                names.iter().position(|name| name == text)?.to_string()
            }
            _ => text.clone(),
        };
        let mut attributes = Vec::new();
        if port.ty == "filename"
            && let Some(index) = node.spec.input("colorspace")
            && let Source::Literal(Literal::Text(space)) = &node.inputs[index].source
            && node.ty.name().starts_with("color")
        {
            // A picture says what its file does not.
            let space = if space == "lin_rec709" {
                space
            } else {
                "srgb_texture"
            };
            attributes.push(("colorspace", space.to_owned()));
        }
        Some(Entry {
            name: port.name.clone(),
            ty: port.ty.clone(),
            holds: Holds::Value(value),
            attributes,
        })
    }

    /// An input of a type.
    fn entry(
        &mut self,
        name: &str,
        ty: &str,
        surface: bool,
        input: &Input,
    ) -> Result<Entry, Refusal> {
        let holds = match (&input.source, self.read(input)) {
            (_, Some((holds, from))) => self.converted(holds, &from, ty)?,
            (Source::Literal(literal), None) => {
                let value = bind::value(literal, ty).ok_or_else(|| {
                    let message = format!("`{name}` holds what is no `{ty}`");
                    Refusal::new("export-type", message)
                })?;
                if surface {
                    // MaterialX's generator reads the surface where a literal is written.
                    let constant = Entry {
                        name: "value".to_owned(),
                        ty: ty.to_owned(),
                        holds: Holds::Value(value),
                        attributes: Vec::new(),
                    };
                    self.push(&format!("{name}_value"), "constant", ty, vec![constant])
                } else {
                    Holds::Value(value)
                }
            }
            _ => {
                return Err(Refusal::new(
                    "export-type",
                    format!("`{name}` holds nothing"),
                ));
            }
        };
        Ok(Entry {
            name: name.to_owned(),
            ty: ty.to_owned(),
            holds,
            attributes: Vec::new(),
        })
    }

    /// The definition that takes the inputs of a node with the fewest conversions.
    fn definition(&self, node: &Node) -> Result<&'static Definition, Refusal> {
        let candidates = Definitions::standard().of_category(node.spec.name);
        let mut best: Option<(i32, &'static Definition)> = None;
        for definition in candidates {
            if let Some(fit) = self.fit(node, definition)
                && best.is_none_or(|(most, _)| fit > most)
            {
                best = Some((fit, definition));
            }
        }
        let Some((_, definition)) = best else {
            let types: Vec<String> = (node.inputs.iter())
                .map(|input| match &input.source {
                    Source::Node(id) => format!("`{}`", self.made[id.index()].1),
                    _ => format!("`{}`", input.from),
                })
                .collect();
            let message = format!(
                "MaterialX's `{}` gives no `{}` of {}",
                node.spec.name,
                node.ty,
                types.join(", ")
            );
            return Err(Refusal::new("export-type", message));
        };
        for (port, input) in node.spec.inputs.iter().zip(&node.inputs) {
            let implied = ["signature", "to", "hash", "colorspace"].contains(&port.name);
            if !implied && definition.input(port.name).is_none() && !is_default(port, input) {
                let message = format!("MaterialX's has no input `{}`", port.name);
                return Err(Refusal::new("export-port", message));
            }
        }
        Ok(definition)
    }

    /// How well a definition fits a node, if it does.
    fn fit(&self, node: &Node, definition: &Definition) -> Option<i32> {
        let [(_, output)] = definition.outputs.as_slice() else {
            return None;
        };
        let mut fit = match output.as_str() {
            own if own == node.ty.name() => 1_000,
            "boolean" | "integer" if node.ty == Type::Float => 0,
            _ => return None,
        };
        // `ND_randomfloat_integer` is told by its last word.
        let last = definition.name.rsplit('_').next();
        let chosen = (node.spec.input("signature")).map(|index| &node.inputs[index].source);
        if let Some(Source::Literal(Literal::Text(signature))) = chosen
            && last == Some(signature)
        {
            fit += 100;
        }
        for port in &definition.inputs {
            let Some(index) = node.spec.input(&port.name) else {
                continue;
            };
            let (input, spec) = (&node.inputs[index], &node.spec.inputs[index]);
            let is_literal = matches!(input.source, Source::Literal(_));
            let from = match &input.source {
                Source::Literal(Literal::Text(_)) => continue,
                Source::Literal(Literal::Matrix(numbers)) => {
                    let name = if numbers.len() == 9 {
                        "matrix33"
                    } else {
                        "matrix44"
                    };
                    if port.ty != name {
                        return None;
                    }
                    continue;
                }
                Source::Literal(literal) => {
                    bind::value(literal, &port.ty)?;
                    input.from.name()
                }
                Source::Node(id) => self.made[id.index()].1.as_str(),
                _ => input.from.name(),
            };
            let wide = |name: &str| Type::by_name(name).map_or(0, Type::components);
            fit += match (from, port.ty.as_str()) {
                (from, to) if from == to => 10,
                (from, to) if wide(from) == 1 && wide(to) > 0 => {
                    // A number that is one for all components stays one where it can.
                    let spread = wide(to) > 1 && spec.ty != PortType::Any;
                    if spread { 1 } else { 2 }
                }
                ("color3", "color4") => 1,
                (from, to) if wide(from) == wide(to) && wide(to) > 1 => 1,
                _ if is_literal => 0,
                _ => return None,
            };
        }
        Some(fit)
    }
}

/// Whether MaterialX's `convert` has this.
fn converts(from: &str, to: &str) -> bool {
    let name = format!("ND_convert_{from}_{to}");
    Definitions::standard().named(&name).is_some()
}

/// Whether another definition has the same inputs and output, so that types do not tell them apart.
fn is_ambiguous(definition: &Definition) -> bool {
    let others = Definitions::standard().of_category(&definition.node);
    let types = |definition: &Definition| -> Vec<String> {
        let inputs = definition
            .inputs
            .iter()
            .map(|input| format!("{} {}", input.name, input.ty));
        inputs
            .chain(definition.outputs.iter().map(|(_, ty)| ty.clone()))
            .collect()
    };
    let own = types(definition);
    others
        .filter(|other| other.name != definition.name)
        .any(|other| types(other) == own)
}

/// Whether a port holds what it holds when nothing is said.
fn is_default(port: &PortSpec, input: &Input) -> bool {
    let Source::Literal(literal) = &input.source else {
        return input.source == Source::Surface && port.default == PortDefault::Surface;
    };
    let numbers = literal.numbers();
    match port.default {
        PortDefault::Float(x) => !numbers.is_empty() && numbers.iter().all(|y| *y == x),
        PortDefault::Integer(x) => numbers == [x as f32],
        PortDefault::Boolean(x) => numbers == [f32::from(u8::from(x))],
        PortDefault::Vector2(x) => numbers == x,
        PortDefault::Color3(x) => numbers == x,
        PortDefault::Choice(name) | PortDefault::Text(name) => {
            matches!(literal, Literal::Text(text) if text == name)
        }
        PortDefault::Stops(_) | PortDefault::Surface | PortDefault::Identity => false,
    }
}
