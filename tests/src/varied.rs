//! The example of every node with each of its inputs set to what it accepts: alone, and many at once.
//! Nobody wrote these graphs by hand, so nothing was tuned to them.

use crate::random::Random;
use mipless_graph::{Default, NodeSpec, PortSpec, PortType, Type};
use serde_json::{Value, json};

/// Graphs in which many inputs of a node are set at once.
const MIXED: usize = 6;

/// A name and the JSON text of each graph. Inputs that name files stay as they are.
///
/// # Panics
/// If an example does not hold its node.
pub fn varied() -> Vec<(String, String)> {
    let mut random = Random::new(10);
    (mipless::catalogue().iter())
        .flat_map(|def| of_node(def.spec, &mut random))
        .collect()
}

fn of_node(spec: &NodeSpec, random: &mut Random) -> Vec<(String, String)> {
    let example: Value = serde_json::from_str(spec.example).expect("the example is JSON");
    let nodes = example["nodes"].as_object().expect("a graph has nodes");
    let place = (nodes.iter())
        .find_map(|(name, node)| (node["type"] == spec.name).then(|| name.clone()))
        .expect("the example holds its node");
    let with = |settings: &[(&str, &Value)]| {
        let mut graph = example.clone();
        graph["inputs"]["any_live"] =
            json!({ "type": "float", "value": 0.6, "min": 0.1, "max": 1.5 });
        graph["nodes"]["any_noise"] = json!({ "type": "noise2d",
            "inputs": { "frequency": 3, "pivot": 0.5, "amplitude": 0.2, "seed": 9 } });
        graph["nodes"]["any_pair"] = json!({ "type": "combine2",
            "inputs": { "in1": { "node": "any_noise" }, "in2": { "input": "any_live" } } });
        for &(port, value) in settings {
            graph["nodes"][&place]["inputs"][port] = value.clone();
        }
        graph.to_string()
    };
    let ports: Vec<(&str, Vec<Value>)> = (spec.inputs.iter())
        .map(|port| (port.name, values(port)))
        .collect();
    let mut graphs = Vec::new();
    for (port, values) in &ports {
        for value in values {
            let name = format!("{}, {port}: {value}", spec.name);
            graphs.push((name, with(&[(port, value)])));
        }
    }
    for turn in 0..MIXED {
        let mut settings = Vec::new();
        for (port, values) in ports.iter().filter(|(_, values)| !values.is_empty()) {
            if random.unit() < 0.5 {
                settings.push((*port, random.choose(values)));
            }
        }
        graphs.push((format!("{}, mixture {turn}", spec.name), with(&settings)));
    }
    graphs
}

/// What a port accepts: both ends of what an editor offers and what lies between, every name, and
/// where it takes signals an input of the graph, a noise and two components that differ.
fn values(port: &PortSpec) -> Vec<Value> {
    let range = port.range;
    let at = |share: f32| f64::from(range.soft_min + share * (range.soft_max - range.soft_min));
    let flags = || vec![json!(true), json!(false)];
    let mut values = match (port.ty, port.default) {
        (PortType::Choice(names), _) => names.iter().map(|name| json!(name)).collect(),
        (PortType::Stops, _) => vec![
            json!([{ "at": 0.1, "value": 0.2 }, { "at": 0.4, "value": 0.9 }, { "at": 0.7, "value": 0.3 }]),
            json!([{ "at": 0, "value": "#102030" }, { "at": 0.5, "value": "#f0e0a0" }]),
        ],
        (PortType::Matrix, _) => vec![json!([1.2, 0.3, 0, -0.3, 0.8, 0, 0.1, 0.2, 1])],
        (PortType::Exactly(Type::String | Type::Filename), _) => Vec::new(),
        (PortType::Exactly(Type::Boolean), _) | (_, Default::Boolean(_)) => flags(),
        (PortType::Exactly(Type::Integer), _) => {
            let whole = [0.0, 0.2, 0.5, 1.0].map(|share| at(share).round() as i64);
            whole.map(|value| json!(value)).to_vec()
        }
        (_, Default::Vector2(_) | Default::Surface) => {
            vec![json!([at(0.3), at(0.8)]), json!([at(0.5), at(0.5)])]
        }
        (_, Default::Color3(_)) => vec![json!([0.2, 0.5, 0.9])],
        _ => [0.0, 0.13, 0.37, 0.8, 1.0]
            .map(|share| json!(at(share)))
            .to_vec(),
    };
    if !port.uniform {
        values.extend([
            json!({ "input": "any_live" }),
            json!({ "node": "any_noise" }),
            json!({ "node": "any_pair" }),
        ]);
    }
    values
}
