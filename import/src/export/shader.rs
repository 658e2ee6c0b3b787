//! Materials as MaterialX's shaders: what a `surface` reads becomes outputs of the nodegraph, which the
//! shader of its model takes.

use super::bind;
use crate::surface::{self, Shader};
use mipless_graph::{
    Default as PortDefault, Diagnostic, Graph, Input, Literal, Node, NodeId, NodeSpec, Output,
    Source, Type,
};

/// What an input of a shader holds: a text, or an output of the nodegraph by its number.
#[derive(Clone, Debug)]
pub(super) enum Holds {
    Value(String),
    Output(usize),
}

/// A shader that is written.
#[derive(Debug)]
pub(super) struct Written {
    pub(super) name: String,
    pub(super) category: String,
    /// Name, type, and what it holds.
    pub(super) inputs: Vec<(String, String, Holds)>,
    /// The same of the displacement beside it.
    pub(super) displacement: Vec<(String, String, Holds)>,
}

/// A graph without materials, and the shaders that they become.
pub(super) struct Apart {
    pub(super) graph: Graph,
    pub(super) shaders: Vec<Written>,
    pub(super) diagnostics: Vec<Diagnostic>,
}

/// Takes the materials out of a graph.
pub(super) fn apart(graph: &Graph, specs: &[&'static NodeSpec]) -> Apart {
    let mut maker = Maker {
        specs,
        graph: graph.clone(),
        diagnostics: Vec::new(),
    };
    let is_part = |output: &Output| graph.node(output.node).spec.material().is_some();
    let mut shaders = Vec::new();
    maker.graph.outputs.retain(|output| !is_part(output));
    let own = maker.graph.outputs.len();
    // In the order of the outputs that show them.
    let mut materials: Vec<(usize, &Node)> = (graph.materials.iter())
        .map(|material| {
            let shows = |output: &Output| graph.node(output.node).pointer == material.pointer;
            let first = graph.outputs.iter().position(shows);
            (first.unwrap_or(usize::MAX), material)
        })
        .collect();
    materials.sort_by_key(|(first, _)| *first);
    for (first, material) in materials {
        let shader = match material.literal("model") {
            Literal::Text(model) => surface::of_model(model),
            _ => None,
        };
        if let Some(shader) = shader {
            let name = graph.outputs.get(first).and_then(|output| {
                let part = graph.node(output.node).part()?;
                let name = output.name.strip_suffix(part.name)?.strip_suffix('_')?;
                (!name.is_empty()).then_some(name)
            });
            let name = bind::name(name.unwrap_or(&material.name));
            shaders.push(maker.shader(material, name, shader, own));
        }
    }
    // A document that has materials is asked for what they read.
    let is_read = |index: usize| {
        let inputs = shaders.iter().flat_map(|shader: &Written| &shader.inputs);
        let mut reads = inputs.map(|(.., holds)| holds);
        reads.any(|holds| matches!(holds, Holds::Output(own) if *own == index))
    };
    for index in 0..own {
        if !shaders.is_empty() && !is_read(index) {
            let output = &maker.graph.outputs[index];
            let message = format!(
                "no shader reads `{}`, which is an output of the nodegraph alone",
                output.name
            );
            let node = maker.graph.node(output.node);
            let note = Diagnostic::note("export-unread", message);
            let note = note.at(&*node.pointer).in_node(&*node.name);
            maker.diagnostics.push(note);
        }
    }
    Apart {
        graph: maker.graph,
        shaders,
        diagnostics: maker.diagnostics,
    }
}

struct Maker<'a> {
    specs: &'a [&'static NodeSpec],
    graph: Graph,
    diagnostics: Vec<Diagnostic>,
}

impl Maker<'_> {
    /// The shader of a material; of the graph's outputs the first `own` are no parts of materials, and those
    /// that are called as an input of the shader are that input.
    fn shader(&mut self, material: &Node, name: String, shader: &Shader, own: usize) -> Written {
        let mut written = Written {
            name,
            category: shader.category().to_owned(),
            inputs: Vec::new(),
            displacement: Vec::new(),
        };
        for (port, input) in material.spec.inputs.iter().zip(&material.inputs) {
            if port.uniform || port.default == PortDefault::Surface {
                continue;
            }
            let Some(reads) = shader.reads(port.name) else {
                if !is_default(port.default, input) {
                    let message = format!(
                        "MaterialX's `{}` has no `{}`, which is left out",
                        written.category, port.name
                    );
                    let note = Diagnostic::note("export-approximated", message);
                    let note = note.at(&*material.pointer).in_node(&*material.name);
                    self.diagnostics.push(note);
                }
                continue;
            };
            let (name, beside) = reads.split_first().expect("a port is made of an input");
            let ty = shader.ty(name).unwrap_or(match port.name {
                "height" | "scale" => "float",
                _ => input.ty.name(),
            });
            let displaces = shader.ty(name).is_none();
            let holds = match &input.source {
                // What both hold when nothing is said need not be said.
                Source::Literal(literal) if shader.shows(reads, &literal.numbers()) => continue,
                Source::Literal(_) if displaces && is_default(port.default, input) => continue,
                Source::Literal(literal) if port.name != "normal" => {
                    bind::value(literal, ty).map(Holds::Value)
                }
                Source::Literal(_) if is_default(port.default, input) => continue,
                _ => self.output(name, input, ty).map(Holds::Output),
            };
            let Some(holds) = holds else {
                continue;
            };
            let entry = (name.clone(), ty.to_owned(), holds);
            if displaces {
                written.displacement.push(entry);
                continue;
            }
            written.inputs.push(entry);
            // What it is multiplied by must leave it as it is.
            for factor in beside {
                if let Some(ty) = shader.ty(factor)
                    && !shader.holds(factor, &[1.0])
                {
                    let one = Holds::Value("1".to_owned());
                    written.inputs.push((factor.clone(), ty.to_owned(), one));
                }
            }
        }
        let prefix = format!("{}_", written.name);
        for index in 0..own {
            let output = &self.graph.outputs[index];
            let name = output.name.strip_prefix(&prefix).unwrap_or(&output.name);
            let name = name.strip_suffix("_input").unwrap_or(name).to_owned();
            let is_there = written.inputs.iter().any(|(own, ..)| *own == name);
            if let (Some(ty), false) = (shader.ty(&name), is_there) {
                let (from, to) = (output.ty.name(), ty.to_owned());
                let wide = |ty: &str| Type::by_name(ty).map_or(0, Type::components);
                if from == to || wide(&to) == 1 && wide(from) == 1 {
                    let input = (name, from.to_owned(), Holds::Output(index));
                    written.inputs.push(input);
                }
            }
        }
        written
    }

    /// An output that gives what an input reads, as a type.
    fn output(&mut self, name: &str, input: &Input, ty: &str) -> Option<usize> {
        let ty = Type::by_name(ty)?;
        let node = match input.source {
            Source::Node(id) if self.graph.node(id).ty == ty => id,
            _ => self.converted(input, ty)?,
        };
        let taken = |name: &str| self.graph.outputs.iter().any(|output| output.name == name);
        let mut unused = name.to_owned();
        let mut count = 1;
        while taken(&unused) {
            count += 1;
            unused = format!("{name}_{count}");
        }
        self.graph.outputs.push(Output {
            name: unused,
            node,
            ty,
        });
        Some(self.graph.outputs.len() - 1)
    }

    /// A node that gives what an input reads as a type.
    fn converted(&mut self, input: &Input, ty: Type) -> Option<NodeId> {
        let node = if input.from == ty { "dot" } else { "convert" };
        let definition = self.specs.iter().position(|spec| spec.name == node)?;
        let spec = self.specs[definition];
        let text = |text: &str| Input {
            source: Source::Literal(Literal::Text(text.to_owned())),
            from: Type::String,
            ty: Type::String,
        };
        let source = Input {
            ty: input.from,
            ..input.clone()
        };
        let inputs = spec.inputs.iter().map(|port| match port.name {
            "in" => source.clone(),
            "to" => text(ty.name()),
            _ => text(""),
        });
        let id = NodeId(u32::try_from(self.graph.nodes.len()).ok()?);
        self.graph.nodes.push(Node {
            name: node.to_owned(),
            pointer: String::new(),
            definition,
            spec,
            ty,
            inputs: inputs.collect(),
        });
        Some(id)
    }
}

/// Whether a port holds what it holds when nothing is said.
fn is_default(default: PortDefault, input: &Input) -> bool {
    let Source::Literal(literal) = &input.source else {
        return false;
    };
    match default {
        PortDefault::Float(x) => literal.numbers() == [x],
        PortDefault::Color3(x) => literal.numbers() == x,
        _ => false,
    }
}
