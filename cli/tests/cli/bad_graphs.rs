//! Every kind of bad graph: located, in no time, and nothing written.

use crate::folder::{Folder, GRAPH};
use std::time::Duration;

/// Every bad graph, with the code of its first diagnostic where that matters.
fn bad_graphs() -> Vec<(&'static str, Vec<u8>, &'static str)> {
    let node = |node: &str| {
        format!(
            r#"{{ "version": 1, "name": "bad", "nodes": {{ "n": {node} }},
                "outputs": {{ "out": {{ "node": "n" }} }} }}"#
        )
        .into_bytes()
    };
    let doubling = |level: u32| {
        format!(
            r#""g{level}": {{ "nodes": {{
                "a": {{ "type": "graph:g{0}" }}, "b": {{ "type": "graph:g{0}" }},
                "c": {{ "type": "add", "inputs": {{
                    "in1": {{ "node": "a" }}, "in2": {{ "node": "b" }} }} }} }},
                "outputs": {{ "out": {{ "node": "c" }} }} }},"#,
            level - 1
        )
    };
    let doublings = format!(
        r#"{{ "version": 1, "name": "bad", "graphs": {{ {}
            "g0": {{ "nodes": {{ "n": {{ "type": "noise2d" }} }},
                "outputs": {{ "out": {{ "node": "n" }} }} }} }},
            "nodes": {{ "n": {{ "type": "graph:g30" }} }},
            "outputs": {{ "out": {{ "node": "n" }} }} }}"#,
        (1..=30).map(doubling).collect::<String>()
    );
    let own = r#"{ "version": 1, "name": "bad",
        "graphs": { "g": { "nodes": { "n": { "type": "graph:g" } },
            "outputs": { "out": { "node": "n" } } } },
        "nodes": { "n": { "type": "graph:g" } }, "outputs": { "out": { "node": "n" } } }"#;
    vec![
        ("empty", Vec::new(), ""),
        (
            "truncated",
            GRAPH.as_bytes()[..GRAPH.len() / 2].to_vec(),
            "",
        ),
        (
            "not UTF-8",
            b"{ \"version\": 1,\n \"name\": \"\xff\" }".to_vec(),
            "not-utf8",
        ),
        ("nested", "[".repeat(10_000).into_bytes(), ""),
        (
            "nested and closed",
            ("[".repeat(10_000) + &"]".repeat(10_000)).into_bytes(),
            "",
        ),
        ("an array", b"[]".to_vec(), ""),
        (
            "cycle",
            node(r#"{ "type": "sin", "inputs": { "in": { "node": "n" } } }"#),
            "",
        ),
        ("contains itself", own.as_bytes().to_vec(), ""),
        ("thirty doublings", doublings.into_bytes(), ""),
        (
            "NaN",
            node(r#"{ "type": "noise2d", "inputs": { "frequency": NaN } }"#),
            "",
        ),
        (
            "1e300",
            node(r#"{ "type": "noise2d", "inputs": { "frequency": 1e300 } }"#),
            "",
        ),
        (
            "octaves",
            node(r#"{ "type": "fractal2d", "inputs": { "octaves": -3 } }"#),
            "",
        ),
        (
            "missing node",
            node(r#"{ "type": "sin", "inputs": { "in": { "node": "m" } } }"#),
            "",
        ),
        (
            "wrong type",
            node(r#"{ "type": "noise2d", "inputs": { "frequency": [1, 2] } }"#),
            "",
        ),
        (
            "one letter off",
            node(r#"{ "type": "noize2d" }"#),
            "unknown-node-type",
        ),
        (
            "unknown port",
            node(r#"{ "type": "noise2d", "inputs": { "freqency": 2 } }"#),
            "",
        ),
    ]
}

#[test]
fn bad_graphs_are_located_in_no_time() {
    let folder = Folder::new();
    for (name, bytes, code) in bad_graphs() {
        folder.write("bad.json", bytes);
        let before = folder.files();
        for line in [
            "check bad.json",
            "render bad.json -o a.png",
            "compile bad.json --out shaders",
        ] {
            let run = folder.run(line).is(1).says("error[").says("--> bad.json");
            assert!(
                run.taken < Duration::from_secs(2),
                "{name}: {:?}",
                run.taken
            );
        }
        let run = folder.run("check bad.json --json").is(1);
        let first = &run.json()["diagnostics"][0];
        assert_eq!(first["severity"], "error", "{name}");
        let located = first["pointer"].is_string() || first["line"].is_u64();
        assert!(located, "{name}: {first}");
        if !code.is_empty() {
            assert_eq!(first["code"], code, "{name}: {first}");
        }
        assert_eq!(folder.files(), before, "{name}");
    }
    folder.write("bad.json", GRAPH.replace("noise2d", "noize2d"));
    folder
        .run("check bad.json")
        .is(1)
        .says("did you mean `noise2d`?");
}
