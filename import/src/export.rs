//! Writes a graph as a MaterialX document.
//!
//! ```text
//! Graph ──rules──► Document of nodes that MaterialX has ──definitions──► elements ──► text
//! ```
//!
//! A node whose name is MaterialX's is that node; what it has more than MaterialX (a frequency, an
//! output that is chosen) is put into nodes beside it by a rule (`export/rules.txt`). A node of
//! Mipless's own becomes a node that the document defines itself, by a functional nodegraph that a
//! rule of the same table makes. What neither has is refused, all of it at once. A `surface` becomes a
//! shader and a material.

mod bind;
mod expand;
mod network;
mod shader;
mod text;

use crate::materialx::definition::Definitions;
use crate::rule::Rules;
use expand::{Expanded, Functions};
use mipless_graph::{Diagnostic, Document, Graph, NodeSpec, resolve};
use network::Network;
use std::sync::OnceLock;

/// What nodes become, in the language of the importer's tables.
const RULES: &str = include_str!("export/rules.txt");

fn rules() -> &'static Rules {
    static PARSED: OnceLock<Rules> = OnceLock::new();
    PARSED.get_or_init(|| Rules::parse(RULES))
}

/// Whether MaterialX has a node of this name.
fn is_shared(node: &str) -> bool {
    Definitions::standard().knows(node)
}

/// What became of a graph.
#[derive(Debug)]
pub struct Exported {
    /// The document, if nothing is refused.
    pub text: Option<String>,
    /// Errors and notes, each at its node.
    pub diagnostics: Vec<Diagnostic>,
}

/// Writes a graph as a MaterialX 1.39 document; `specs` are those that it was resolved with.
pub fn export(graph: &Graph, specs: &[&'static NodeSpec]) -> Exported {
    let apart = shader::apart(graph, specs);
    let mut functions = Functions::new(specs);
    let mut expanded = expand::expand(&apart.graph, specs, &mut functions);
    expanded.diagnostics.extend(apart.diagnostics);
    let main = if apart.graph.outputs.is_empty() {
        // A material of numbers alone has no nodegraph.
        Some(Network::default())
    } else {
        expanded
            .document
            .take()
            .and_then(|document| network(graph, &document, specs, &functions, &mut expanded))
    };
    let failed = expanded.diagnostics.iter().any(Diagnostic::is_error);
    let main = main.filter(|_| !failed);
    let text = main.map(|main| text::document(&graph.name, &main, &functions, &apart.shaders));
    Exported {
        text,
        diagnostics: expanded.diagnostics,
    }
}

/// The elements of a document of nodes that MaterialX has, or that have a definition.
fn network(
    graph: &Graph,
    document: &Document,
    specs: &[&'static NodeSpec],
    functions: &Functions,
    expanded: &mut Expanded,
) -> Option<Network> {
    let (resolved, mistakes) = resolve(document, specs);
    let Some(resolved) = resolved else {
        let what = mistakes.first().map(ToString::to_string);
        let message = format!(
            "a rule of the exporter is wrong: {}",
            what.unwrap_or_default()
        );
        let diagnostic = Diagnostic::error("export-rule", message);
        expanded.diagnostics.push(diagnostic);
        return None;
    };
    let mut main = Network::of(&resolved, functions, &[]);
    // A refusal is told at the node that the user wrote, where one of its name is there.
    for (name, refusal) in std::mem::take(&mut main.refused) {
        let node = graph.nodes.iter().find(|node| node.name == name);
        let diagnostic = Diagnostic::error(refusal.code, refusal.message);
        expanded.diagnostics.push(match node {
            Some(node) => diagnostic.at(&*node.pointer).in_node(&*node.name),
            None => diagnostic.in_node(name),
        });
    }
    Some(main)
}
