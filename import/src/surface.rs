//! Shaders of surfaces as the node `surface`: which of their inputs becomes what, and what is left.
//! What a shader's inputs hold when nothing is said, and what they become, are tables.

use crate::build::{Builder, Refusal};
use crate::eval::{Call, eval};
use crate::materialx::definition::{self, Definition};
use crate::materialx::literal;
use crate::rule::{Expr, Rules};
use crate::value::{Link, Literal, Value};
use mipless_graph::{Binding, OutputType, Reference, Type};
use std::sync::OnceLock;

/// The inputs of shaders with their defaults, as MaterialX's own documents have them.
const SHADERS: &str = include_str!("surface/shaders.txt");
const RULES: &str = include_str!("surface/rules.txt");

/// The node that materials end in.
pub(crate) const NODE: &str = "surface";

/// A shader that is a surface.
#[derive(Debug)]
pub(crate) struct Shader {
    definition: Definition,
    /// The model whose formulas the parts have.
    pub(crate) model: String,
    /// Whether its names are the model's, so that a graph may give all parts.
    pub(crate) is_model: bool,
    ports: Vec<Port>,
}

/// What becomes a port of `surface`.
#[derive(Debug)]
struct Port {
    name: String,
    part: String,
    rule: Expr,
    /// The inputs of the shader that it is made of.
    reads: Vec<String>,
}

fn shaders() -> &'static [Shader] {
    static PARSED: OnceLock<Vec<Shader>> = OnceLock::new();
    PARSED.get_or_init(|| {
        let rules = Rules::parse(RULES);
        SHADERS
            .lines()
            .map(|line| parse(definition::parse(line), &rules))
            .collect()
    })
}

fn parse(definition: Definition, rules: &Rules) -> Shader {
    let node = &definition.node;
    let text = |key: &str| match rules.get(&format!("{node}.{key}")) {
        Some(Expr::Text(text)) => Some(text.clone()),
        _ => None,
    };
    let own = text("model");
    let mut ports: Vec<Port> = rules
        .iter()
        .filter_map(|(key, rule)| {
            let (name, part) = key.strip_prefix(&format!("{node}."))?.split_once('.')?;
            let mut reads = Vec::new();
            rule.ports(&mut reads);
            Some(Port {
                name: name.to_owned(),
                part: part.to_owned(),
                rule: rule.clone(),
                reads,
            })
        })
        .collect();
    ports.sort_by(|a, b| a.name.cmp(&b.name));
    Shader {
        is_model: own.is_some(),
        model: own.or_else(|| text("parts")).expect("a shader has a model"),
        definition,
        ports,
    }
}

/// The shader of a category, if it is a surface.
pub(crate) fn shader(category: &str) -> Option<&'static Shader> {
    shaders()
        .iter()
        .find(|shader| shader.definition.node == category)
}

/// The shader that is a model of `surface`.
pub(crate) fn of_model(model: &str) -> Option<&'static Shader> {
    shaders()
        .iter()
        .find(|shader| shader.is_model && shader.model == model)
}

impl Shader {
    /// What it is called.
    pub(crate) fn category(&self) -> &str {
        &self.definition.node
    }

    /// The inputs that a port of `surface` is made of, the one that it is called after first.
    pub(crate) fn reads(&self, port: &str) -> Option<&[String]> {
        let port = self.ports.iter().find(|own| own.name == port)?;
        Some(&port.reads)
    }

    /// The type of an input.
    pub(crate) fn ty(&self, input: &str) -> Option<&str> {
        Some(&self.definition.input(input)?.ty)
    }

    /// Whether an input holds these numbers when nothing is said; one number is that of all components.
    pub(crate) fn holds(&self, input: &str, numbers: &[f32]) -> bool {
        self.default(input)
            .is_some_and(|default| are_same(default.numbers(), numbers))
    }

    /// Whether a port, which is a product of inputs, is these numbers when nothing is said.
    pub(crate) fn shows(&self, reads: &[String], numbers: &[f32]) -> bool {
        let mut product = vec![1.0];
        for read in reads {
            let Some(default) = self.default(read) else {
                return false;
            };
            let factor = default.numbers();
            let at = |of: &[f64], i: usize| of[i.min(of.len() - 1)];
            product = (0..product.len().max(factor.len()))
                .map(|i| at(&product, i) * at(factor, i))
                .collect();
        }
        are_same(&product, numbers)
    }

    /// The part that shows an input, and the output's name.
    pub(crate) fn part(&self, input: &str) -> Option<(&str, &str)> {
        let reads = |port: &&Port| port.reads.iter().any(|read| read == input);
        let port = self.ports.iter().find(reads)?;
        let name = if self.is_model {
            &port.part
        } else {
            &port.reads[0]
        };
        Some((&port.part, name))
    }

    /// Whether an input holds what it holds when nothing is said.
    pub(crate) fn is_default(&self, input: &str, value: &Value) -> bool {
        match (self.default(input), value) {
            (Some(default), Value::Literal(value)) => default.numbers() == value.numbers(),
            _ => false,
        }
    }

    /// Whether an input is something of the geometry where nothing is connected.
    pub(crate) fn is_geometric(&self, input: &str) -> bool {
        let input = self.definition.input(input);
        input.is_some_and(|input| input.geometric.is_some())
    }

    fn default(&self, input: &str) -> Option<Literal> {
        let input = self.definition.input(input)?;
        literal::parse(input.value.as_deref()?, &input.ty).ok()
    }

    /// The node, with what is given of the shader's inputs.
    pub(crate) fn node(
        &self,
        builder: &mut Builder,
        given: &[(String, Value)],
    ) -> Result<Reference, Refusal> {
        let text = |text: &str| Value::Literal(Literal::Text(text.to_owned()));
        let mut inputs = vec![("model".to_owned(), text(&self.model))];
        for port in &self.ports {
            let mut call = Given {
                shader: self,
                inputs: given,
                lacks: false,
            };
            let value = eval(&port.rule, builder, &mut call);
            if !call.lacks {
                inputs.push((port.name.clone(), value?));
            }
        }
        match builder.node(NODE, inputs, "out")? {
            Value::Link(Link {
                binding: Binding::Node(reference),
                ..
            }) => Ok(reference),
            _ => Err(Refusal::new("import-rule", "a surface is a node")),
        }
    }
}

/// Whether numbers are the same; one is that of all components.
fn are_same(own: &[f64], given: &[f32]) -> bool {
    let at = |i: usize| given.get(i).or(given.first()).copied();
    let own_at = |i: usize| own.get(i).or(own.first()).map(|x| *x as f32);
    (0..own.len().max(given.len())).all(|i| at(i) == own_at(i))
}

/// Whether a part of `surface` has this name, as an output of its own must not where all parts are outputs.
pub(crate) fn is_part(builder: &Builder, model: &str, name: &str) -> bool {
    let parts = builder.spec(NODE).map(|spec| &spec.output);
    match parts {
        Some(OutputType::Material { parts, .. }) => parts
            .iter()
            .any(|part| part.name == name && part.models.contains(&model)),
        _ => false,
    }
}

/// What is given of a shader's inputs, as the rules see it.
struct Given<'a> {
    shader: &'a Shader,
    inputs: &'a [(String, Value)],
    /// Whether something was asked for that is neither given nor has a default.
    lacks: bool,
}

impl Call for Given<'_> {
    fn input(
        &mut self,
        builder: &mut Builder,
        name: &str,
        _: Option<&Value>,
    ) -> Result<Value, Refusal> {
        let Some((_, value)) = self.inputs.iter().find(|(own, _)| own == name) else {
            return Ok(match self.shader.default(name) {
                Some(literal) => Value::Literal(literal),
                None => {
                    self.lacks = true;
                    Value::float(0.0)
                }
            });
        };
        let ty = self.shader.definition.input(name);
        match ty.and_then(|input| Type::by_name(&input.ty)) {
            Some(ty) => builder.converted(value.clone(), ty),
            None => Ok(value.clone()),
        }
    }

    fn is_given(&self, name: &str) -> bool {
        self.inputs.iter().any(|(own, _)| own == name)
    }

    fn coordinate(&mut self, builder: &mut Builder) -> Result<Value, Refusal> {
        builder.node("texcoord", Vec::new(), "out")
    }

    fn output(&self) -> (Type, &str) {
        (Type::Float, "out")
    }
}
