//! Materials: nodes that end a graph, each of whose parts becomes an output.

use super::super::{Context, literal};
use super::{Kind, Port, Template, Wire, position_u32};
use crate::{Diagnostic, Graph, Literal, MaterialPart, Node, NodeId, Output, Source, Type};

/// A node that gives a material, with what its template says of it.
struct Material<'a> {
    parts: &'static [MaterialPart],
    model: &'static str,
    /// What `out` is, as a number of an output.
    out: u32,
    name: &'a str,
}

/// The position of a name among those of a choice.
fn position(names: &[&str], name: &str) -> u32 {
    let found = names.iter().position(|known| *known == name);
    position_u32(found.unwrap_or_default())
}

/// The node of a template, if it gives a material. Mistakes in its literals are reported where they are
/// read; until then its defaults stand for them.
fn material<'a>(
    context: &Context<'_>,
    template: &Template<'a>,
    node: usize,
) -> Option<Material<'a>> {
    let Kind::Spec(spec) = template.nodes[node].kind else {
        return None;
    };
    let spec = context.specs[spec];
    let (model, parts) = spec.material()?;
    let chosen = |port: &str| -> Option<(&'static [&'static str], u32)> {
        let index = spec.input(port)?;
        let crate::PortType::Choice(names) = spec.inputs[index].ty else {
            return None;
        };
        let wires = &template.nodes[node].wires;
        let wire = wires.iter().find(|(port, _)| *port as usize == index);
        let written = match wire {
            Some((_, Wire::Literal(value))) => literal::choice(value, names).ok(),
            _ => literal::default(&spec.inputs[index], Type::String),
        };
        match written.or_else(|| literal::default(&spec.inputs[index], Type::String))? {
            Literal::Text(name) => Some((names, position(names, &name))),
            _ => None,
        }
    };
    let (models, model) = chosen(model)?;
    let (_, out) = chosen("output")?;
    Some(Material {
        parts,
        model: models[model as usize],
        out: out + 1,
        name: template.nodes[node].name,
    })
}

/// The outputs that one output of a graph stands for: of a material all parts of its model, by their own
/// names. `None` for what is an output under its own name.
pub(super) fn parts(
    context: &mut Context<'_>,
    template: &Template<'_>,
    port: Port,
    name: &str,
    place: &Diagnostic,
) -> Option<Vec<(&'static str, Port)>> {
    let material = material(context, template, port.node as usize)?;
    let at = |code, message| Diagnostic {
        code,
        message,
        ..place.clone()
    };
    if !template.name.is_empty() {
        let message = format!("`{}` is a material inside a sub-graph", material.name);
        let help = "a material ends the graph itself: give its inputs as outputs of the sub-graph";
        context.report(at("material-inside", message).help(help));
        return None;
    }
    let output = if port.output == 0 {
        material.out
    } else {
        port.output
    };
    // 0 is `out`, and 1 the name for all.
    if output > 1 {
        let part = &material.parts[output as usize - 2];
        if !part.is_of(material.model) {
            let names = material
                .parts
                .iter()
                .filter(|part| part.is_of(material.model));
            let names: Vec<&str> = names.map(|part| part.name).collect();
            let message = format!(
                "`{}` is a material by `{}`, which has no `{}`",
                material.name, material.model, part.name
            );
            let help = format!("it has `{}`", names.join("`, `"));
            context.report(at("unknown-output", message).help(help));
        }
        return None;
    }
    let mut parts = Vec::new();
    for (index, part) in material.parts.iter().enumerate() {
        if !part.models.contains(&material.model) {
            continue;
        }
        let port = Port {
            output: position_u32(index + 2),
            ..port
        };
        let own = template.body.outputs.contains_key(part.name) && part.name != name;
        if own || template.output_names.contains(&part.name) {
            let message = format!(
                "`{}` gives an output `{}`, and the graph has another one of this name",
                material.name, part.name
            );
            let help = format!(
                "name the parts that are wanted one by one: `\"NAME\": {{ \"node\": \"{}\", \"output\": \"{}\" }}`",
                material.name, part.name
            );
            context.report(at("duplicate-output", message).help(help));
            return None;
        }
        parts.push((part.name, port));
    }
    Some(parts)
}

/// Whether an input reads a material, which is reported.
pub(super) fn is_read(
    context: &mut Context<'_>,
    template: &Template<'_>,
    port: Port,
    place: &Diagnostic,
) -> bool {
    let Some(material) = material(context, template, port.node as usize) else {
        return false;
    };
    let message = format!("`{}` is a material, which no node reads", material.name);
    let help = "a material ends the graph: read what it reads, and make it an output of the graph";
    let diagnostic = Diagnostic {
        code: "material-inside",
        message,
        ..place.clone()
    };
    context.report(diagnostic.help(help));
    true
}

/// The node of a part of a material, whose inputs are defaults where the part does not read them.
pub(in super::super) fn part(mut node: Node) -> Node {
    let Some(part) = node.part() else {
        // All of them: a node that no output reads.
        return node;
    };
    for (port, input) in node.spec.inputs.iter().zip(&mut node.inputs) {
        if !port.uniform && !part.reads.contains(&port.name) {
            // Coordinates that nothing reads are no position.
            let unread = || Literal::Numbers(input.ty, [0.0; 4]);
            input.source = Source::Literal(literal::default(port, input.ty).unwrap_or_else(unread));
            input.from = input.ty;
        }
    }
    node.ty = part.ty;
    node
}

impl Graph {
    /// The graph with parts of one of its materials as its outputs, whatever its own are: by their names,
    /// and of those that the material has. What no part needs is not computed.
    ///
    /// # Panics
    /// If the node gives no material: a bug of the caller.
    pub fn with_parts(&self, material: &Node, names: &[&str]) -> Self {
        let (_, parts) = material
            .spec
            .material()
            .expect("a node that gives a material");
        let output = material.spec.input("output").expect("a choice of a part");
        let mut graph = Self {
            outputs: Vec::new(),
            ..self.clone()
        };
        for part in names
            .iter()
            .filter_map(|name| parts.iter().find(|part| part.name == *name))
        {
            let mut node = material.clone();
            node.name = format!("{}.{}", material.name, part.name);
            node.inputs[output].source = Source::Literal(Literal::Text(part.name.to_owned()));
            let id = NodeId(position_u32(graph.nodes.len()));
            graph.nodes.push(self::part(node));
            graph.outputs.push(Output {
                name: part.name.to_owned(),
                node: id,
                ty: part.ty,
            });
        }
        graph
    }
}
