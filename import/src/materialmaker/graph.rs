//! The graphs of a document: nodes by name, connections, and which graph stands in which.

use super::PortOf;
use crate::json::{Content, Json};
use crate::place::Place;
use rustc_hash::FxHashMap;

/// How deep graphs may stand in each other, and how many there may be.
const DEEPEST: usize = 32;
const MOST: usize = 10_000;

/// A graph.
#[derive(Debug)]
struct Graph<'a> {
    nodes: FxHashMap<&'a str, &'a Json>,
    /// From a node and the number of its input to a node and the number of its output.
    connections: FxHashMap<(&'a str, usize), (&'a str, usize)>,
    /// The graph that it stands in, and the node that it is there.
    outer: Option<(usize, &'a str)>,
    /// The graphs that stand in it, by their nodes.
    inner: FxHashMap<&'a str, usize>,
    /// Parameters that a remote control sets, by node and name.
    set: FxHashMap<(&'a str, &'a str), &'a Json>,
    path: String,
}

/// All graphs; the first is the document.
#[derive(Debug)]
pub(super) struct Graphs<'a>(Vec<Graph<'a>>);

impl<'a> Graphs<'a> {
    pub(super) fn read(json: &'a Json) -> Self {
        let mut graphs: Vec<Graph<'a>> = Vec::new();
        // What is to be read: the graph, where it stands, and the parameters that it is given.
        let mut open = vec![(json, None, String::new(), 0, json.get("parameters"))];
        while let Some((json, outer, path, depth, given)) = open.pop() {
            if graphs.len() >= MOST {
                break;
            }
            let id = graphs.len();
            let mut graph = Graph {
                nodes: FxHashMap::default(),
                connections: FxHashMap::default(),
                outer,
                inner: FxHashMap::default(),
                set: FxHashMap::default(),
                path: path.clone(),
            };
            for node in json.get("nodes").map_or(&[][..], Json::items) {
                if let Some(name) = node.get("name").and_then(Json::text) {
                    graph.nodes.insert(name, node);
                }
            }
            for connection in json.get("connections").map_or(&[][..], Json::items) {
                let text = |key| connection.get(key).and_then(Json::text);
                let port = |key| connection.get(key).and_then(Json::index);
                if let (Some(from), Some(to)) = (text("from"), text("to"))
                    && let (Some(from_port), Some(to_port)) = (port("from_port"), port("to_port"))
                {
                    graph.connections.insert((to, to_port), (from, from_port));
                }
            }
            graph.remotes(given);
            if let Some((outer, node)) = outer {
                let outer: &mut Graph<'a> = &mut graphs[outer];
                outer.inner.insert(node, id);
            }
            for (name, node) in &graph.nodes {
                if node.get("type").and_then(Json::text) == Some("graph") && depth < DEEPEST {
                    let given = node.get("parameters");
                    open.push((
                        node,
                        Some((id, *name)),
                        format!("{path}/{name}"),
                        depth + 1,
                        given,
                    ));
                }
            }
            graphs.push(graph);
        }
        Self(graphs)
    }

    /// The node that says what is shown.
    pub(super) fn material(&self) -> Option<(String, Place)> {
        let graph = self.0.first()?;
        let mut names: Vec<&&str> = (graph.nodes.iter())
            .filter(|(_, node)| {
                let kind = node.get("type").and_then(Json::text).unwrap_or("");
                kind == "material" || kind.starts_with("material_")
            })
            .map(|(name, _)| name)
            .collect();
        names.sort();
        let name = (**names.first()?).to_owned();
        let place = self.place(0, &name);
        Some((name, place))
    }

    pub(super) fn node(&self, graph: usize, name: &str) -> Option<&'a Json> {
        self.0.get(graph)?.nodes.get(name).copied()
    }

    /// What a node is.
    pub(super) fn kind(&self, graph: usize, name: &str) -> Option<&'a str> {
        self.node(graph, name)?.get("type")?.text()
    }

    /// Where a node stands.
    pub(super) fn place(&self, graph: usize, name: &str) -> Place {
        let path = self.0.get(graph).map_or("", |graph| graph.path.as_str());
        Place {
            file: 0,
            offset: self.node(graph, name).map_or(0, |node| node.offset),
            path: format!("{path}/{name}"),
        }
    }

    /// What an input of a node is connected to.
    pub(super) fn source(&self, graph: usize, node: &str, port: usize) -> Option<PortOf> {
        let (node, port) = self.0.get(graph)?.connections.get(&(node, port))?;
        Some(PortOf {
            graph,
            node: (*node).to_owned(),
            port: *port,
        })
    }

    /// What an output of a node that is a graph shows.
    pub(super) fn inside(&self, port: &PortOf) -> Option<Option<PortOf>> {
        let inner = *self.0.get(port.graph)?.inner.get(port.node.as_str())?;
        Some(self.source(inner, "gen_outputs", port.port))
    }

    /// What a graph's own inputs read outside; other connection points lead through.
    pub(super) fn outside(&self, port: &PortOf) -> Option<Option<PortOf>> {
        if port.node != "gen_inputs" {
            return Some(self.source(port.graph, &port.node, port.port));
        }
        let (outer, node) = self.0.get(port.graph)?.outer?;
        Some(self.source(outer, node, port.port))
    }

    /// What a switch lets through.
    pub(super) fn switched(&self, port: &PortOf) -> Option<PortOf> {
        let index = |name| {
            let value = self.parameter(port.graph, &port.node, name);
            value.and_then(Json::index)
        };
        let (source, outputs) = (index("source").unwrap_or(0), index("outputs").unwrap_or(1));
        let input = source.checked_mul(outputs)?.checked_add(port.port)?;
        self.source(port.graph, &port.node, input)
    }

    /// A parameter of a node, as a remote control sets it.
    pub(super) fn parameter(&self, graph: usize, node: &str, name: &str) -> Option<&'a Json> {
        let set = self.0.get(graph)?.set.get(&(node, name)).copied();
        set.or_else(|| self.node(graph, node)?.get("parameters")?.get(name))
    }

    /// A parameter that an expression names with `$`: of the graph that the node stands in.
    pub(super) fn named(&self, graph: usize, name: &str) -> Option<&'a Json> {
        let outer = self.0.get(graph)?.outer;
        let given = outer.and_then(|(outer, node)| self.parameter(outer, node, name));
        given.or_else(|| self.parameter(graph, "gen_parameters", name))
    }

    /// The seed that Material Maker gives a node: what the document says, or a number made of where the
    /// node lies, and on top of it those of the graphs around it; nothing where it is no whole number.
    pub(super) fn tool_seed(&self, graph: usize, node: &str) -> Option<i64> {
        let json = self.node(graph, node)?;
        let number = |key: &str| json.get(key).and_then(Json::number);
        let whole = |x: f64| (x.fract() == 0.0 && x.abs() < 1e9).then_some(x as i64);
        let flag = |key: &str| match json.get(key).map(|json| &json.value) {
            Some(Content::Bool(flag)) => Some(*flag),
            _ => None,
        };
        let mut locked = flag("seed_locked").unwrap_or(false);
        let own = if let Some(seed) = number("seed_int") {
            // A part of 2³², which is a whole number where it is none of it.
            (seed == 0.0).then_some(0)?
        } else if let Some(seed) = number("seed") {
            whole(seed)?
        } else if let Some(seed) = number("seed_value") {
            locked = true;
            whole(seed)?
        } else {
            let place = json.get("node_position");
            let axis = |key: &str| {
                let place = place
                    .and_then(|place| place.get(key))
                    .and_then(Json::number);
                place.unwrap_or(0.0).clamp(-1e9, 1e9) as i64
            };
            ((axis("x") * 0x1f1f_1f1f) ^ axis("y")) % 65_536
        };
        let around = (self.0.get(graph)?.outer)
            .filter(|(outer, node)| {
                let node = self.node(*outer, node);
                let transmits = node.and_then(|node| node.get("transmits_seed"));
                !transmits.is_some_and(|json| json.value == Content::Bool(false))
            })
            .filter(|_| !locked);
        Some(match around {
            Some((outer, node)) => own + self.tool_seed(outer, node)?,
            None => own,
        })
    }

    /// The number from which a node's noises are counted.
    pub(super) fn seed(&self, graph: usize, node: &str) -> i32 {
        // Material Maker makes seeds of where nodes lie; names are as good and stay.
        let path = self.place(graph, node).path;
        let hash = path.bytes().fold(0x811c_9dc5_u32, |hash, byte| {
            (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193)
        });
        (hash % 1_000_000) as i32
    }
}

impl<'a> Graph<'a> {
    /// What the remote controls of the graph set.
    fn remotes(&mut self, given: Option<&'a Json>) {
        let remotes = (self.nodes.iter())
            .filter(|(_, node)| node.get("type").and_then(Json::text) == Some("remote"));
        let mut set = FxHashMap::default();
        for (name, remote) in remotes {
            for widget in remote.get("widgets").map_or(&[][..], Json::items) {
                let text = |key| widget.get(key).and_then(Json::text);
                let (Some("linked_control"), Some(parameter)) = (text("type"), text("name")) else {
                    continue;
                };
                let own = remote.get("parameters").and_then(|own| own.get(parameter));
                let outer = given.filter(|_| *name == "gen_parameters");
                let value = outer.and_then(|given| given.get(parameter)).or(own);
                for linked in widget.get("linked_widgets").map_or(&[][..], Json::items) {
                    let text = |key| linked.get(key).and_then(Json::text);
                    if let (Some(node), Some(widget), Some(value)) =
                        (text("node"), text("widget"), value)
                    {
                        set.insert((node, widget), value);
                    }
                }
            }
        }
        self.set = set;
    }
}
