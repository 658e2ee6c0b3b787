//! Builds the JSON document: nodes are made once however often they are asked for, types are
//! converted where a port wants another one, and each node knows what it came from.

mod convert;

use crate::matrix;
use crate::place::Place;
use crate::value::{Link, Literal, Value};
use mipless_graph::{
    Binding, Default as PortDefault, Document, InputEntry, NodeEntry, NodeSpec, OutputType,
    PortSpec, PortType, Reference, Type,
};
use rustc_hash::{FxHashMap, FxHashSet};

/// Why a node cannot be made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Refusal {
    pub(crate) code: &'static str,
    pub(crate) message: String,
}

impl Refusal {
    pub(crate) fn new(code: &'static str, message: impl Into<String>) -> Self {
        Self {
            code,
            message: message.into(),
        }
    }
}

/// The document under construction.
#[derive(Debug)]
pub(crate) struct Builder {
    specs: FxHashMap<&'static str, &'static NodeSpec>,
    pub(crate) document: Document,
    /// Nodes by what they are, so that each is there once.
    made: FxHashMap<String, String>,
    /// What each node came from.
    pub(crate) places: FxHashMap<String, Place>,
    /// The number that the next node of a name gets.
    counts: FxHashMap<String, usize>,
    /// What nodes are called that are made now, and what they come from.
    pub(crate) hint: String,
    pub(crate) place: Option<Place>,
    /// Approximations to be told at the present place.
    pub(crate) notes: Vec<String>,
}

/// The most nodes that a document becomes: those that a graph may have.
pub(crate) const MOST_NODES: usize = mipless_graph::MAX_NODES as usize;

impl Builder {
    pub(crate) fn new(specs: &[&'static NodeSpec]) -> Self {
        Self {
            specs: specs.iter().map(|spec| (spec.name, *spec)).collect(),
            document: Document::default(),
            made: FxHashMap::default(),
            places: FxHashMap::default(),
            counts: FxHashMap::default(),
            hint: String::new(),
            place: None,
            notes: Vec::new(),
        }
    }

    /// The spec of a node.
    pub(crate) fn spec(&self, name: &str) -> Option<&'static NodeSpec> {
        self.specs.get(name).copied()
    }

    /// A node with these inputs, read at `output`.
    pub(crate) fn node(
        &mut self,
        name: &str,
        inputs: Vec<(String, Value)>,
        output: &str,
    ) -> Result<Value, Refusal> {
        if let [
            (_, Value::Literal(Literal::Matrix(left))),
            (_, Value::Literal(right)),
        ] = inputs.as_slice()
            && let Some(result) = matrix::operate(name, left, right.numbers())
        {
            return Ok(Value::Literal(Literal::Matrix(result)));
        }
        let spec = self.spec(name).ok_or_else(|| {
            Refusal::new(
                "import-node-missing",
                format!("there is no node `{name}` here"),
            )
        })?;
        let mut ports = Vec::with_capacity(inputs.len());
        for (port, value) in inputs {
            let index = spec.input(&port).ok_or_else(|| {
                let message = format!("`{name}` has no input `{port}` here");
                Refusal::new("import-input-missing", message)
            })?;
            ports.push((&spec.inputs[index], value));
        }
        let common = common_type(&ports);
        let mut entry = NodeEntry {
            ty: name.to_owned(),
            ..NodeEntry::default()
        };
        for (port, value) in &ports {
            let literal_suffices = literal_suffices(&ports, common);
            let binding = self.bind(name, port, value.clone(), common, literal_suffices)?;
            if let Some(binding) = binding {
                entry.inputs.insert(port.name.to_owned(), binding);
            }
        }
        let ty = match spec.output {
            OutputType::Joined => joined(spec, &ports),
            _ => output_type(spec, &entry, common),
        };
        let reference = self.insert(entry, output)?;
        Ok(Value::Link(Link {
            binding: Binding::Node(reference),
            ty,
        }))
    }

    /// What a port holds for a value; nothing where that is its default.
    fn bind(
        &mut self,
        node: &str,
        port: &PortSpec,
        value: Value,
        common: Type,
        literal_suffices: bool,
    ) -> Result<Option<Binding>, Refusal> {
        let value = if port.uniform {
            self.inlined(node, port, value)?
        } else {
            value
        };
        let mismatch = |what: &str| {
            let message = format!("`{}` of `{node}` cannot take {what}", port.name);
            Err(Refusal::new("import-type", message))
        };
        match port.ty {
            PortType::Choice(names) => match value {
                Value::Literal(Literal::Text(text)) if names.contains(&text.as_str()) => {
                    Ok(Some(Binding::Value(text.into())))
                }
                Value::Literal(Literal::Text(text)) => mismatch(&format!("`{text}`")),
                _ => mismatch("a number"),
            },
            PortType::Stops => match value {
                Value::Literal(Literal::Json(json)) => Ok(Some(Binding::Value(json))),
                _ => mismatch("anything but stops"),
            },
            PortType::Exactly(Type::String | Type::Filename) => match value {
                Value::Literal(Literal::Text(text)) => Ok(Some(Binding::Value(text.into()))),
                _ => mismatch("a number"),
            },
            PortType::Exactly(ty) => {
                let value = self.converted(value, ty)?;
                self.finish(node, port, value)
            }
            // Matrices are written as they are.
            _ if matches!(value, Value::Literal(Literal::Matrix(_))) => match value {
                Value::Literal(literal) => Ok(Some(Binding::Value(literal.to_json()))),
                Value::Link(_) => mismatch("a signal"),
            },
            // Ports that take types of their own.
            _ if port.ty != PortType::Any => {
                let value = match &value {
                    Value::Literal(
                        literal @ Literal::Numbers(Type::Vector3 | Type::Vector4, _),
                    ) => self.vector(literal)?,
                    _ => value,
                };
                self.finish(node, port, value)
            }
            _ => {
                let value = match (value.ty(), common) {
                    // A number goes to every component but alpha, where it goes here as well.
                    (Some(Type::Float | Type::Integer | Type::Boolean), Type::Color4)
                    | (Some(Type::Vector4), Type::Color4) => self.converted(value, common)?,
                    (Some(ty), _) if ty.components() == 1 => self.converted(value, Type::Float)?,
                    (Some(ty), _) if ty != common => self.converted(value, common)?,
                    _ => value,
                };
                let value = match &value {
                    // Three or four numbers alone are a colour.
                    Value::Literal(
                        literal @ Literal::Numbers(Type::Vector3 | Type::Vector4, _),
                    ) if !literal_suffices => self.vector(literal)?,
                    _ => value,
                };
                self.finish(node, port, value)
            }
        }
    }

    /// The binding of a value that has the type of the port by now.
    fn finish(
        &mut self,
        node: &str,
        port: &PortSpec,
        value: Value,
    ) -> Result<Option<Binding>, Refusal> {
        let link = match value {
            Value::Literal(literal) => {
                if is_default(port, &literal) {
                    return Ok(None);
                }
                if matches!(literal, Literal::Text(_) | Literal::Matrix(_)) {
                    let message = format!("`{}` of `{node}` wants numbers", port.name);
                    return Err(Refusal::new("import-type", message));
                }
                return Ok(Some(Binding::Value(literal.to_json())));
            }
            Value::Link(link) => link,
        };
        if let Binding::Input(name) = &link.binding
            && let Some(entry) = self.document.body.inputs.get_mut(name)
            && !narrow(entry, port)
        {
            let literal = Binding::Value(entry.value.clone());
            self.notes.push(format!(
                "`{name}` is written as the number that it holds, since `{}` of `{node}` divides",
                port.name
            ));
            return Ok(Some(literal));
        }
        Ok(Some(link.binding))
    }

    /// What an input of the graph holds, for what is decided when the document is read.
    pub(crate) fn decided(&mut self, value: Value) -> Value {
        if let Value::Link(link) = &value
            && let Binding::Input(name) = &link.binding
            && let Some(entry) = self.document.body.inputs.get(name)
            && let Some(literal) = from_json(&entry.value, link.ty)
        {
            self.notes.push(format!(
                "`{name}` is written as the value that it holds, since it decides which nodes there \
                 are"
            ));
            return Value::Literal(literal);
        }
        value
    }

    /// A literal for a port that takes nothing else.
    fn inlined(&mut self, node: &str, port: &PortSpec, value: Value) -> Result<Value, Refusal> {
        let Value::Link(link) = value else {
            return Ok(value);
        };
        if let Binding::Input(name) = &link.binding
            && let Some(entry) = self.document.body.inputs.get(name)
            && let Some(literal) = from_json(&entry.value, link.ty)
        {
            self.notes.push(format!(
                "`{name}` is written as the value that it holds, since `{}` of `{node}` takes \
                 literals only",
                port.name
            ));
            return Ok(Value::Literal(literal));
        }
        let message = format!(
            "`{}` of `{node}` takes literals only, and this is a signal",
            port.name
        );
        Err(Refusal::new("import-literal-only", message))
    }

    /// The node, or the one that is the same already.
    pub(crate) fn insert(&mut self, entry: NodeEntry, output: &str) -> Result<Reference, Refusal> {
        let key = format!("{} {:?}", entry.ty, entry.inputs);
        let output = output.to_owned();
        // Shaders that are alike are as many materials.
        let is_material = self
            .spec(&entry.ty)
            .is_some_and(|spec| spec.material().is_some());
        if let Some(node) = self.made.get(&key).filter(|_| !is_material) {
            return Ok(Reference {
                node: node.clone(),
                output,
            });
        }
        if self.document.body.nodes.len() >= MOST_NODES {
            let message = format!("the document becomes more than {MOST_NODES} nodes");
            return Err(Refusal::new("import-limit", message));
        }
        let hint = if self.hint.is_empty() {
            entry.ty.clone()
        } else {
            self.hint.clone()
        };
        let name = self.unused(&hint);
        if let Some(place) = &self.place {
            self.places.insert(name.clone(), place.clone());
        }
        self.made.insert(key, name.clone());
        self.document.body.nodes.insert(name.clone(), entry);
        Ok(Reference { node: name, output })
    }

    /// A name that no node has, near the one that is wanted.
    fn unused(&mut self, hint: &str) -> String {
        let count = self.counts.entry(hint.to_owned()).or_insert(0);
        loop {
            *count += 1;
            let name = match *count {
                1 => hint.to_owned(),
                count => format!("{hint}_{count}"),
            };
            if !self.document.body.nodes.contains_key(&name) {
                return name;
            }
        }
    }

    /// An input of the graph.
    pub(crate) fn input(&mut self, name: &str, entry: InputEntry, ty: Type) -> Value {
        let entries = &mut self.document.body.inputs;
        entries.entry(name.to_owned()).or_insert(entry);
        Value::Link(Link {
            binding: Binding::Input(name.to_owned()),
            ty,
        })
    }

    /// Whether a value is a function of a position in space: it reads one, or stands where one is read.
    pub(crate) fn is_in_space(&self, value: &Value) -> bool {
        let nodes = &self.document.body.nodes;
        let Value::Link(Link {
            binding: Binding::Node(reference),
            ..
        }) = value
        else {
            return false;
        };
        let mut open = vec![&reference.node];
        let mut seen = FxHashSet::default();
        while let Some(name) = open.pop() {
            let Some(node) = nodes.get(name).filter(|_| seen.insert(name)) else {
                continue;
            };
            let unread =
                |port: &PortSpec| port.name == "position" && !node.inputs.contains_key(port.name);
            let spec = self.spec(&node.ty);
            if node.ty == "position" || spec.is_some_and(|spec| spec.inputs.iter().any(unread)) {
                return true;
            }
            open.extend(node.inputs.values().filter_map(|binding| match binding {
                Binding::Node(reference) => Some(&reference.node),
                _ => None,
            }));
        }
        false
    }

    /// An output of the graph that reads a node.
    pub(crate) fn read(&mut self, name: &str, reference: Reference) {
        let outputs = &mut self.document.body.outputs;
        outputs.insert(name.to_owned(), reference);
    }

    /// An output of the graph: what is no node becomes one.
    pub(crate) fn output(&mut self, name: &str, value: Value) -> Result<(), Refusal> {
        let value = match value {
            Value::Literal(literal) => self.constant(&literal)?,
            Value::Link(Link {
                binding: Binding::Node(_),
                ..
            }) => value,
            link @ Value::Link(_) => self.node("dot", vec![("in".to_owned(), link)], "out")?,
        };
        if let Value::Link(Link {
            binding: Binding::Node(reference),
            ..
        }) = value
        {
            self.read(name, reference);
        }
        Ok(())
    }
}

/// The widest type of the inputs of any type.
fn common_type(ports: &[(&PortSpec, Value)]) -> Type {
    let any = ports.iter().filter(|(port, _)| port.ty == PortType::Any);
    any.filter_map(|(_, value)| value.ty())
        .fold(Type::Float, |common, ty| {
            if ty.components() > common.components() {
                ty
            } else {
                common
            }
        })
}

/// Whether three or four numbers in a document are taken for a vector, since a vector is connected
/// beside them.
fn literal_suffices(ports: &[(&PortSpec, Value)], common: Type) -> bool {
    ports.iter().any(|(port, value)| {
        port.ty == PortType::Any && matches!(value, Value::Link(link) if link.ty == common)
    })
}

/// The components of the inputs one after another: a colour where one of them is, else a vector.
fn joined(spec: &NodeSpec, ports: &[(&PortSpec, Value)]) -> Type {
    let own = spec.inputs.iter().filter(|port| port.ty == PortType::Own);
    let types: Vec<Type> = own
        .map(|port| {
            let given = ports.iter().find(|(given, _)| given.name == port.name);
            given
                .and_then(|(_, value)| value.ty())
                .unwrap_or(Type::Float)
        })
        .collect();
    let is_color = types
        .iter()
        .any(|ty| matches!(ty, Type::Color3 | Type::Color4));
    match (
        types.iter().map(|ty| ty.components()).sum::<usize>(),
        is_color,
    ) {
        (..=2, _) => Type::Vector2,
        (3, true) => Type::Color3,
        (3, false) => Type::Vector3,
        (_, true) => Type::Color4,
        (_, false) => Type::Vector4,
    }
}

/// The type of the node's output.
fn output_type(spec: &NodeSpec, entry: &NodeEntry, common: Type) -> Type {
    let named = |port: &str| {
        let given = match entry.inputs.get(port) {
            Some(Binding::Value(value)) => value.as_str().and_then(Type::by_name),
            _ => None,
        };
        let default = spec.input(port).map(|index| spec.inputs[index].default);
        given.or(match default {
            Some(PortDefault::Choice(name)) => Type::by_name(name),
            _ => None,
        })
    };
    match spec.output {
        OutputType::Exactly(ty) => ty,
        OutputType::Named(port) | OutputType::Picture { named: port, .. } => {
            named(port).unwrap_or(Type::Color3)
        }
        OutputType::Stops => {
            let values = entry.inputs.get("stops");
            let wide = match values {
                Some(Binding::Value(stops)) => stops.as_array().map(|stops| {
                    let lengths = stops.iter().filter_map(|stop| stop["value"].as_array());
                    lengths.map(Vec::len).max().unwrap_or(1)
                }),
                _ => None,
            };
            match wide {
                Some(4) => Type::Color4,
                Some(3) => Type::Color3,
                _ => Type::Float,
            }
        }
        _ => common,
    }
}

/// Whether a port holds this literal when nothing is said.
fn is_default(port: &PortSpec, literal: &Literal) -> bool {
    let numbers = literal.numbers();
    let all = |x: f32| !numbers.is_empty() && numbers.iter().all(|y| *y == f64::from(x));
    let each = |xs: &[f32]| numbers.iter().copied().eq(xs.iter().map(|x| f64::from(*x)));
    // Elsewhere the type of the node follows from what is written.
    if !matches!(port.ty, PortType::Exactly(_)) {
        return false;
    }
    match port.default {
        PortDefault::Float(x) => all(x),
        PortDefault::Integer(x) => numbers == [f64::from(x)],
        PortDefault::Boolean(x) => numbers == [f64::from(u8::from(x))],
        PortDefault::Vector2(x) => each(&x),
        PortDefault::Color3(x) => each(&x),
        _ => false,
    }
}

/// Narrows what may be set to what the port accepts; `false` where no interval is left.
fn narrow(entry: &mut InputEntry, port: &PortSpec) -> bool {
    let range = &port.range;
    if range.nonzero {
        let apart =
            entry.min.is_some_and(|min| min > 0.0) || entry.max.is_some_and(|max| max < 0.0);
        if !apart {
            return false;
        }
    }
    if range.min != f32::MIN {
        let min = f64::from(range.min);
        entry.min = Some(entry.min.map_or(min, |own| own.max(min)));
    }
    if range.max != f32::MAX {
        let max = f64::from(range.max);
        entry.max = Some(entry.max.map_or(max, |own| own.min(max)));
    }
    true
}

/// A literal of a type as it was written to the document.
fn from_json(json: &serde_json::Value, ty: Type) -> Option<Literal> {
    use serde_json::Value as Json;
    match json {
        Json::Bool(flag) => Literal::of(ty, &[f64::from(u8::from(*flag))]),
        Json::Number(number) => Literal::of(ty, &[number.as_f64()?]),
        Json::Array(items) => {
            let numbers: Option<Vec<f64>> = items.iter().map(Json::as_f64).collect();
            Literal::of(ty, &numbers?)
        }
        Json::String(text) => Some(Literal::Text(text.clone())),
        _ => None,
    }
}
