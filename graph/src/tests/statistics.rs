//! The classes of signals.

use super::graph;
use crate::testing::text;
use crate::{CheckOptions, Checked, Class, NodeId, check};

const SOURCES: &str = r#"
    "t": { "type": "texcoord" },
    "n1": { "type": "fractal2d" }, "n2": { "type": "fractal2d" }, "n3": { "type": "fractal2d" },
    "sum": { "type": "add", "inputs": { "in1": { "node": "n1" }, "in2": { "node": "n2" } } },
    "s1": { "type": "sin", "inputs": { "in": { "node": "n1" } } },
    "s2": { "type": "sin", "inputs": { "in": { "node": "n2" } } },
    "c": { "type": "checkerboard" }"#;

fn checked(nodes: &str) -> Checked {
    let text = text(&format!(
        "\"nodes\": {{ {SOURCES}, {nodes} }}, \"outputs\": {{ \"o\": {{ \"node\": \"x\" }} }}"
    ));
    check(graph(&text), &CheckOptions::default()).expect("nothing is unknown")
}

fn find(checked: &Checked, name: &str) -> NodeId {
    let index = checked
        .graph()
        .nodes
        .iter()
        .position(|node| node.name == name);
    NodeId(index.expect("the node") as u32)
}

/// The class of `x`, whose inputs are those nodes.
fn class(ty: &str, inputs: &[(&str, &str)]) -> Class {
    let inputs: Vec<String> = inputs
        .iter()
        .map(|(port, node)| format!("\"{port}\": {{ \"node\": \"{node}\" }}"))
        .collect();
    let nodes = format!(
        "\"x\": {{ \"type\": \"{ty}\", \"inputs\": {{ {} }} }}",
        inputs.join(",")
    );
    let checked = checked(&nodes);
    checked.signal(find(&checked, "x")).class
}

#[test]
fn classes_follow_the_table() {
    let pair = |ty, a, b| class(ty, &[("in1", a), ("in2", b)]);
    assert_eq!(class("sin", &[]), Class::Constant);
    assert_eq!(class("texcoord", &[]), Class::Gaussian { deviation: 0.0 });
    assert_eq!(
        class("fractal2d", &[("texcoord", "t")]),
        Class::Gaussian { deviation: 0.0046 }
    );
    assert_eq!(
        pair("add", "n1", "n2"),
        Class::Gaussian { deviation: 0.0046 }
    );
    assert_eq!(
        class("sin", &[("in", "sum")]),
        Class::Function { gaussians: 1 }
    );
    assert_eq!(
        class("sin", &[("in", "s1")]),
        Class::Function { gaussians: 1 }
    );
    assert_eq!(pair("add", "s1", "n1"), Class::Function { gaussians: 1 });
    assert!(matches!(pair("add", "s1", "s2"), Class::Moments { .. }));
    assert_eq!(
        pair("multiply", "s1", "s2"),
        Class::Function { gaussians: 2 }
    );
    assert_eq!(
        pair("multiply", "n1", "n1"),
        Class::Function { gaussians: 1 }
    );
    assert_eq!(class("checkerboard", &[]), Class::Function { gaussians: 0 });
    assert!(matches!(pair("multiply", "c", "n1"), Class::Moments { .. }));
    assert!(matches!(
        class("fractal2d", &[("texcoord", "n1")]),
        Class::Moments { .. }
    ));
    assert!(matches!(
        class("checkerboard", &[("texcoord", "s1")]),
        Class::Moments { .. }
    ));
}

#[test]
fn sources_correlations_reasons_and_errors_are_stated() {
    let checked = checked(
        r#""p": { "type": "multiply", "inputs": { "in1": { "node": "s1" }, "in2": { "node": "sum" } } },
           "q": { "type": "multiply", "inputs": { "in1": { "node": "p" }, "in2": { "node": "n3" } } },
           "x": { "type": "sin", "inputs": { "in": { "node": "q" } } }"#,
    );
    let p = checked.signal(find(&checked, "p"));
    assert_eq!(p.class, Class::Function { gaussians: 2 });
    assert_eq!(p.correlations.len(), 1);
    assert_eq!(p.correlations[0].source, Some(find(&checked, "n1")));
    let x = find(&checked, "x");
    assert!(matches!(checked.signal(x).class, Class::Moments { .. }));
    assert_eq!(checked.signal(x).sources.nodes().len(), 3);
    assert!(checked.signal(x).error > p.error && checked.signal(x).error <= 0.16);
    let because = checked.because(x);
    assert!(
        because[0].contains("`q`") && because[1].contains("more than two"),
        "{because:?}"
    );
    let json = checked.signals_json();
    let signal = &json[x.index()];
    assert_eq!(signal["class"], "moments-only");
    assert_eq!(signal["sources"].as_array().map(Vec::len), Some(3));
    assert!(
        checked
            .report()
            .to_string()
            .contains("carries cov(in1, in2): both depend on n1")
    );
}

#[test]
fn what_has_no_statistics_is_an_error_unless_it_may_be_sampled() {
    let nodes = r#""d": { "type": "divide", "inputs": { "in1": { "node": "n1" }, "in2": { "node": "n2" } } },
                   "x": { "type": "sin", "inputs": { "in": { "node": "d" } } }"#;
    let text = text(&format!(
        "\"nodes\": {{ {SOURCES}, {nodes} }}, \"outputs\": {{ \"o\": {{ \"node\": \"x\" }} }}"
    ));
    let errors = check(graph(&text), &CheckOptions::default()).expect_err("unknown");
    assert_eq!(errors.len(), 1);
    assert_eq!(
        (errors[0].code, errors[0].node.as_deref()),
        ("unknown-statistics", Some("d"))
    );
    assert_eq!(errors[0].because, ["it divides by a signal"]);
    let checked = check(
        graph(&text),
        &CheckOptions {
            allow_sampling: true,
        },
    )
    .expect("sampled");
    assert_eq!(checked.signal(find(&checked, "x")).class, Class::Unknown);
    assert_eq!(checked.warnings().len(), 1);
}

#[test]
fn one_number_as_a_position_is_a_warning() {
    let checked =
        checked(r#""x": { "type": "fractal2d", "inputs": { "texcoord": { "node": "n1" } } }"#);
    assert_eq!(checked.warnings()[0].code, "diagonal-position");
}
