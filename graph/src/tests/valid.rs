//! Documents that are right, and what becomes of them.

use std::time::Instant;

use serde_json::json;

use super::{chain, graph};
use crate::testing::{SPECS, text};
use crate::{CheckOptions, Document, Graph, Literal, Source, Type, check, load, schema};

const MARBLE: &str = r##"{
  "$schema": "graph.schema.json", "version": 1, "name": "marble", "doc": "Stone.",
  "inputs": { "scale": { "type": "float", "value": 6.0, "min": 0.5, "max": 64, "doc": "Veins." } },
  "nodes": {
    "color": { "type": "colorramp", "doc": "Cream to black.", "inputs": {
        "in": { "node": "veins", "output": "out" },
        "stops": [ { "at": 1.0, "value": [0.9, 0.87, 0.82] }, { "at": -1.0, "value": "#1d1a18" } ] } },
    "swirl": { "type": "fractal2d", "inputs": { "frequency": { "input": "scale" }, "octaves": 5 }, "extra": 1 },
    "veins": { "type": "sin", "inputs": { "in": { "node": "swirl" } } }
  },
  "outputs": { "base_color": { "node": "color" } },
  "extra": { "editor": { "swirl": [120, 40] } }
}"##;

#[test]
fn a_graph_stands_in_topological_order_with_defaults_and_types() {
    let graph = graph(MARBLE);
    let names: Vec<&str> = graph.nodes.iter().map(|node| node.name.as_str()).collect();
    assert_eq!(names, ["swirl", "veins", "color"]);
    assert_eq!(graph.outputs[0].ty, Type::Color3);
    let swirl = &graph.nodes[0];
    assert_eq!(swirl.input("texcoord").source, Source::Surface);
    assert_eq!(swirl.literal("octaves"), &Literal::Integer(5));
    assert_eq!(
        swirl.literal("kernel"),
        &Literal::Text("gaussian".to_owned())
    );
    assert_eq!(swirl.pointer, "/nodes/swirl");
    assert_eq!(graph.parameters[0].max, Some(64.0));
    let Literal::Stops(stops) = graph.nodes[2].literal("stops") else {
        panic!("stops")
    };
    assert_eq!(stops.stops[0].at, -1.0);
}

#[test]
fn a_document_without_a_name_keeps_none() {
    let text = MARBLE.replace("\"name\": \"marble\", ", "");
    assert_ne!(text, MARBLE);
    assert_eq!(graph(&text).name, Graph::NAMELESS);
    let (document, mistakes) = Document::parse(&text);
    assert_eq!(mistakes, []);
    let document = document.expect("a document");
    assert_eq!(document.name, None);
    assert_eq!(document.to_json().get("name"), None);
    let (again, mistakes) = Document::parse(&document.to_text());
    assert_eq!(mistakes, []);
    assert_eq!(again, Some(document));
}

#[test]
fn a_byte_order_mark_is_passed_over() {
    let marked = format!("\u{feff}{MARBLE}");
    assert_eq!(Document::parse(&marked), Document::parse(MARBLE));
    assert_eq!(graph(&marked).name, "marble");
}

#[test]
fn a_document_survives_a_round_trip() {
    let (document, mistakes) = Document::parse(MARBLE);
    assert_eq!(mistakes, []);
    let document = document.expect("a document");
    let json = document.to_json();
    assert_eq!(json["extra"], json!({ "editor": { "swirl": [120, 40] } }));
    assert_eq!(json["nodes"]["swirl"]["extra"], 1);
    assert_eq!(json["inputs"]["scale"]["max"], json!(64));
    let (again, mistakes) = Document::parse(&document.to_text());
    assert_eq!(mistakes, []);
    assert_eq!(again, Some(document));
}

#[test]
fn literals_take_the_type_of_what_they_stand_beside() {
    let ty = |inputs: &str| {
        let nodes = format!(
            r#""nodes": {{ "t": {{ "type": "texcoord" }}, "c": {{ "type": "checkerboard" }},
                 "a": {{ "type": "add", "inputs": {{ {inputs} }} }} }}, "outputs": {{ "o": {{ "node": "a" }} }}"#
        );
        let graph = graph(&text(&nodes));
        let output = &graph.outputs[0];
        let node = graph.node(output.node);
        assert!(node.inputs.iter().all(|input| input.ty == output.ty));
        output.ty
    };
    assert_eq!(ty(r#""in1": 1"#), Type::Float);
    assert_eq!(ty(r#""in1": { "node": "t" }, "in2": 1"#), Type::Vector2);
    assert_eq!(
        ty(r#""in1": { "node": "c" }, "in2": [1, 2, 3]"#),
        Type::Color3
    );
    assert_eq!(
        ty(r##""in1": { "node": "c" }, "in2": "#11223344""##),
        Type::Color4
    );
    assert_eq!(ty(r#""in1": [1, 2, 3, 4], "in2": 1"#), Type::Color4);
}

#[test]
fn sub_graphs_expand_with_their_inputs() {
    let graph = graph(&text(
        r#""graphs": {
             "wave": { "inputs": { "x": { "type": "float", "value": 0.25 }, "by": { "type": "float", "value": 2 } },
               "nodes": { "s": { "type": "sin", "inputs": { "in": { "node": "m" } } },
                          "m": { "type": "multiply", "inputs": { "in1": { "input": "x" }, "in2": { "input": "by" } } } },
               "outputs": { "out": { "node": "s" }, "raw": { "node": "m" } } },
             "twice": { "inputs": { "x": { "type": "float", "value": 0 } },
               "nodes": { "one": { "type": "graph:wave", "inputs": { "x": { "input": "x" }, "by": 3 } },
                          "two": { "type": "graph:wave", "inputs": { "x": { "node": "one", "output": "raw" } } } },
               "outputs": { "out": { "node": "two" } } } },
           "nodes": { "n": { "type": "fractal2d" }, "w": { "type": "graph:twice", "inputs": { "x": { "node": "n" } } } },
           "outputs": { "o": { "node": "w" } }"#,
    ));
    let names: Vec<&str> = graph.nodes.iter().map(|node| node.name.as_str()).collect();
    assert_eq!(names, ["n", "w/one/m", "w/one/s", "w/two/m", "w/two/s"]);
    let source = |node: usize, port: &str| graph.nodes[node].input(port).source.clone();
    assert_eq!(source(1, "in1"), Source::Node(crate::NodeId(0)));
    assert_eq!(source(1, "in2"), Source::Literal(Literal::float(3.0)));
    assert_eq!(source(3, "in1"), Source::Node(crate::NodeId(1)));
    assert_eq!(source(3, "in2"), Source::Literal(Literal::float(2.0)));
    assert_eq!(graph.nodes[4].pointer, "/graphs/wave/nodes/s");
    assert_eq!(graph.outputs[0].node, crate::NodeId(4));
}

#[test]
fn outputs_that_are_read_are_nodes() {
    let graph = graph(&text(
        r#""nodes": { "c": { "type": "cells", "inputs": { "output": "F2" } },
                "d": { "type": "add", "inputs": { "in1": { "node": "c", "output": "F2" },
                                                  "in2": { "node": "c", "output": "F1" } } } },
           "outputs": { "o": { "node": "d" }, "p": { "node": "c" }, "q": { "node": "c", "output": "F1" } }"#,
    ));
    let nodes: Vec<(&str, &str)> = (graph.nodes.iter())
        .map(|node| {
            let chosen = node.spec.input("output").map(|_| node.literal("output"));
            let chosen = match chosen {
                Some(Literal::Text(text)) => text,
                _ => "",
            };
            (node.name.as_str(), chosen)
        })
        .collect();
    assert_eq!(
        nodes,
        [("c.F2", "F2"), ("c.F1", "F1"), ("c", "F2"), ("d", "")]
    );
    assert_eq!(graph.outputs[1].node, crate::NodeId(2));
    assert_eq!(graph.outputs[2].node, crate::NodeId(1));
}

#[test]
fn what_is_unused_is_a_warning() {
    let loaded = load(
        &text(
            r#""inputs": { "k": { "type": "float", "value": 1 } },
               "graphs": { "g": { "nodes": { "x": { "type": "sin" } }, "outputs": { "out": { "node": "x" } } } },
               "nodes": { "a": { "type": "fractal2d" }, "b": { "type": "sin" } },
               "outputs": { "o": { "node": "a" } }"#,
        ),
        SPECS,
    );
    assert!(loaded.graph.is_some());
    let codes: Vec<&str> = loaded
        .diagnostics
        .iter()
        .map(|warning| warning.code)
        .collect();
    assert_eq!(codes, ["unused-input", "unused-graph", "unused-node"]);
}

#[test]
fn a_chain_of_a_hundred_thousand_nodes_is_ordinary() {
    let text = chain(100_000);
    let start = Instant::now();
    let graph = graph(&text);
    let loaded = start.elapsed();
    assert_eq!(graph.nodes.len(), 100_000);
    let start = Instant::now();
    let checked = check(graph, &CheckOptions::default()).expect("nothing is unknown");
    let checking = start.elapsed();
    eprintln!("100,000 nodes: load {loaded:?}, check {checking:?}");
    assert!(loaded.as_secs() < 20 && checking.as_secs() < 20);
    drop(checked);
}

#[test]
fn the_schema_knows_every_node_and_port() {
    let schema = schema(SPECS);
    let ports = &schema["$defs"]["node.fractal2d"]["properties"]["inputs"]["properties"];
    assert_eq!(
        ports["octaves"]["anyOf"],
        json!([{ "type": "integer", "minimum": 1, "maximum": 16 }])
    );
    assert_eq!(
        ports["kernel"]["anyOf"],
        json!([
            { "enum": ["gaussian", "quadrupole"] },
            { "type": "integer", "minimum": 0, "maximum": 1 },
        ])
    );
    assert_eq!(ports["texcoord"].get("default"), None);
    assert_eq!(
        schema["$defs"]["node"]["allOf"].as_array().map(Vec::len),
        Some(SPECS.len())
    );
}
