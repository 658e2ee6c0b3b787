//! A node, as the rules see it.

use super::{Key, Network};
use crate::build::{Builder, Refusal};
use crate::eval::Call;
use crate::materialx::definition::Definition;
use crate::materialx::literal;
use crate::materialx::network::origin::Origin;
use crate::value::{Link, Literal, Value};
use mipless_graph::{Default as PortDefault, OutputType, PortType, Type};
use std::rc::Rc;

/// A node whose inputs are made.
pub(super) struct NodeCall<'n, 'a> {
    network: &'n mut Network<'a>,
    key: &'n Key,
    definition: &'n Rc<Definition>,
    output: &'n str,
    ty: &'n str,
}

impl<'n, 'a> NodeCall<'n, 'a> {
    pub(super) fn new(
        network: &'n mut Network<'a>,
        key: &'n Key,
        definition: &'n Rc<Definition>,
        output: &'n str,
        ty: &'n str,
    ) -> Self {
        Self {
            network,
            key,
            definition,
            output,
            ty,
        }
    }

    /// The node of the same name here, with the same inputs.
    pub(super) fn same_name(&mut self, builder: &mut Builder) -> Result<Value, Refusal> {
        let definition = Rc::clone(self.definition);
        let Some(spec) = builder.spec(&definition.node) else {
            return Err(Refusal::new(
                "import-node-missing",
                "there is no such node here",
            ));
        };
        let mut inputs = Vec::new();
        for input in &definition.inputs {
            let origin =
                (self.network).origin(self.key.scope, self.key.node, &definition, &input.name);
            let Some(index) = spec.input(&input.name) else {
                if self.is_given(&input.name) {
                    builder.notes.push(format!(
                        "`{}` has no meaning here and is passed over",
                        input.name
                    ));
                }
                continue;
            };
            let port = &spec.inputs[index];
            // What both hold when nothing is said need not be said.
            let is_surface = origin == Origin::Surface("UV0".to_owned());
            if is_surface && port.default == PortDefault::Surface {
                continue;
            }
            let value = self.input(builder, &input.name, None)?;
            let value = match (port.ty, value) {
                // Numbers name choices in the order of the list.
                (PortType::Choice(names), Value::Literal(literal @ Literal::Numbers(..))) => {
                    let index = literal.numbers().first().map_or(0, |x| *x as usize);
                    let name = names.get(index).ok_or_else(|| {
                        let message = format!("`{}` has no choice {index}", input.name);
                        Refusal::new("import-value", message)
                    })?;
                    Value::Literal(Literal::Text((*name).to_owned()))
                }
                (_, value) => value,
            };
            inputs.push((input.name.clone(), value));
        }
        for port in spec.inputs {
            let PortType::Choice(names) = port.ty else {
                continue;
            };
            // `ND_randomfloat_integer` is told by its last word, others by their result.
            let last = definition.name.rsplit('_').next().unwrap_or("");
            let wanted = match port.name {
                "signature" | "to" => [last, self.ty],
                "hash" => ["materialx"; 2],
                _ => continue,
            };
            let named = wanted.iter().find(|name| names.contains(name));
            if let Some(name) = named.filter(|_| definition.input(port.name).is_none()) {
                let name = Value::Literal(Literal::Text((*name).to_owned()));
                inputs.push((port.name.to_owned(), name));
            }
        }
        let value = builder.node(&definition.node, inputs, "out")?;
        // Types that follow from the inputs in other ways are those of the definition.
        let known = matches!(
            spec.output,
            OutputType::Exactly(_)
                | OutputType::Widest
                | OutputType::Whole
                | OutputType::Named(_)
                | OutputType::Stops
                | OutputType::Picture { .. }
        );
        Ok(match (value, Type::by_name(self.ty)) {
            (Value::Link(link), Some(ty)) if !known => Value::Link(Link { ty, ..link }),
            (value, _) => value,
        })
    }
}

impl Call for NodeCall<'_, '_> {
    fn input(
        &mut self,
        builder: &mut Builder,
        name: &str,
        _: Option<&Value>,
    ) -> Result<Value, Refusal> {
        let definition = self.definition;
        let Some(input) = definition.input(name) else {
            let message = format!("`{}` has no input `{name}`", definition.name);
            return Err(Refusal::new("import-input-missing", message));
        };
        let origin = (self.network).origin(self.key.scope, self.key.node, definition, name);
        let value = (self.network).of_origin(builder, origin, &input.ty)?;
        // What is connected may have another type than the input says.
        match Type::by_name(&input.ty) {
            Some(ty) if value.ty().is_some_and(|own| own != ty) => builder.converted(value, ty),
            _ => Ok(value),
        }
    }

    fn is_given(&self, name: &str) -> bool {
        let input = self.network.tree.input(self.key.node, name);
        input.is_some_and(|input| {
            let element = self.network.tree.get(input);
            ["value", "nodename", "nodegraph", "interfacename", "output"]
                .iter()
                .any(|key| element.attribute(key).is_some())
        })
    }

    fn coordinate(&mut self, builder: &mut Builder) -> Result<Value, Refusal> {
        builder.node("texcoord", Vec::new(), "out")
    }

    fn output(&self) -> (Type, &str) {
        (Type::by_name(self.ty).unwrap_or(Type::Float), self.output)
    }

    fn color_space(&mut self, name: &str) -> Result<&'static str, Refusal> {
        let key = self.key;
        let origin = (self.network).origin(key.scope, key.node, self.definition, name);
        let space = match origin {
            Origin::Value(element) | Origin::Interface(element) => {
                self.network.tree.inherited(element, "colorspace")
            }
            _ => None,
        };
        // Data has no colours.
        if !self.ty.starts_with("color") {
            return Ok("lin_rec709");
        }
        literal::picture_space(space)
    }
}
