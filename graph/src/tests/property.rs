//! No JSON makes the crate panic, and every error says where.

use proptest::prelude::*;
use serde_json::{Value, json};

use crate::testing::SPECS;
use crate::{CheckOptions, Document, check, load};

/// Keys and texts that mean something somewhere, so that random documents get far.
fn word() -> impl Strategy<Value = String> {
    prop_oneof![
        prop::sample::select(vec![
            "version",
            "name",
            "nodes",
            "inputs",
            "outputs",
            "graphs",
            "extra",
            "type",
            "value",
            "node",
            "input",
            "output",
            "min",
            "max",
            "doc",
            "at",
            "stops",
            "in",
            "in1",
            "in2",
            "a",
            "b",
            "g",
            "add",
            "sin",
            "fractal2d",
            "colorramp",
            "divide",
            "graph:g",
            "out",
            "float",
            "color3",
            "#ff8800",
            "gaussian",
            "octaves",
        ])
        .prop_map(str::to_owned),
        "[a-c/~é]{0,3}",
    ]
}

fn value() -> impl Strategy<Value = Value> {
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        any::<f64>().prop_map(Value::from),
        (-3..4).prop_map(Value::from),
        word().prop_map(Value::from),
    ];
    leaf.prop_recursive(5, 48, 6, |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..5).prop_map(Value::from),
            prop::collection::vec((word(), inner), 0..6)
                .prop_map(|members| Value::Object(members.into_iter().collect())),
        ]
    })
}

/// A node that is nearly right.
fn node() -> impl Strategy<Value = Value> {
    let binding = prop_oneof![
        prop::sample::select(vec!["a", "b", "c", "d"]).prop_map(|name| json!({ "node": name })),
        Just(json!({ "input": "k" })),
        Just(json!([1, 2, 3])),
        Just(json!(0.5)),
        value(),
    ];
    let ports = prop::sample::select(vec!["in", "in1", "in2", "texcoord", "octaves", "stops"]);
    let inputs = prop::collection::vec((ports.prop_map(str::to_owned), binding), 0..3);
    let types = prop::sample::select(vec![
        "add",
        "sin",
        "fractal2d",
        "colorramp",
        "divide",
        "multiply",
        "graph:g",
        "graph:h",
        "texcoord",
    ]);
    (types, inputs).prop_map(|(ty, inputs)| {
        let inputs: serde_json::Map<String, Value> = inputs.into_iter().collect();
        json!({ "type": ty, "inputs": inputs })
    })
}

fn body() -> impl Strategy<Value = Value> {
    (node(), node(), node()).prop_map(|(a, b, c)| {
        json!({
            "inputs": { "k": { "type": "float", "value": 1, "min": 0.5, "max": 2 } },
            "nodes": { "a": a, "b": b, "c": c },
            "outputs": { "out": { "node": "a" } },
        })
    })
}

fn hold(text: &str) {
    let loaded = load(text, SPECS);
    for diagnostic in &loaded.diagnostics {
        assert!(diagnostic.line.is_some(), "{diagnostic}");
        assert!(
            diagnostic.pointer.is_some() || diagnostic.code == "syntax",
            "{diagnostic}"
        );
    }
    let failed = loaded.diagnostics.iter().any(crate::Diagnostic::is_error);
    assert_eq!(loaded.graph.is_none(), failed);
    if let Some(document) = loaded.document.filter(|_| !failed) {
        let (again, mistakes) = Document::parse(&document.to_text());
        assert_eq!(mistakes, []);
        assert_eq!(again, Some(document));
    }
    if let Some(graph) = loaded.graph {
        for (index, node) in graph.nodes.iter().enumerate() {
            for input in &node.inputs {
                if let crate::Source::Node(source) = input.source {
                    assert!(source.index() < index);
                    assert_eq!(graph.node(source).ty, input.from);
                }
            }
        }
        let checked = check(
            graph,
            &CheckOptions {
                allow_sampling: true,
            },
        )
        .expect("sampled");
        assert_eq!(checked.signals().len(), checked.graph().nodes.len());
        assert!(!checked.report().to_string().contains("NaN"));
    }
}

proptest! {
    #[test]
    fn any_json_gives_located_diagnostics(value in value()) {
        hold(&value.to_string());
    }

    #[test]
    fn any_text_gives_located_diagnostics(text in ".{0,40}") {
        hold(&text);
    }

    #[test]
    fn nearly_right_documents_too(
        mut document in body(), g in body(), h in body(), cut in 0_usize..4000,
        named: bool,
    ) {
        document["version"] = json!(1);
        if named {
            document["name"] = json!("t");
        }
        document["graphs"] = json!({ "g": g, "h": h });
        let text = document.to_string();
        hold(&text);
        // Truncated.
        let mut cut = cut.min(text.len());
        while !text.is_char_boundary(cut) {
            cut -= 1;
        }
        hold(&text[..cut]);
    }
}
