//! Templates become the nodes of the graph, with a stack of frames instead of recursion.

use serde_json::Value;

use super::connect::{Bound, Place, check_range, conversion, convert, origin};
use super::template::{Kind, Template, Wire, material, position_u32};
use super::{Context, literal, range};
use crate::diagnostic::escape;
use crate::document::{Document, InputEntry};
use crate::{
    Diagnostic, FileReference, Graph, Images, Input, Literal, Node, NodeId, NodeSpec, Output,
    OutputType, Parameter, ParameterId, PortType, Source, Type,
};

/// What became of a node of a template.
#[derive(Clone, Debug)]
enum Made {
    /// Something wrong, which is reported; whatever needs it is wrong without another report.
    Nothing,
    Node(NodeId, Type),
    /// A node of which other outputs than `out` are read: one node of the graph each.
    Several(Vec<(u32, Option<(NodeId, Type)>)>),
    /// The outputs of a sub-graph.
    Graph(Vec<Option<(NodeId, Type)>>),
}

/// A body that is being expanded.
struct Frame {
    template: usize,
    /// How many nodes of its order are done.
    done: usize,
    /// The path of its nodes, ending in `/` unless empty.
    prefix: String,
    /// Its inputs; `None` where they are wrong.
    inputs: Vec<Option<Bound>>,
    made: Vec<Made>,
    /// The node of the outer frame that it is.
    node: usize,
}

/// Expands the graph. What is wrong is reported and left out: the result is then not to be used.
pub(super) fn expand(
    context: &mut Context<'_>,
    document: &Document,
    templates: &[Template<'_>],
) -> Graph {
    let mut graph = Graph {
        name: (document.name.clone()).unwrap_or_else(|| Graph::NAMELESS.to_owned()),
        parameters: Vec::new(),
        nodes: Vec::new(),
        outputs: Vec::new(),
        materials: Vec::new(),
        images: Images::default(),
    };
    let mut inputs = Vec::with_capacity(document.body.inputs.len());
    for (index, (name, entry)) in document.body.inputs.iter().enumerate() {
        let pointer = format!("/inputs/{}", escape(name));
        let ty = templates[0].inputs[index];
        let value = ty.and_then(|ty| input_value(context, &pointer, entry, ty));
        inputs.push(value.is_some().then_some(()).zip(ty).map(|((), ty)| Bound {
            source: Source::Parameter(ParameterId(position_u32(index))),
            from: ty,
            seen: ty,
        }));
        graph.parameters.push(Parameter {
            name: name.clone(),
            ty: ty.unwrap_or(Type::Float),
            value: value.unwrap_or(Literal::float(0.0)),
            min: entry.min.map(|bound| bound as f32),
            max: entry.max.map(|bound| bound as f32),
            soft_min: entry.soft_min.map(|bound| bound as f32),
            soft_max: entry.soft_max.map(|bound| bound as f32),
            doc: entry.doc.clone().unwrap_or_default(),
        });
    }
    let mut stack = vec![Frame::new(templates, 0, String::new(), inputs, 0)];
    let outputs = loop {
        let Some(frame) = stack.last_mut() else {
            unreachable!("the loop ends at the last frame")
        };
        let template = &templates[frame.template];
        let Some(index) = template.order.get(frame.done).map(|index| *index as usize) else {
            let outputs = outputs(template, &frame.made);
            let node = frame.node;
            stack.pop();
            match stack.last_mut() {
                Some(outer) => outer.made[node] = Made::Graph(outputs),
                None => break outputs,
            }
            continue;
        };
        frame.done += 1;
        match template.nodes[index].kind {
            Kind::Broken => {}
            Kind::Spec(definition) => {
                let mut make = |output: u32| {
                    let of = (definition, output);
                    node(context, &mut graph, template, frame, index, of)
                };
                frame.made[index] = match &template.nodes[index].outputs[..] {
                    [] | [0] => make(0).map_or(Made::Nothing, |(id, ty)| Made::Node(id, ty)),
                    outputs => Made::Several(outputs.iter().map(|&i| (i, make(i))).collect()),
                };
            }
            Kind::Graph(inner) => {
                let prefix = format!("{}{}/", frame.prefix, template.nodes[index].name);
                let inputs =
                    sub_graph_inputs(context, &graph, template, frame, index, &templates[inner]);
                stack.push(Frame::new(templates, inner, prefix, inputs, index));
            }
        }
    };
    for (name, output) in templates[0].output_names.iter().zip(outputs) {
        if let Some((node, ty)) = output {
            graph.outputs.push(Output {
                name: (*name).to_owned(),
                node,
                ty,
            });
        }
    }
    graph
}

impl Frame {
    fn new(
        templates: &[Template<'_>],
        template: usize,
        prefix: String,
        inputs: Vec<Option<Bound>>,
        node: usize,
    ) -> Self {
        let made = vec![Made::Nothing; templates[template].nodes.len()];
        Self {
            template,
            done: 0,
            prefix,
            inputs,
            made,
            node,
        }
    }

    /// What a wire carries; `None` if that is wrong, which is reported, or for literals.
    fn bound(&self, wire: Wire<'_>) -> Option<Bound> {
        match wire {
            Wire::Literal(_) | Wire::Broken => None,
            Wire::Input(input) => self.inputs[input as usize].clone(),
            Wire::Node(port) => {
                let (node, ty) = self.made[port.node as usize].output(port.output)?;
                Some(Bound {
                    source: Source::Node(node),
                    from: ty,
                    seen: ty,
                })
            }
        }
    }
}

impl Made {
    fn output(&self, output: u32) -> Option<(NodeId, Type)> {
        match self {
            Self::Nothing => None,
            Self::Node(node, ty) => Some((*node, *ty)),
            Self::Several(made) => made.iter().find(|(i, _)| *i == output)?.1,
            Self::Graph(outputs) => outputs.get(output as usize).copied().flatten(),
        }
    }
}

fn outputs(template: &Template<'_>, made: &[Made]) -> Vec<Option<(NodeId, Type)>> {
    let ports = template.outputs.iter();
    ports
        .map(|port| port.and_then(|port| made[port.node as usize].output(port.output)))
        .collect()
}

/// The default of an input of a graph, against its own bounds.
fn input_value(
    context: &mut Context<'_>,
    pointer: &str,
    entry: &InputEntry,
    ty: Type,
) -> Option<Literal> {
    let at = |code, message: String, key: &str| {
        Diagnostic::error(code, message).at(format!("{pointer}/{key}"))
    };
    for (key, bound) in [
        ("min", entry.min),
        ("max", entry.max),
        ("soft_min", entry.soft_min),
        ("soft_max", entry.soft_max),
    ] {
        if let Some(bound) = bound.filter(|bound| !(*bound as f32).is_finite()) {
            let message = format!("{bound:e} is not finite as a 32-bit float");
            context.report(at("number-not-finite", message, key));
            return None;
        }
    }
    if let (Some(min), Some(max)) = (entry.min, entry.max)
        && min > max
    {
        let message = format!("`min` is {min}, which is above `max`, {max}");
        context.report(at("out-of-range", message, "min"));
        return None;
    }
    let value = match literal::literal(&entry.value, ty) {
        Ok(value) => value,
        Err(mistake) => {
            let place = Diagnostic::error("", "").at(format!("{pointer}/value"));
            context.report(mistake.into_diagnostic(place));
            return None;
        }
    };
    let (min, max) = (
        entry.min.map(|bound| bound as f32),
        entry.max.map(|bound| bound as f32),
    );
    if let Some(number) = range::outside(&value.numbers(), min, max) {
        let bounds = range::shown_bounds(min, max);
        let message = format!("the default {number} is outside its own bounds, {bounds}");
        context.report(at("out-of-range", message, "value"));
    }
    Some(value)
}

/// What the inputs of a sub-graph hold where a node uses it.
fn sub_graph_inputs(
    context: &mut Context<'_>,
    graph: &Graph,
    template: &Template<'_>,
    frame: &Frame,
    index: usize,
    inner: &Template<'_>,
) -> Vec<Option<Bound>> {
    let path = format!("{}{}", frame.prefix, template.nodes[index].name);
    let place = Place {
        template,
        node: index,
        path: &path,
    };
    let mut bounds = Vec::with_capacity(inner.inputs.len());
    for (position, (name, entry)) in inner.body.inputs.iter().enumerate() {
        let Some(ty) = inner.inputs[position] else {
            bounds.push(None);
            continue;
        };
        let wire = template.nodes[index]
            .wires
            .iter()
            .find(|(port, _)| *port as usize == position);
        let of_literal = |value: Literal| {
            Some(Bound {
                source: Source::Literal(value),
                from: ty,
                seen: ty,
            })
        };
        let (min, max) = (
            entry.min.map(|bound| bound as f32),
            entry.max.map(|bound| bound as f32),
        );
        bounds.push(match wire {
            None => {
                let pointer = format!("{}/inputs/{}", inner.pointer, escape(name));
                input_value(context, &pointer, entry, ty).and_then(of_literal)
            }
            Some((_, Wire::Literal(value))) => match literal::literal(value, ty) {
                Ok(value) => {
                    if let Some(number) = range::outside(&value.numbers(), min, max) {
                        let bounds = range::shown_bounds(min, max);
                        let message = format!("`{name}` is {number}; it may be {bounds}");
                        context.report(place.port("out-of-range", name, message));
                    }
                    of_literal(value)
                }
                Err(mistake) => {
                    let place = place.port("", name, String::new());
                    context.report(mistake.into_diagnostic(place));
                    None
                }
            },
            Some((_, wire)) => frame.bound(*wire).and_then(|bound| {
                if let Source::Parameter(parameter) = bound.source {
                    let parameter = &graph.parameters[parameter.index()];
                    let (low, high) = range::bounds(parameter);
                    if range::outside(&[low, high], min, max).is_some() {
                        let bounds = range::shown_bounds(min, max);
                        let message = format!(
                            "`{name}` may be {bounds}, but the input `{}` can be {}",
                            parameter.name,
                            range::shown_bounds(parameter.min, parameter.max),
                        );
                        context.report(place.port("out-of-range", name, message));
                    }
                }
                convert(context, graph, &place, name, ty, bound)
            }),
        });
    }
    bounds
}

/// Makes a node that gives one output of an entry.
fn node(
    context: &mut Context<'_>,
    graph: &mut Graph,
    template: &Template<'_>,
    frame: &Frame,
    index: usize,
    (definition, output): (usize, u32),
) -> Option<(NodeId, Type)> {
    let spec = context.specs[definition];
    let entry = &template.nodes[index];
    let path = format!("{}{}", frame.prefix, entry.name);
    let place = Place {
        template,
        node: index,
        path: &path,
    };

    // What is written and connected, by port. A connection to something wrong makes the node
    // wrong, but its literals are still looked at.
    let mut wires: Vec<Option<Wire<'_>>> = vec![None; spec.inputs.len()];
    for (port, wire) in &entry.wires {
        wires[*port as usize] = Some(*wire);
    }
    let mut sound = true;
    let mut bounds: Vec<Option<Bound>> = Vec::with_capacity(wires.len());
    for wire in &wires {
        let bound = wire.and_then(|wire| frame.bound(wire));
        sound &= bound.is_some() || matches!(wire, None | Some(Wire::Literal(_)));
        bounds.push(bound);
    }

    let common = common_type(context, graph, &place, spec, &wires, &bounds);
    let fits = common.is_some();
    sound &= fits;
    let common = common.unwrap_or(Type::Float);

    let mut inputs = Vec::with_capacity(spec.inputs.len());
    let mut stops = Type::Float;
    for ((port, wire), bound) in spec.inputs.iter().zip(&wires).zip(bounds) {
        let ty = match port.ty {
            PortType::Exactly(ty) => ty,
            PortType::Any => common,
            PortType::Each | PortType::Own | PortType::Color => {
                let written = match (wire, &bound) {
                    (Some(Wire::Literal(value)), _) => {
                        let color = port.ty == PortType::Color;
                        literal::natural(value, if color { Type::Color4 } else { common })
                    }
                    (None, _) => Some(literal::default_type(port)),
                    (_, Some(bound)) => Some(bound.seen),
                    _ => None,
                };
                let float = |ty: Type| ty.components() == 1;
                match (port.ty, written) {
                    (PortType::Color, Some(Type::Color4)) => Type::Color4,
                    (PortType::Color, _) => Type::Color3,
                    (PortType::Each, Some(own)) if !float(own) => common,
                    (_, Some(own)) if !float(own) => own,
                    _ => Type::Float,
                }
            }
            PortType::Choice(_) | PortType::Stops | PortType::Matrix => Type::String,
        };
        let input = match (wire, bound) {
            (None, _) => Some(match literal::default(port, ty) {
                Some(value) => Input {
                    source: Source::Literal(value),
                    from: ty,
                    ty,
                },
                None => Input {
                    source: Source::Surface,
                    from: ty,
                    ty,
                },
            }),
            // Without the common type, what a literal should be is not known.
            (Some(Wire::Literal(_)), _) if port.ty.is_common() && !sound => None,
            (Some(_), _) if port.ty.is_common() && !fits => None,
            (Some(Wire::Literal(value)), _) => match written(value, port.ty, ty) {
                Ok(value) => {
                    if let Literal::Stops(read) = &value {
                        stops = read.ty;
                    }
                    if let (Literal::Text(name), Type::Filename) = (&value, ty)
                        && !name.is_empty()
                    {
                        let place = place.port("", port.name, String::new());
                        context.files.push(FileReference::new(name.clone(), place));
                    }
                    Some(Input {
                        source: Source::Literal(value),
                        from: ty,
                        ty,
                    })
                }
                Err(mistake) => {
                    let place = place.port("", port.name, String::new());
                    context.report(mistake.into_diagnostic(place));
                    None
                }
            },
            (Some(_), Some(bound)) => {
                convert(context, graph, &place, port.name, ty, bound).map(|bound| Input {
                    source: bound.source,
                    from: bound.from,
                    ty,
                })
            }
            (Some(_), None) => None,
        };
        if let Some(input) = &input {
            sound &= check_range(context, graph, &place, port, &input.source);
        }
        sound &= input.is_some();
        inputs.extend(input);
    }
    if !sound {
        return None;
    }
    let mut name = path.clone();
    if let (Some(choice), Some((position, names))) = (output.checked_sub(1), spec.selector()) {
        let choice = names[choice as usize];
        name = format!("{name}.{choice}");
        inputs[position].source = Source::Literal(Literal::Text(choice.to_owned()));
    }
    let ty = match spec.output {
        OutputType::Exactly(ty) => ty,
        OutputType::Widest | OutputType::Whole => common,
        OutputType::Named(port) => named(spec, &inputs, port),
        OutputType::Colored => (spec.inputs.iter().zip(&inputs))
            .find(|(port, _)| port.ty == PortType::Color)
            .map_or(common, |(_, input)| input.ty),
        OutputType::Joined => joined(context, &place, spec, &inputs)?,
        OutputType::Stops => stops,
        OutputType::Picture { file, .. } if text(spec, &inputs, file).is_empty() => stops,
        OutputType::Picture { named: port, .. } => named(spec, &inputs, port),
        OutputType::Material { .. } => Type::Float,
    };
    let pointer = template.node_pointer(index);
    let id = NodeId(position_u32(graph.nodes.len()));
    let mut node = Node {
        name,
        pointer,
        definition,
        spec,
        ty,
        inputs,
    };
    if spec.material().is_some() {
        if graph.materials.iter().all(|known| known.name != path) {
            let name = path.clone();
            graph.materials.push(Node {
                name,
                ..node.clone()
            });
        }
        node = material::part(node);
    }
    let ty = node.ty;
    graph.nodes.push(node);
    Some((id, ty))
}

fn written(value: &Value, port: PortType, ty: Type) -> Result<Literal, literal::Mistake> {
    match port {
        PortType::Choice(names) => literal::choice(value, names),
        PortType::Stops => literal::stops(value),
        PortType::Matrix => literal::matrix(value),
        PortType::Exactly(_) | PortType::Any | PortType::Each | PortType::Own | PortType::Color => {
            literal::literal(value, ty)
        }
    }
}

/// The widest type of the ports that have one in common; connections come before literals, which adapt.
fn common_type(
    context: &mut Context<'_>,
    graph: &Graph,
    place: &Place<'_, '_>,
    spec: &NodeSpec,
    wires: &[Option<Wire<'_>>],
    bounds: &[Option<Bound>],
) -> Option<Type> {
    let mut common = Type::Float;
    let any = || {
        spec.inputs
            .iter()
            .enumerate()
            .filter(|(_, port)| port.ty.is_common())
    };
    for (i, port) in any() {
        let Some(bound) = &bounds[i] else { continue };
        let Some(wider) = common.widest(bound.seen) else {
            let message = format!("the inputs of `{}` do not fit together", place.path);
            let mut diagnostic = place.port("type-mismatch", port.name, message);
            for (other, port) in any().take_while(|(other, _)| *other <= i) {
                if let Some(bound) = &bounds[other] {
                    let reason = format!("of `{}`, {}", port.name, origin(graph, bound));
                    diagnostic = diagnostic.because(reason);
                }
            }
            let help = conversion(context.specs, bound.seen, common);
            context.report(diagnostic.help_if(help));
            return None;
        };
        common = wider;
    }
    let connected = common;
    for (i, port) in any() {
        let own = match &wires[i] {
            None => Some(literal::default_type(port)),
            Some(Wire::Literal(value)) => literal::natural(value, connected),
            Some(_) => None,
        };
        // What does not fit is reported when the literal is read.
        if let Some(wider) = own.and_then(|own| common.widest(own)) {
            common = wider;
        }
    }
    Some(common)
}

/// The type of the components of the ports with types of their own, one after another.
fn joined(
    context: &mut Context<'_>,
    place: &Place<'_, '_>,
    spec: &NodeSpec,
    inputs: &[Input],
) -> Option<Type> {
    let parts = (spec.inputs.iter().zip(inputs)).filter(|(port, _)| port.ty == PortType::Own);
    let types: Vec<Type> = parts.map(|(_, input)| input.ty).collect();
    let components: usize = types.iter().map(|ty| ty.components()).sum();
    let color = types
        .iter()
        .any(|ty| matches!(ty, Type::Color3 | Type::Color4));
    let ty = match (components, color) {
        (2, _) => Some(Type::Vector2),
        (3, false) => Some(Type::Vector3),
        (3, true) => Some(Type::Color3),
        (4, false) => Some(Type::Vector4),
        (4, true) => Some(Type::Color4),
        _ => None,
    };
    if ty.is_none() {
        let message = format!(
            "the inputs of `{}` have {components} components",
            place.path
        );
        let diagnostic = place.node("type-mismatch", message);
        context.report(diagnostic.help_if(Some("2, 3 or 4 make a vector or colour".to_owned())));
    }
    ty
}

/// The type that a choice names.
fn named(spec: &NodeSpec, inputs: &[Input], port: &str) -> Type {
    match Type::by_name(text(spec, inputs, port)) {
        // Whole numbers and truth values are numbers.
        Some(Type::Integer | Type::Boolean) => Type::Float,
        Some(ty) => ty,
        None => panic!("`{port}` of {} names types", spec.name),
    }
}

/// What a uniform text says.
fn text<'a>(spec: &NodeSpec, inputs: &'a [Input], port: &str) -> &'a str {
    match spec.input(port).map(|index| &inputs[index].source) {
        Some(Source::Literal(Literal::Text(text))) => text,
        _ => panic!("`{port}` of {} is a text", spec.name),
    }
}
