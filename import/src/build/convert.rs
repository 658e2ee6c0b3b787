//! Types: MaterialX's `convert`, and parts of vectors.

use super::{Builder, Refusal};
use crate::value::{Link, Literal, Value};
use mipless_graph::{Binding, Type};

impl Builder {
    /// A value as another type, by the rules of MaterialX's `convert`.
    pub(crate) fn converted(&mut self, value: Value, to: Type) -> Result<Value, Refusal> {
        let link = match value {
            Value::Literal(literal) => {
                return match literal.converted(to) {
                    Some(literal) => Ok(Value::Literal(literal)),
                    None => Err(Refusal::new(
                        "import-type",
                        format!("a `{to}` is wanted here"),
                    )),
                };
            }
            Value::Link(link) => link,
        };
        let (from, count) = (link.ty, link.ty.components());
        let scalar = |ty: Type| ty.components() == 1;
        match to {
            _ if from == to => Ok(Value::Link(link)),
            _ if count == 0 || to.components() == 0 => {
                let message = format!("a `{from}` is no `{to}`");
                Err(Refusal::new("import-type", message))
            }
            // Truth values and integers are numbers.
            _ if scalar(from) && scalar(to) => Ok(Value::Link(Link { ty: to, ..link })),
            _ if scalar(to) => self.part(&Value::Link(link), 0),
            // Alpha and w of a number are the number, and w of anything else is 1.
            Type::Color4 if scalar(from) => {
                let value = Value::Link(Link {
                    ty: Type::Float,
                    ..link
                });
                self.combined(&[value.clone(), value.clone(), value.clone(), value], to)
            }
            Type::Vector4 if count < 4 => {
                let value = Value::Link(link);
                let mut parts = Vec::with_capacity(4);
                for i in 0..3 {
                    parts.push(if scalar(from) {
                        self.converted(value.clone(), Type::Float)?
                    } else if i < count {
                        self.part(&value, i)?
                    } else {
                        Value::float(0.0)
                    });
                }
                parts.push(if scalar(from) {
                    parts[0].clone()
                } else {
                    Value::float(1.0)
                });
                self.combined(&parts, to)
            }
            _ => {
                let ty = if scalar(from) { Type::Float } else { from };
                let inputs = vec![
                    ("in".to_owned(), Value::Link(Link { ty, ..link })),
                    (
                        "to".to_owned(),
                        Value::Literal(Literal::Text(to.name().to_owned())),
                    ),
                ];
                self.node("convert", inputs, "out")
            }
        }
    }

    /// One component, from 0; of a matrix, one row.
    pub(crate) fn part(&mut self, value: &Value, index: usize) -> Result<Value, Refusal> {
        let beyond = || {
            let message = format!("there is no component {index}");
            Refusal::new("import-type", message)
        };
        if let Value::Link(link) = value
            && let Some(part) = self.combined_from(link, index)
        {
            return Ok(part);
        }
        match value {
            Value::Literal(Literal::Matrix(numbers)) => {
                let size = numbers.len().isqrt();
                let row = numbers.chunks(size.max(1)).nth(index).ok_or_else(beyond)?;
                let ty = if size == 4 {
                    Type::Vector4
                } else {
                    Type::Vector3
                };
                Literal::of(ty, row).map(Value::Literal).ok_or_else(beyond)
            }
            Value::Literal(literal) => {
                let number = literal.numbers().get(index).ok_or_else(beyond)?;
                Ok(Value::float(*number))
            }
            Value::Link(link) if link.ty.components() == 1 && index == 0 => Ok(value.clone()),
            Value::Link(link) if index < link.ty.components() => {
                let inputs = vec![
                    ("in".to_owned(), value.clone()),
                    ("index".to_owned(), Value::float(index as f64)),
                ];
                self.node("extract", inputs, "out")
            }
            Value::Link(_) => Err(beyond()),
        }
    }

    /// What a component was, of numbers that were combined: an input of the node that did.
    fn combined_from(&self, link: &Link, index: usize) -> Option<Value> {
        let Binding::Node(reference) = &link.binding else {
            return None;
        };
        let node = self.document.body.nodes.get(&reference.node)?;
        let count = link.ty.components();
        // As many inputs as components: each is a number.
        if node.ty != format!("combine{count}") || index >= count {
            return None;
        }
        let binding = node.inputs.get(&format!("in{}", index + 1))?;
        Some(match binding {
            Binding::Value(json) => Value::float(json.as_f64()?),
            binding => Value::Link(Link {
                binding: binding.clone(),
                ty: Type::Float,
            }),
        })
    }

    /// Numbers as a value of a type with as many components.
    pub(crate) fn combined(&mut self, parts: &[Value], to: Type) -> Result<Value, Refusal> {
        let literals: Option<Vec<f64>> = (parts.iter())
            .map(|part| match part {
                Value::Literal(literal) => literal.numbers().first().copied(),
                Value::Link(_) => None,
            })
            .collect();
        if let Some(literal) = literals.and_then(|numbers| Literal::of(to, &numbers)) {
            return Ok(Value::Literal(literal));
        }
        let name = match parts.len() {
            1 => return Ok(parts[0].clone()),
            2 => "combine2",
            3 => "combine3",
            _ => "combine4",
        };
        let inputs = (parts.iter().enumerate())
            .map(|(i, part)| (format!("in{}", i + 1), part.clone()))
            .collect();
        let value = self.node(name, inputs, "out")?;
        self.converted(value, to)
    }

    /// Three or four numbers as a vector, which a document writes like a colour.
    pub(super) fn vector(&mut self, literal: &Literal) -> Result<Value, Refusal> {
        let Literal::Numbers(ty, numbers) = literal else {
            return Ok(Value::Literal(literal.clone()));
        };
        let color = match ty {
            Type::Vector3 => Type::Color3,
            _ => Type::Color4,
        };
        let inputs = vec![
            (
                "in".to_owned(),
                Value::Literal(Literal::Numbers(color, *numbers)),
            ),
            (
                "to".to_owned(),
                Value::Literal(Literal::Text(ty.name().to_owned())),
            ),
        ];
        self.node("convert", inputs, "out")
    }

    /// A literal as a node.
    pub(crate) fn constant(&mut self, literal: &Literal) -> Result<Value, Refusal> {
        match literal {
            Literal::Numbers(Type::Vector3 | Type::Vector4, _) => self.vector(literal),
            Literal::Numbers(ty, numbers) => {
                let ty = if ty.components() == 1 {
                    Type::Float
                } else {
                    *ty
                };
                let value = Value::Literal(Literal::Numbers(ty, *numbers));
                self.node("constant", vec![("value".to_owned(), value)], "out")
            }
            _ => {
                let message = "a text or a matrix is no texture";
                Err(Refusal::new("import-type", message))
            }
        }
    }
}
