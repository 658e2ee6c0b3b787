//! Components, outputs and turns.

use mipless_codegen::Method;
use mipless_codegen::cpu::Footprint;
use serde_json::{Value, json};

use super::{evaluated, near, places};

#[test]
fn outputs_are_components() {
    let values = |nodes: Value, output: Value| {
        let graph =
            json!({ "version": 1, "name": "parts", "nodes": nodes, "outputs": { "out": output } });
        evaluated(&graph.to_string(), Method::Local, &places(0.01)[..4])
    };
    let source = json!({
        "bands": { "type": "stripes" },
        "noise": { "type": "noise2d", "inputs": { "frequency": 5 } },
        "x": { "type": "combine3", "inputs": { "in1": { "node": "bands" }, "in2": { "node": "noise" }, "in3": 0.25 } },
        "parts": { "type": "separate3", "inputs": { "in": { "node": "x" } } },
        "four": { "type": "separate4", "inputs": { "in": { "node": "x" } } },
        "knot": { "type": "dot", "inputs": { "in": { "node": "noise" }, "note": "here" } }
    });
    let of = |node: &str, output: &str| {
        values(source.clone(), json!({ "node": node, "output": output }))
    };
    assert_eq!(of("parts", "outr"), of("bands", "out"));
    assert_eq!(of("parts", "outg"), of("noise", "out"));
    assert_eq!(of("parts", "outy"), of("knot", "out"));
    assert_eq!(of("parts", "outb")[0], [0.25; 4]);
    assert_eq!(of("four", "outa")[0], [1.0; 4]);
    let named = json!({ "cells": { "type": "worleynoise2d", "inputs": { "frequency": 4, "output": "F2" } } });
    let (first, second) = (
        json!({ "node": "cells", "output": "F1" }),
        json!({ "node": "cells" }),
    );
    assert_ne!(
        values(named.clone(), first),
        values(named.clone(), second.clone())
    );
    assert_eq!(
        values(named.clone(), json!({ "node": "cells", "output": "F2" })),
        values(named, second)
    );
}

#[test]
fn turns_in_space_are_clockwise() {
    let of = |inputs: Value| {
        let graph = json!({ "version": 1, "name": "turn", "nodes": { "x": { "type": "rotate3d", "inputs": inputs } },
            "outputs": { "out": { "node": "x" } } });
        let values = evaluated(&graph.to_string(), Method::Local, &[Footprint::default()]);
        [values[0][0], values[1][0], values[2][0]]
    };
    let turned = of(json!({ "in": [1, 0, 0], "amount": -90, "axis": [0, 0, 3] }));
    assert_eq!(turned, [0.0, 1.0, 0.0]);
    let diagonal = of(json!({ "in": [1, 2, 3], "amount": -120, "axis": [1, 1, 1] }));
    for (value, wanted) in diagonal.into_iter().zip([3.0, 1.0, 2.0]) {
        near("a third of a turn around the diagonal", value, wanted, 1e-5);
    }
    let still = of(json!({ "in": [1, 2, 3], "amount": 40, "axis": [0, 0, 0] }));
    assert_eq!(still, [1.0, 2.0, 3.0]);
}

#[test]
fn the_unified_noise_is_its_noises() {
    let of = |node: Value, more: Value| {
        let mut nodes = json!({ "x": node });
        for (name, node) in more.as_object().into_iter().flatten() {
            nodes[name] = node.clone();
        }
        let last = if nodes.get("y").is_some() { "y" } else { "x" };
        let graph = json!({ "version": 1, "name": "same", "nodes": nodes, "outputs": { "out": { "node": last } } });
        evaluated(&graph.to_string(), Method::Local, &places(0.05)[..6])
    };
    let pairs = [
        (
            json!({ "type": "perlin" }),
            json!({ "type": "noise2d", "inputs": { "frequency": 3, "amplitude": 0.5, "pivot": 0.5, "seed": 7 } }),
        ),
        (
            json!({ "type": "fractal", "octaves": 4 }),
            json!({ "type": "fractal2d", "inputs": { "frequency": 3, "octaves": 4, "seed": 7 } }),
        ),
        (
            json!({ "type": "cell" }),
            json!({ "type": "cellnoise2d", "inputs": { "frequency": 3, "seed": 7 } }),
        ),
        (
            json!({ "type": "worley", "jitter": 0.6 }),
            json!({ "type": "worleynoise2d", "inputs": { "frequency": 3, "seed": 7, "jitter": 0.6 } }),
        ),
    ];
    for (mut inputs, other) in pairs {
        for clamped in [false, true] {
            inputs["freq"] = json!([3, 3]);
            inputs["seed"] = json!(7);
            inputs["clampoutput"] = json!(clamped);
            let unified = of(
                json!({ "type": "unifiednoise2d", "inputs": inputs }),
                json!({}),
            );
            let limits = json!({ "y": { "type": "clamp", "inputs": { "in": { "node": "x" } } } });
            let alone = of(other.clone(), if clamped { limits } else { json!({}) });
            for (a, b) in unified.iter().flatten().zip(alone.iter().flatten()) {
                near(&format!("{inputs}"), *a, *b, 1e-6);
            }
        }
    }
}
