//! Bad input, as the user sees what is said of it.

use std::time::{Duration, Instant};

use crate::testing::{SPECS, text};
use crate::{Diagnostic, load};

const OUT: &str = r#""outputs": { "o": { "node": "a" } }"#;

/// The errors of a document, which has no graph.
fn errors(text: &str) -> Vec<Diagnostic> {
    let loaded = load(text, SPECS);
    let errors: Vec<Diagnostic> = loaded
        .diagnostics
        .into_iter()
        .filter(Diagnostic::is_error)
        .collect();
    assert_eq!(loaded.graph.is_none(), !errors.is_empty());
    for error in &errors {
        assert!(error.line.is_some() && error.column.is_some(), "{error}");
    }
    errors
}

/// Code and pointer of each error.
fn places(errors: &[Diagnostic]) -> Vec<(&str, &str)> {
    errors
        .iter()
        .map(|e| (e.code, e.pointer.as_deref().unwrap_or("-")))
        .collect()
}

/// The only error.
fn error(text: &str) -> Diagnostic {
    let mut errors = errors(text);
    assert_eq!(errors.len(), 1, "{errors:?}");
    errors.remove(0)
}

fn nodes(nodes: &str) -> String {
    text(&format!("\"nodes\": {{ {nodes} }}, {OUT}"))
}

#[test]
fn text_that_is_not_json_is_one_located_error() {
    for (text, line, column) in [
        ("", 1, 1),
        ("hello", 1, 1),
        ("{\n  \"version\": 1,\n  \"nodes\": {", 3, 13),
        ("{ \"version\": NaN }", 1, 14),
        ("{} {}", 1, 4),
    ] {
        let error = error(text);
        assert_eq!(error.code, "syntax", "{text}");
        assert_eq!(error.line, Some(line), "{text}: {error}");
        let near = error
            .column
            .is_some_and(|found| found.abs_diff(column) <= 1);
        assert!(near, "{text}: {error}");
    }
    let deep = format!("{}1{}", "{\"a\":".repeat(10_000), "}".repeat(10_000));
    assert_eq!(error(&deep).code, "syntax");
}

#[test]
fn a_type_one_letter_off_and_an_alias_are_suggested() {
    let wrong = error(&nodes(r#""a": { "type": "fractal2b" }"#));
    assert_eq!(
        (wrong.code, wrong.node.as_deref()),
        ("unknown-node-type", Some("a"))
    );
    assert_eq!(wrong.pointer.as_deref(), Some("/nodes/a/type"));
    assert_eq!(wrong.help.as_deref(), Some("did you mean `fractal2d`?"));
    let alias = error(&nodes(r#""a": { "type": "fbm" }"#));
    assert_eq!(
        alias.help.as_deref(),
        Some("`fbm` is called `fractal2d` here")
    );
    let far = error(&nodes(r#""a": { "type": "metallurgy" }"#));
    assert_eq!(far.help, None);
}

#[test]
fn an_output_that_a_node_does_not_have_is_named() {
    let found = errors(
        r#"{ "version": 1, "name": "x", "nodes": { "c": { "type": "cells" } },
             "outputs": { "o": { "node": "c", "output": "f2" }, "p": { "node": "c", "output": "distance" } } }"#,
    );
    let wanted = [
        ("unknown-output", "/outputs/o"),
        ("unknown-output", "/outputs/p"),
    ];
    assert_eq!(places(&found), wanted);
    assert_eq!(found[0].help.as_deref(), Some("did you mean `F2`?"));
    let all = "one of `out`, `F1`, `F2`";
    assert_eq!(found[1].help.as_deref(), Some(all));
}

#[test]
fn a_byte_order_mark_moves_no_place() {
    let text = r#"{ "version": 1, "nodes": 7, "outputs": {} }"#;
    for text in [text, &text[..30]] {
        let marked = format!("\u{feff}{text}");
        assert_eq!(errors(&marked), errors(text));
        assert_eq!(errors(&marked)[0].line, Some(1));
    }
    // One mark is none of the text; another is.
    assert_eq!(error("\u{feff}\u{feff}{}").code, "syntax");
}

#[test]
fn every_mistake_of_one_file_is_reported_once() {
    let found = errors(
        r#"{
  "version": 1, "name": 3, "colour": 1,
  "inputs": { "k": { "type": "flota", "value": 1 }, "z": { "type": "float", "value": 9, "max": 1 } },
  "nodes": {
    "a": { "type": "sin", "inputs": { "in": { "nod": "b" } } },
    "b": { "type": "fractal2d", "inputs": { "octaves": -1, "freqency": 2, "kernel": "gausian", "frequency": 1e300 } },
    "c/d": { "type": "add", "inputs": { "in1": { "node": "bb" }, "in2": { "input": "kk" } } },
    "e": { "inputs": {} },
    "f": 7,
    "a": {}
  },
  "outputs": { "o": { "node": "a", "output": "rgb" }, "p": { "node": "b" }, "q": { "node": "f" } }
}"#,
    );
    assert_eq!(
        places(&found),
        [
            ("wrong-json-type", "/name"),
            ("unknown-key", "/colour"),
            ("unknown-type", "/inputs/k/type"),
            ("out-of-range", "/inputs/z/value"),
            ("wrong-connection", "/nodes/a/inputs/in"),
            ("unknown-key", "/nodes/a/inputs/in/nod"),
            ("out-of-range", "/nodes/b/inputs/octaves"),
            ("unknown-port", "/nodes/b/inputs/freqency"),
            ("unknown-choice", "/nodes/b/inputs/kernel"),
            ("number-not-finite", "/nodes/b/inputs/frequency"),
            ("unknown-node", "/nodes/c~1d/inputs/in1"),
            ("unknown-input", "/nodes/c~1d/inputs/in2"),
            ("missing-key", "/nodes/e/type"),
            ("wrong-json-type", "/nodes/f"),
            ("duplicate-key", "/nodes/a"),
            ("unknown-output", "/outputs/o"),
        ]
    );
    let help = |code| {
        found
            .iter()
            .find(|e| e.code == code)
            .and_then(|e| e.help.as_deref())
    };
    assert_eq!(help("unknown-port"), Some("did you mean `frequency`?"));
    assert_eq!(help("unknown-choice"), Some("did you mean `gaussian`?"));
    assert_eq!(help("unknown-input"), Some("did you mean `k`?"));
    let octaves = found
        .iter()
        .find(|e| e.port.as_deref() == Some("octaves"))
        .expect("octaves");
    assert_eq!((octaves.line, octaves.column), (Some(6), Some(56)));
    assert!(octaves.message.contains("from 1 to 16"), "{octaves}");
}

#[test]
fn versions_are_checked() {
    assert_eq!(error(r#"{ "version": 2 }"#).code, "unsupported-version");
    assert_eq!(error(r#"{ "version": "1" }"#).code, "unsupported-version");
    let found = errors("{}");
    let codes: Vec<&str> = found
        .iter()
        .map(|e| e.pointer.as_deref().unwrap_or("-"))
        .collect();
    assert_eq!(codes, ["/version", "/nodes", "/outputs"]);
    assert_eq!(error("[]").code, "wrong-json-type");
}

#[test]
fn a_cycle_is_reported_whole() {
    let cycle = error(&nodes(
        r#""a": { "type": "sin", "inputs": { "in": { "node": "b" } } },
           "b": { "type": "sin", "inputs": { "in": { "node": "c" } } },
           "c": { "type": "add", "inputs": { "in2": { "node": "a" }, "in1": [1, 2, 3] } }"#,
    ));
    assert_eq!(
        (cycle.code, cycle.pointer.as_deref()),
        ("cycle", Some("/nodes/a"))
    );
    assert_eq!(
        cycle.because,
        ["`a` needs `b`", "`b` needs `c`", "`c` needs `a`"]
    );
}

#[test]
fn a_sub_graph_in_itself_is_reported_with_the_chain() {
    let wrong = error(&text(
        r#""graphs": {
             "x": { "nodes": { "i": { "type": "graph:y" } }, "outputs": { "out": { "node": "i" } } },
             "y": { "nodes": { "j": { "type": "graph:x" } }, "outputs": { "out": { "node": "j" } } }
           },
           "nodes": { "a": { "type": "graph:x" } }, "outputs": { "o": { "node": "a" } }"#,
    ));
    assert_eq!(wrong.code, "recursive-graph");
    assert_eq!(wrong.pointer.as_deref(), Some("/graphs/x/nodes/i/type"));
    assert_eq!(wrong.because, ["`x` contains `y`", "`y` contains `x`"]);
}

#[test]
fn thirty_doublings_are_refused_at_once() {
    let mut graphs = vec![
        r#""g0": { "nodes": { "a": { "type": "fractal2d" }, "b": { "type": "fractal2d" } },
                   "outputs": { "out": { "node": "a" } } }"#
            .to_owned(),
    ];
    for i in 1..30 {
        let inner = i - 1;
        graphs.push(format!(
            r#""g{i}": {{ "nodes": {{ "a": {{ "type": "graph:g{inner}" }}, "b": {{ "type": "graph:g{inner}" }} }},
                         "outputs": {{ "out": {{ "node": "a" }} }} }}"#
        ));
    }
    let graphs = graphs.join(",");
    let start = Instant::now();
    let refused = error(&text(&format!(
        "\"graphs\": {{ {graphs} }}, \"nodes\": {{ \"a\": {{ \"type\": \"graph:g29\" }} }}, {OUT}"
    )));
    assert!(start.elapsed() < Duration::from_secs(1));
    assert_eq!(refused.code, "too-many-nodes");
    assert!(refused.message.contains("1073741824"), "{refused}");
    assert!(refused.message.contains("131072"), "{refused}");
}

#[test]
fn deep_nesting_is_refused() {
    let leaf = r#""g0": { "nodes": { "a": { "type": "fractal2d" } }, "outputs": { "out": { "node": "a" } } }"#;
    let mut graphs = leaf.to_owned();
    for i in 1..2000 {
        let inner = i - 1;
        graphs.push_str(&format!(
            r#", "g{i}": {{ "nodes": {{ "a": {{ "type": "graph:g{inner}" }} }}, "outputs": {{ "out": {{ "node": "a" }} }} }}"#
        ));
    }
    let deep = text(&format!(
        "\"graphs\": {{ {graphs} }}, \"nodes\": {{ \"a\": {{ \"type\": \"graph:g1999\" }} }}, {OUT}"
    ));
    assert_eq!(error(&deep).code, "too-deep");
}

#[test]
fn types_that_do_not_fit_say_why() {
    let wrong = error(&nodes(
        r#""a": { "type": "sin", "inputs": { "in": { "node": "n" } } },
           "n": { "type": "fractal2d", "inputs": { "texcoord": { "node": "c" } } },
           "c": { "type": "checkerboard" }"#,
    ));
    assert_eq!(
        (wrong.code, wrong.pointer.as_deref(), wrong.port.as_deref()),
        (
            "type-mismatch",
            Some("/nodes/n/inputs/texcoord"),
            Some("texcoord")
        )
    );
    assert_eq!(
        wrong.because[0],
        "the node `c` (`checkerboard`) is a `color3`"
    );
    let mixed = error(&nodes(
        r#""a": { "type": "add", "inputs": { "in1": { "node": "t" }, "in2": { "node": "c" } } },
           "t": { "type": "texcoord" }, "c": { "type": "checkerboard" }"#,
    ));
    assert_eq!(mixed.code, "type-mismatch");
    assert_eq!(mixed.because.len(), 2);
    let wide = error(&nodes(
        r#""a": { "type": "colorramp", "inputs": { "in": { "node": "c" } } }, "c": { "type": "checkerboard" }"#,
    ));
    assert_eq!(wide.help.as_deref(), Some("convert it with `extract`"));
    let uniform = errors(&text(
        r#""inputs": { "k": { "type": "integer", "value": 3 } },
           "nodes": { "a": { "type": "fractal2d", "inputs": { "octaves": { "input": "k" } } } },
           "outputs": { "o": { "node": "a" } }"#,
    ));
    assert_eq!(
        places(&uniform),
        [("not-uniform", "/nodes/a/inputs/octaves")]
    );
}

#[test]
fn an_input_is_checked_over_its_whole_range() {
    let divide = |bounds: &str| {
        errors(&text(&format!(
            r#""inputs": {{ "k": {{ "type": "float", "value": 2{bounds} }} }},
               "nodes": {{ "a": {{ "type": "divide", "inputs": {{ "in2": {{ "input": "k" }} }} }} }}, {OUT}"#
        )))
    };
    for bounds in ["", r#", "min": -1, "max": 4"#, r#", "max": 4"#] {
        assert_eq!(
            places(&divide(bounds)),
            [("out-of-range", "/nodes/a/inputs/in2")],
            "{bounds}"
        );
    }
    assert_eq!(places(&divide(r#", "min": 0.5"#)), []);
    let literal = error(&nodes(
        r#""a": { "type": "divide", "inputs": { "in2": [1, 0, 1] } }"#,
    ));
    assert_eq!(literal.code, "out-of-range");
}

#[test]
fn a_mistake_in_a_sub_graph_is_reported_once_however_often_it_is_used() {
    let wrong = error(&text(
        r#""graphs": { "g": {
             "inputs": { "x": { "type": "color3", "value": 1 } },
             "nodes": { "r": { "type": "colorramp", "inputs": { "in": { "input": "x" } } } },
             "outputs": { "out": { "node": "r" } } } },
           "nodes": { "g1": { "type": "graph:g" }, "g2": { "type": "graph:g" },
             "a": { "type": "add", "inputs": { "in1": { "node": "g1" }, "in2": { "node": "g2" } } } },
           "outputs": { "o": { "node": "a" } }"#,
    ));
    assert_eq!(
        wrong.pointer.as_deref(),
        Some("/graphs/g/nodes/r/inputs/in")
    );
    assert!(
        wrong
            .node
            .as_deref()
            .is_some_and(|path| path.ends_with("/r")),
        "{wrong}"
    );
}

#[test]
fn a_hundred_thousand_mistakes_do_not_take_hours() {
    let many: Vec<String> = (0..100_000)
        .map(|i| format!("\"a{i}\": {{ \"type\": \"sine\" }}"))
        .collect();
    let start = Instant::now();
    let found = errors(&text(&format!(
        "\"nodes\": {{ {} }}, \"outputs\": {{ \"o\": {{ \"node\": \"b\" }} }}",
        many.join(",")
    )));
    assert_eq!(found.len(), 100_001);
    assert!(
        start.elapsed() < Duration::from_secs(20),
        "{:?}",
        start.elapsed()
    );
}

#[test]
fn files_are_named_with_their_places_and_must_be_read() {
    let text = text(
        r#""nodes": { "a": { "type": "picture", "inputs": { "file": "b.png" } } },
        "outputs": { "o": { "node": "a" } }"#,
    );
    let loaded = load(&text, SPECS);
    let [file] = &loaded.files[..] else {
        panic!("one file: {:?}", loaded.files)
    };
    assert_eq!(file.name, "b.png");
    let error = file.error("missing-file", "it is not there");
    assert_eq!(error.pointer.as_deref(), Some("/nodes/a/inputs/file"));
    assert!(error.line.is_some() && error.node.as_deref() == Some("a"));
    let graph = loaded.graph.expect("no mistakes but the file");
    assert_eq!(
        graph.outputs[0].ty,
        crate::Type::Color3,
        "the signature's type"
    );
    let errors = crate::check(graph, &crate::CheckOptions::default()).expect_err("nobody read it");
    assert_eq!(places(&errors), [("unread-file", "/nodes/a/inputs/file")]);
}
