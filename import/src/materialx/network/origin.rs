//! Where what an input holds comes from: a value, a node, an input of the graph, or the surface.

use super::{Key, Network, consequence};
use crate::build::{Builder, Refusal};
use crate::element::{Id, Tree};
use crate::materialx::definition::Definition;
use crate::materialx::literal;
use crate::value::{Literal, Value};
use mipless_graph::{InputEntry, Type};
use serde_json::Value as Json;

/// Where it comes from.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Origin {
    /// The output of a node.
    Node(Key),
    /// The value that an element says.
    Value(Id),
    /// A value of a definition's table, of a type.
    Text(String, String),
    /// An input of a nodegraph that nothing sets.
    Interface(Id),
    /// Something of the surface.
    Surface(String),
    /// What the definition says.
    Default,
    /// Nothing, which was told.
    Failed,
}

/// More links from input to input than any document has: a circle.
const LONGEST: usize = 10_000;

impl Network<'_> {
    /// Where an input of a node comes from.
    pub(super) fn origin(
        &mut self,
        scope: usize,
        node: Id,
        definition: &Definition,
        name: &str,
    ) -> Origin {
        let of_definition = |definition: &Definition| match definition.input(name) {
            Some(input) => match (&input.geometric, &input.value) {
                (Some(geometric), _) => Origin::Surface(geometric.clone()),
                (None, Some(value)) => Origin::Text(value.clone(), input.ty.clone()),
                (None, None) => Origin::Default,
            },
            None => Origin::Default,
        };
        let Some(element) = self.tree.input(node, name) else {
            return of_definition(definition);
        };
        match self.follow(scope, element, Some(definition)) {
            Origin::Default => of_definition(definition),
            // MaterialX's generator reads the surface where a literal is written.
            Origin::Value(_) | Origin::Text(..)
                if definition
                    .input(name)
                    .is_some_and(|input| input.geometric.is_some()) =>
            {
                of_definition(definition)
            }
            origin => origin,
        }
    }

    /// Follows an element that has a value or a connection to where that comes from.
    pub(super) fn follow(
        &mut self,
        scope: usize,
        element: Id,
        definition: Option<&Definition>,
    ) -> Origin {
        let (mut scope, mut element) = (scope, element);
        let mut first = definition.is_some();
        for _ in 0..LONGEST {
            let at = self.tree.get(element);
            let text = |key: &str| at.attribute(key).map(str::to_owned);
            let (interface, graph) = (text("interfacename"), text("nodegraph"));
            let (node, output) = (text("nodename"), text("output"));
            if let Some(name) = interface {
                match self.interface(scope, element, &name) {
                    Ok((outer, found)) => (scope, element) = (outer, found),
                    Err(origin) => return origin,
                }
                first = false;
                continue;
            }
            let graph = graph.or_else(|| {
                // A node may be a nodegraph.
                let node = node.as_deref()?;
                let id = self.tree.child(self.scopes[scope].graph, node)?;
                (self.tree.get(id).tag == "nodegraph").then(|| node.to_owned())
            });
            if let Some(name) = graph {
                let graph = self.tree.child(Tree::ROOT, &name);
                let graph = graph.filter(|id| self.tree.get(*id).tag == "nodegraph");
                let Some(graph) = graph else {
                    let message = format!("there is no nodegraph `{name}`");
                    self.refuse(element, &Refusal::new("import-reference", message));
                    return Origin::Failed;
                };
                let output = output.unwrap_or_default();
                let Some(found) = self.graph_output(graph, &output) else {
                    let message = format!("the nodegraph `{name}` has no output `{output}`");
                    self.refuse(element, &Refusal::new("import-reference", message));
                    return Origin::Failed;
                };
                scope = self.scope_of(graph);
                element = found;
                first = false;
                continue;
            }
            if let Some(name) = node {
                let graph = self.scopes[scope].graph;
                let Some(found) = self.tree.child(graph, &name) else {
                    let message = format!("there is no node `{name}`");
                    self.refuse(element, &Refusal::new("import-reference", message));
                    return Origin::Failed;
                };
                match self.tree.get(found).tag.as_str() {
                    "input" | "output" => {
                        element = found;
                        first = false;
                        continue;
                    }
                    _ => {
                        return Origin::Node(Key {
                            scope,
                            node: found,
                            output: output.as_deref().unwrap_or("out").into(),
                        });
                    }
                }
            }
            if let Some(name) = output {
                // An output of the document, as documents of 1.38 name it.
                let found = self.tree.child(self.scopes[scope].graph, &name);
                let found = found.filter(|id| *id != element && self.tree.get(*id).tag == "output");
                if let Some(found) = found {
                    element = found;
                    first = false;
                    continue;
                }
            }
            return self.end(scope, element, first);
        }
        let message = "inputs go in a circle";
        self.refuse(element, &Refusal::new("import-circle", message));
        Origin::Failed
    }

    /// What an element without a connection holds.
    fn end(&self, scope: usize, element: Id, first: bool) -> Origin {
        let at = self.tree.get(element);
        let in_graph = at.parent == Some(self.scopes[scope].graph);
        if at.tag == "input" && in_graph && self.scopes[scope].user.is_none() {
            return match (at.attribute("defaultgeomprop"), at.attribute("value")) {
                (Some(geometric), None) => Origin::Surface(geometric.to_owned()),
                _ => Origin::Interface(element),
            };
        }
        match (at.attribute("value"), at.attribute("defaultgeomprop")) {
            (Some(_), _) => Origin::Value(element),
            (None, Some(geometric)) => Origin::Surface(geometric.to_owned()),
            // A string may be empty.
            (None, None) if at.attributes.iter().any(|(key, _)| key == "value") => {
                Origin::Text(String::new(), at.attribute("type").unwrap_or("").to_owned())
            }
            (None, None) if first => Origin::Default,
            (None, None) => Origin::Value(element),
        }
    }

    /// What an input of a nodegraph is set by.
    fn interface(&mut self, scope: usize, element: Id, name: &str) -> Result<(usize, Id), Origin> {
        let (graph, user) = {
            let scope = &self.scopes[scope];
            (scope.graph, scope.user.clone())
        };
        let Some((outer, node, definition)) = user else {
            if let Some(found) = self.tree.input(graph, name) {
                return Ok((scope, found));
            }
            // A functional nodegraph that nothing uses is shown with its definition's defaults.
            let nodedef = self.tree.get(graph).attribute("nodedef").map(str::to_owned);
            let input = nodedef
                .and_then(|nodedef| self.own.named(&nodedef).cloned())
                .and_then(|definition| definition.input(name).and_then(|input| input.element));
            let Some(found) = input else {
                let message = format!("the nodegraph has no input `{name}`");
                self.refuse(element, &Refusal::new("import-reference", message));
                return Err(Origin::Failed);
            };
            return Err(self.end_of_definition(found));
        };
        if let Some(found) = self.tree.input(node, name) {
            return Ok((outer, found));
        }
        match definition.input(name) {
            Some(input) => Err(match (&input.value, &input.geometric) {
                (_, Some(geometric)) => Origin::Surface(geometric.clone()),
                (Some(_), None) if input.element.is_some() => {
                    Origin::Value(input.element.unwrap_or_default())
                }
                (Some(value), None) => Origin::Text(value.clone(), input.ty.clone()),
                (None, None) => Origin::Text(String::new(), input.ty.clone()),
            }),
            None => {
                let message = format!("`{}` has no input `{name}`", definition.name);
                self.refuse(element, &Refusal::new("import-reference", message));
                Err(Origin::Failed)
            }
        }
    }

    fn end_of_definition(&self, input: Id) -> Origin {
        let at = self.tree.get(input);
        match (at.attribute("defaultgeomprop"), at.attribute("value")) {
            (Some(geometric), _) => Origin::Surface(geometric.to_owned()),
            (None, Some(_)) => Origin::Interface(input),
            (None, None) => Origin::Value(input),
        }
    }

    /// The value of an origin whose nodes are made.
    pub(super) fn of_origin(
        &mut self,
        builder: &mut Builder,
        origin: Origin,
        ty: &str,
    ) -> Result<Value, Refusal> {
        match origin {
            Origin::Failed => Err(consequence()),
            Origin::Node(key) => match self.done.get(&key) {
                Some(Ok(value)) => Ok(value.clone()),
                _ => Err(consequence()),
            },
            Origin::Value(element) => match self.written(element, ty) {
                Ok(literal) => Ok(Value::Literal(literal)),
                Err(refusal) => {
                    // It is told where the value stands, not where it is read.
                    self.refuse(element, &refusal);
                    Err(consequence())
                }
            },
            Origin::Text(text, ty) if text.is_empty() => literal::zero(&ty).map(Value::Literal),
            Origin::Text(text, ty) => literal::parse(&text, &ty).map(Value::Literal),
            Origin::Default => literal::zero(ty).map(Value::Literal),
            Origin::Surface(geometric) => surface(builder, &geometric),
            Origin::Interface(element) => self.graph_input(builder, element),
        }
    }

    /// The literal that an element holds, in linear Rec. 709, metres and degrees.
    fn written(&self, element: Id, ty: &str) -> Result<Literal, Refusal> {
        let at = self.tree.get(element);
        let ty = at.attribute("type").unwrap_or(ty);
        let Some(text) = at.attribute("value") else {
            return literal::zero(ty);
        };
        let value = literal::parse(text, ty)?;
        let value = match at.attribute("unit") {
            Some(unit) => literal::in_units(value, unit)?,
            None => value,
        };
        if ty == "filename" {
            let Literal::Text(name) = value else {
                return Ok(value);
            };
            if name.contains('<') || name.contains('[') {
                let message = format!("`{name}` is a pattern of names, and one picture is wanted");
                return Err(Refusal::new("import-image", message));
            }
            return Ok(Literal::Text(format!(
                "{}{name}",
                self.file_prefix(element)
            )));
        }
        match self.tree.inherited(element, "colorspace") {
            Some(space) => literal::linear(value, space),
            None => Ok(value),
        }
    }

    /// The value of an input of a nodegraph. MaterialX takes its colours as they are, whatever the
    /// colour space of the document is.
    fn interface_value(&self, element: Id, ty: &str) -> Result<Literal, Refusal> {
        let at = self.tree.get(element);
        match at.attribute("value") {
            Some(text) if ty.starts_with("color") => literal::parse(text, ty),
            _ => self.written(element, ty),
        }
    }

    /// What stands before the names of files, from the outside in.
    fn file_prefix(&self, element: Id) -> String {
        let mut prefixes = Vec::new();
        let mut at = Some(element);
        while let Some(id) = at {
            let element = self.tree.get(id);
            prefixes.extend(element.attribute("fileprefix"));
            at = element.parent;
        }
        prefixes.iter().rev().copied().collect()
    }

    /// The input of the graph that an `<input>` of a nodegraph becomes.
    fn graph_input(&mut self, builder: &mut Builder, element: Id) -> Result<Value, Refusal> {
        let ty = self
            .tree
            .get(element)
            .attribute("type")
            .unwrap_or("")
            .to_owned();
        let value = self.interface_value(element, &ty)?;
        let native = match Type::by_name(&ty) {
            // Texts, truth values and matrices decide what is made; they are written where they
            // are used.
            None | Some(Type::Boolean | Type::String | Type::Filename) => {
                return Ok(Value::Literal(value));
            }
            Some(native) => native,
        };
        let at = self.tree.get(element);
        let number = |key: &str, pick: fn(f64, f64) -> f64| {
            let text = at.attribute(key)?;
            let literal = literal::parse(text, &ty).or_else(|_| literal::parse(text, "float"));
            let literal = literal.ok()?;
            literal.numbers().iter().copied().reduce(pick)
        };
        let mut entry = InputEntry {
            ty: native.name().to_owned(),
            value: value.to_json(),
            min: number("uimin", f64::min),
            max: number("uimax", f64::max),
            soft_min: number("uisoftmin", f64::min),
            soft_max: number("uisoftmax", f64::max),
            doc: at.attribute("doc").map(str::to_owned),
            extra: None,
        };
        let outside = |bound: Option<f64>, beyond: fn(f64, f64) -> bool| {
            bound.is_some_and(|bound| value.numbers().iter().any(|x| beyond(*x, bound)))
        };
        // Sliders of editors are no bounds where the value itself lies beyond them.
        if outside(entry.min, |x, min| x < min) {
            entry.min = None;
        }
        if outside(entry.max, |x, max| x > max) {
            entry.max = None;
        }
        if let Some(label) = at.attribute("uiname") {
            entry.extra = Some(Json::Object(
                [("label".to_owned(), Json::from(label))]
                    .into_iter()
                    .collect(),
            ));
        }
        let name = self.input_name(builder, element);
        Ok(builder.input(&name, entry, native))
    }

    /// What an input of a nodegraph is called.
    fn input_name(&mut self, builder: &Builder, element: Id) -> String {
        if let Some(name) = self.inputs.get(&element) {
            return name.clone();
        }
        let own = self.tree.get(element).name.clone();
        let taken = |name: &str| builder.document.body.inputs.contains_key(name);
        let graph = self.tree.get(element).parent.unwrap_or_default();
        let mut name = own.clone();
        if taken(&name) {
            name = format!("{}_{own}", self.tree.get(graph).name);
        }
        let mut count = 1;
        while taken(&name) {
            count += 1;
            name = format!("{own}_{count}");
        }
        self.inputs.insert(element, name.clone());
        name
    }
}

/// What of the surface a texture has.
fn surface(builder: &mut Builder, geometric: &str) -> Result<Value, Refusal> {
    match geometric {
        "UV0" => builder.node("texcoord", Vec::new(), "out"),
        "Pobject" | "Pworld" => builder.node("position", Vec::new(), "out"),
        _ => {
            let what = match geometric {
                "Nobject" | "Nworld" => "normal",
                "Tobject" | "Tworld" => "tangent",
                "Bobject" | "Bworld" => "bitangent",
                "Vobject" | "Vworld" => "direction of view",
                other => other,
            };
            let message = format!("it reads the surface's {what}, which a texture has not");
            Err(Refusal::new("import-geometry", message))
        }
    }
}
