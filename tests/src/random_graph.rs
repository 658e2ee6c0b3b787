//! Random graphs as people write them: of any nodes of the catalogue, as often as they are used, with
//! inputs, several outputs and sub-graphs, whose types fit and whose numbers their ports accept.
//!
//! A graph depends on its seed alone: what comes into the catalogue later is drawn by later seeds
//! ([`weight`]). What the check still refuses (a divisor
//! that may be 0, say) is repaired.

mod literal;
mod repair;
mod weight;

use crate::METHODS;
use crate::random::Random;
use literal::{literal, rounded, stops};
use mipless::{Method, NodeSpec, Texture, Type};
use mipless_graph::{Default, OutputType, PortSpec, PortType};
pub use repair::repaired;
use serde_json::{Map, Value, json};
use weight::Generation;

/// Nodes of a graph of [`of_seed`].
const SIZES: [f64; 2] = [3.0, 60.0];

/// Where pictures of position come from: the first nodes of a graph, unless chance has others.
const SOURCES: [&str; 10] = [
    "noise2d",
    "fractal2d",
    "valuenoise2d",
    "worleynoise2d",
    "stripes",
    "checkerboard",
    "shape",
    "brick",
    "wave",
    "texcoord",
];

/// Names that mean something where shaders are written, or that none of their languages takes.
const NAMES: [&str; 10] = [
    "footprint",
    "parameters",
    "main",
    "texture",
    "vec2f",
    "out",
    "float",
    "2nd knob",
    "größe",
    "a/b~c",
];

/// What a node may read: the output of another one, or an input of the graph.
struct Made {
    reference: Value,
    ty: Type,
    /// How often it is read.
    reads: usize,
}

/// A sub-graph: its name, the types of its inputs, and the names and types of its outputs.
struct Sub {
    name: String,
    inputs: Vec<(String, Type)>,
    outputs: Vec<(String, Type)>,
}

/// The graph of a seed, without mistakes: of 3 to 60 nodes, small ones as often as large ones.
///
/// # Panics
/// If no graph of the seed can be repaired.
pub fn of_seed(seed: u64) -> (Value, Texture) {
    let mut random = Random::new(seed);
    let [least, most] = SIZES;
    let nodes = least * (most / least).powf(random.unit());
    let valid = |_| repaired(graph(&mut random, nodes as usize, Generation::of(seed)));
    let found = (0..20).find_map(valid);
    found.unwrap_or_else(|| panic!("no graph of the seed {seed} is accepted"))
}

/// How many graphs are asked for by `MIPLESS_GRAPHS`, if any number is.
pub fn asked() -> Option<u64> {
    std::env::var("MIPLESS_GRAPHS").ok()?.parse().ok()
}

/// By which methods the graph of a seed is looked at: `auto`, which holds `local` and `quad`, and the
/// others in turns; all of them where a number of graphs is asked for.
pub fn methods(seed: u64) -> Vec<Method> {
    if asked().is_some() {
        return METHODS.to_vec();
    }
    vec![Method::Auto, METHODS[seed as usize % METHODS.len()]]
}

/// The JSON text of a random graph of so many nodes beside its sub-graphs. The check may refuse it.
///
/// # Panics
/// If there are no nodes.
pub fn text(random: &mut Random, nodes: usize) -> String {
    serde_json::to_string_pretty(&graph(random, nodes, Generation::NEWEST)).expect("JSON")
}

fn graph(random: &mut Random, nodes: usize, generation: Generation) -> Value {
    assert!(nodes > 0, "a graph has nodes");
    let odd = random.happens(0.1);
    let mut name = |usual: &str| {
        if odd {
            (*random.choose(&NAMES)).to_owned()
        } else {
            usual.to_owned()
        }
    };
    let (title, knob, first) = (name("random"), name("knob"), name("last"));
    let inputs = live(random, knob);
    let mut subs = Vec::new();
    let mut graphs = Map::new();
    while nodes > 5 && subs.len() < 2 && random.happens(0.2) {
        let sub_name = format!("part{}", subs.len());
        let (sub, body) = sub_graph(random, sub_name.clone(), generation);
        subs.push(sub);
        graphs.insert(sub_name, body);
    }
    let mut body = Body::new(inputs.iter().map(|(name, input)| {
        let ty = input["type"].as_str().and_then(Type::by_name);
        (name.clone(), ty.expect("the type of an input"))
    }));
    body.fill(random, nodes, &subs, generation);
    let outputs = body.outputs(random, first);
    let mut graph = json!({
        "version": 1,
        "name": title,
        "inputs": inputs,
        "nodes": body.nodes,
        "outputs": outputs.into_iter().map(|(name, from)| (name, from.0)).collect::<Map<_, _>>(),
    });
    if !graphs.is_empty() {
        graph["graphs"] = graphs.into();
    }
    graph
}

/// Inputs of the graph: none to three.
fn live(random: &mut Random, knob: String) -> Map<String, Value> {
    let value = rounded(random.within(0.5, 2.0));
    let float = json!({ "type": "float", "value": value, "min": 0.5, "max": 2 });
    let offset = [random.unit(), random.unit()].map(rounded);
    let vector = json!({ "type": "vector2", "value": offset, "min": -1, "max": 2 });
    let color = json!({ "type": "color3", "value": "#c08a52" });
    let count = json!({ "type": "integer", "value": 3, "min": 1, "max": 8 });
    let all = [
        (0.7, knob, float),
        (0.15, "offset".to_owned(), vector),
        (0.15, "tint".to_owned(), color),
        (0.1, "count".to_owned(), count),
    ];
    (all.into_iter())
        .filter(|(chance, ..)| random.happens(*chance))
        .map(|(_, name, input)| (name, input))
        .collect()
}

/// A small sub-graph with inputs of some types.
fn sub_graph(random: &mut Random, name: String, generation: Generation) -> (Sub, Value) {
    let types = [Type::Float, Type::Vector2, Type::Color3];
    let inputs: Vec<(String, Type)> = ["x", "y", "z"][..1 + random.below(3)]
        .iter()
        .map(|name| ((*name).to_owned(), *random.choose(&types)))
        .collect();
    let mut body = Body::new(inputs.iter().cloned());
    let nodes = 2 + random.below(6);
    body.fill(random, nodes, &[], generation);
    let outputs = body.outputs(random, "out".to_owned());
    let entries: Map<String, Value> = (inputs.iter())
        .map(|(name, ty)| {
            let entry = json!({ "type": ty.name(), "value": 0.5 });
            (name.clone(), entry)
        })
        .collect();
    let references: Map<String, Value> = (outputs.iter())
        .map(|(name, (from, _))| (name.clone(), from.clone()))
        .collect();
    let json = json!({ "inputs": entries, "nodes": body.nodes, "outputs": references });
    let outputs = outputs.into_iter().map(|(name, (_, ty))| (name, ty));
    let sub = Sub {
        name,
        inputs,
        outputs: outputs.collect(),
    };
    (sub, json)
}

/// A graph or a sub-graph while it is made.
struct Body {
    nodes: Map<String, Value>,
    made: Vec<Made>,
    /// How many of the first are inputs.
    inputs: usize,
}

impl Body {
    fn new(inputs: impl Iterator<Item = (String, Type)>) -> Self {
        let made: Vec<Made> = inputs
            .map(|(name, ty)| Made {
                reference: json!({ "input": name }),
                ty,
                reads: 0,
            })
            .collect();
        Self {
            nodes: Map::new(),
            inputs: made.len(),
            made,
        }
    }

    /// Adds nodes: sources first, later ones reading what was made before.
    fn fill(&mut self, random: &mut Random, nodes: usize, subs: &[Sub], generation: Generation) {
        let sources = 1 + nodes / 6;
        for index in 0..nodes {
            if !subs.is_empty() && random.happens(0.08) {
                let sub = random.choose(subs);
                self.use_sub(random, index, sub);
                continue;
            }
            let drawn = weight::node(random, generation);
            let spec = if index < sources && random.happens(0.8) {
                let source = *random.choose(&SOURCES);
                spec(source)
            } else {
                drawn
            };
            let (inputs, ty) = self.inputs(random, spec);
            let name = format!("{}_{index}", spec.name);
            let mut reference = json!({ "node": name });
            if let Some((_, outputs)) = spec.selector()
                && random.happens(0.4)
            {
                reference["output"] = json!(random.choose(outputs));
            }
            self.nodes
                .insert(name, json!({ "type": spec.name, "inputs": inputs }));
            self.made.push(Made {
                reference,
                ty,
                reads: 0,
            });
        }
    }

    /// Adds a node that is a sub-graph.
    fn use_sub(&mut self, random: &mut Random, index: usize, sub: &Sub) {
        let mut inputs = Map::new();
        for (name, ty) in &sub.inputs {
            if let Some(from) = self.pick(random, |made| made.converts_to(*ty)) {
                inputs.insert(name.clone(), from.0);
            }
        }
        let name = format!("{}_{index}", sub.name);
        for (output, ty) in &sub.outputs {
            self.made.push(Made {
                reference: json!({ "node": name, "output": output }),
                ty: *ty,
                reads: 0,
            });
        }
        let ty = format!("graph:{}", sub.name);
        self.nodes
            .insert(name, json!({ "type": ty, "inputs": inputs }));
    }

    /// Something that fits and was made: most often one of the last, and one that nothing reads yet.
    fn pick(&mut self, random: &mut Random, fits: impl Fn(Type) -> bool) -> Option<(Value, Type)> {
        let fitting: Vec<usize> = (0..self.made.len())
            .filter(|&i| fits(self.made[i].ty))
            .collect();
        let is_node = |&&i: &&usize| i >= self.inputs;
        let unread: Vec<usize> = (fitting.iter().filter(is_node))
            .filter(|&&i| self.made[i].reads == 0)
            .copied()
            .collect();
        let nodes: Vec<usize> = fitting.iter().filter(is_node).copied().collect();
        let from = match random.below(10) {
            0..5 if !unread.is_empty() => &unread[unread.len().saturating_sub(4)..],
            5..8 if !nodes.is_empty() => &nodes[nodes.len().saturating_sub(6)..],
            _ => &fitting[..],
        };
        if from.is_empty() {
            return None;
        }
        let made = &mut self.made[*random.choose(from)];
        made.reads += 1;
        Some((made.reference.clone(), made.ty))
    }

    /// Random inputs of a node, and the type of its output.
    fn inputs(&mut self, random: &mut Random, spec: &NodeSpec) -> (Map<String, Value>, Type) {
        let mut inputs = Map::new();
        let mut widest = Type::Float;
        let mut stops_are = Type::Float;
        for port in spec.inputs {
            // Material Maker's hash is another number for another rounding, which is no law's; a
            // period along v wants one along u.
            if spec.name == "valuenoise2d" && matches!(port.name, "hash" | "period_v") {
                continue;
            }
            let choice = random.unit();
            let scalar = port.default == Default::Choice("float");
            let named = spec.output == OutputType::Named(port.name);
            let typed = port.ty == PortType::Any || (named && !scalar);
            let kept = match (port.default, port.unit) {
                (Default::Surface, _) => 0.6,
                // Noises of one number are most of those that people have.
                _ if named && scalar => 0.85,
                _ if port.uniform => 0.4,
                _ => 0.25,
            };
            if choice < kept && !typed {
                continue;
            }
            let connected = !port.uniform && random.happens(self.connection(spec, port));
            let value = match port.ty {
                PortType::Stops => {
                    let colors = random.happens(0.6);
                    stops_are = if colors { Type::Color3 } else { Type::Float };
                    stops(random, colors)
                }
                PortType::Matrix => json!([0.8, 0.6, 0, -0.6, 0.8, 0, 0.1, 0.2, 1]),
                PortType::Choice(names) => json!(random.choose(names)),
                PortType::Exactly(_) | PortType::Each | PortType::Own | PortType::Color => {
                    let ty = match port.ty {
                        PortType::Exactly(ty) => ty,
                        PortType::Color => Type::Color3,
                        _ => Type::Float,
                    };
                    let from = connected
                        .then(|| self.pick(random, |made| made.converts_to(ty)))
                        .flatten();
                    from.map_or_else(|| literal(random, port, ty), |(reference, _)| reference)
                }
                PortType::Any => {
                    let number = |ty: Type| ty.components() > 0 && ty != Type::Boolean;
                    let fits = |made: Type| number(made) && made.widest(widest).is_some();
                    let from = connected.then(|| self.pick(random, fits)).flatten();
                    if let Some((reference, ty)) = from {
                        widest = ty.widest(widest).expect("the types meet");
                        reference
                    } else {
                        let ty = if spec.name == "constant" {
                            *random.choose(&[Type::Float, Type::Float, Type::Color3, Type::Vector2])
                        } else {
                            widest
                        };
                        let value = literal(random, port, ty);
                        if !value.is_number() {
                            widest = ty;
                        }
                        value
                    }
                }
            };
            inputs.insert(port.name.to_owned(), value);
        }
        let ty = output(spec, &inputs, widest, stops_are);
        (inputs, ty)
    }

    /// How probable it is that an input is connected.
    fn connection(&self, spec: &NodeSpec, port: &PortSpec) -> f64 {
        let first = spec.inputs.first().is_some_and(|p| p.name == port.name);
        match (port.default, port.ty) {
            (Default::Surface, _) => 0.9,
            (_, PortType::Any) if first => 0.97,
            (_, PortType::Any) => 0.6,
            // The mask of a mixture, the input of a ramp.
            _ if first || port.name == "mix" || port.name == "in" => 0.9,
            _ => 0.15,
        }
    }

    /// The outputs: the last node, and one or two others, with their types.
    fn outputs(&self, random: &mut Random, first: String) -> Vec<(String, (Value, Type))> {
        let mut outputs = vec![(first, self.made.len() - 1)];
        let others = random.below(3).min(self.made.len() - self.inputs - 1);
        for name in &["other", "mask"][..others] {
            let unread = |made: &Made| made.reads == 0;
            let last_unread = self.made[..self.made.len() - 1].iter().rposition(unread);
            let any = self.inputs + random.below(self.made.len() - self.inputs);
            let chosen = last_unread.filter(|&i| i >= self.inputs && random.happens(0.5));
            outputs.push(((*name).to_owned(), chosen.unwrap_or(any)));
        }
        let of = |(name, index): (String, usize)| {
            let made = &self.made[index];
            (name, (made.reference.clone(), made.ty))
        };
        outputs.into_iter().map(of).collect()
    }
}

fn spec(name: &str) -> &'static NodeSpec {
    let nodes = mipless::catalogue().iter();
    let found = nodes.map(|def| def.spec).find(|spec| spec.name == name);
    found.unwrap_or_else(|| panic!("{name} is in the catalogue"))
}

/// The type of a node's output with these inputs.
fn output(spec: &NodeSpec, inputs: &Map<String, Value>, widest: Type, stops: Type) -> Type {
    let named = |port: &str| {
        let default = spec.inputs.iter().find(|input| input.name == port);
        let default = default.map(|input| match input.default {
            Default::Choice(name) => name,
            other => panic!("{other:?} of {} names no type", spec.name),
        });
        let written = inputs.get(port).and_then(Value::as_str);
        let name = written.or(default).expect("a choice");
        Type::by_name(name).expect("a type")
    };
    match spec.output {
        OutputType::Exactly(ty) => ty,
        OutputType::Widest | OutputType::Whole => widest,
        OutputType::Named(port) => named(port),
        // Its parts are numbers here.
        OutputType::Joined => Type::Vector2,
        OutputType::Colored => Type::Color3,
        OutputType::Picture { file, named: port } if inputs.contains_key(file) => named(port),
        OutputType::Picture { .. } | OutputType::Stops => stops,
        OutputType::Material { .. } => unreachable!("a material ends a graph"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_seed_gives_a_graph_that_the_check_accepts_and_the_same_each_time() {
        for seed in 0..100 {
            let (graph, texture) = of_seed(seed);
            assert!(!texture.outputs().is_empty());
            assert_eq!(graph, of_seed(seed).0);
        }
    }

    #[test]
    fn random_graphs_have_inputs_sub_graphs_several_outputs_and_every_size() {
        let graphs: Vec<_> = (0..200).map(|seed| of_seed(seed).0).collect();
        let count = |holds: &dyn Fn(&Value) -> bool| graphs.iter().filter(|g| holds(g)).count();
        let entries = |graph: &Value, key: &str| graph[key].as_object().map_or(0, Map::len);
        assert!(count(&|g| entries(g, "graphs") > 0) > 20);
        assert!(count(&|g| entries(g, "inputs") > 0) > 100);
        assert!(count(&|g| entries(g, "outputs") > 1) > 100);
        assert!(count(&|g| entries(g, "nodes") < 10) > 40);
        assert!(count(&|g| entries(g, "nodes") > 30) > 20);
        // Of those that are written, most are read: the repairs do not take the graphs apart.
        let connected = |graph: &Value| graph.to_string().matches("\"node\":").count();
        assert!(count(&|g| connected(g) > entries(g, "nodes") / 2) > 150);
    }
}
