//! Whole documents through the whole crate.

mod bad;
mod property;
mod statistics;
mod valid;

use crate::testing::SPECS;
use crate::{Diagnostic, Graph, load};

/// The graph of a valid document.
fn graph(text: &str) -> Graph {
    let loaded = load(text, SPECS);
    let shown: Vec<String> = loaded
        .diagnostics
        .iter()
        .map(Diagnostic::to_string)
        .collect();
    loaded
        .graph
        .unwrap_or_else(|| panic!("{}", shown.join("\n")))
}

/// A chain of that many nodes.
fn chain(count: usize) -> String {
    let mut nodes = String::from("\"n0\": { \"type\": \"fractal2d\" }");
    for i in 1..count {
        let previous = i - 1;
        nodes.push_str(&format!(
            ",\n    \"n{i}\": {{ \"type\": \"add\", \"inputs\": {{ \"in1\": {{ \"node\": \"n{previous}\" }}, \"in2\": 0.125 }} }}"
        ));
    }
    let last = count - 1;
    crate::testing::text(&format!(
        "\"nodes\": {{ {nodes} }}, \"outputs\": {{ \"height\": {{ \"node\": \"n{last}\" }} }}"
    ))
}
