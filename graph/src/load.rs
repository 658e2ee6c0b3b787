//! From text to a resolved graph in one step, with every mistake located in the text.

use std::borrow::Cow;
use std::collections::BTreeSet;

use crate::document::{Tree, locate, unmarked};
use crate::resolve::resolve_with_files;
use crate::{Diagnostic, Document, FileReference, Graph, NodeSpec};

/// What became of a text.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The document, if the text is one; it may be incomplete where there are errors.
    pub document: Option<Document>,
    /// The graph, if there are no errors.
    pub graph: Option<Graph>,
    /// Every error and warning, each with its line and column, in the order of the text.
    pub diagnostics: Vec<Diagnostic>,
    /// The files that the nodes name, whether or not there are errors. Reading them is the caller's
    /// business, who puts the pictures into [`Graph::images`] and reports at these places.
    pub files: Vec<FileReference>,
}

/// Reads, upgrades and resolves a document. A byte order mark before the text is passed over.
pub fn load(text: &str, specs: &[&'static NodeSpec]) -> Loaded {
    load_with(text, specs, |document| Cow::Borrowed(document))
}

/// The same; `complete` adds to the document what it does not say itself, such as the sub-graphs of a
/// library. The document of the result is that of the text.
pub fn load_with(
    text: &str,
    specs: &[&'static NodeSpec],
    complete: impl for<'d> FnOnce(&'d Document) -> Cow<'d, Document>,
) -> Loaded {
    let text = unmarked(text);
    let mut tree = match Tree::parse(text) {
        Ok(tree) => tree,
        Err(diagnostic) => {
            return Loaded {
                document: None,
                graph: None,
                diagnostics: vec![*diagnostic],
                files: Vec::new(),
            };
        }
    };
    let (document, mut diagnostics) = Document::from_tree(text, &mut tree);
    let mut graph = None;
    let mut files = Vec::new();
    if let Some(document) = &document {
        // Without the nodes, every reference would be reported.
        let sections = ["/nodes", "/inputs", "/graphs"];
        let lost = diagnostics.iter().any(|diagnostic| {
            diagnostic
                .pointer
                .as_deref()
                .is_some_and(|pointer| sections.contains(&pointer))
        });
        if !lost {
            let failed = !diagnostics.is_empty();
            let resolved = resolve_with_files(&complete(document), specs);
            let mut found = without_consequences(&diagnostics, resolved.diagnostics);
            locate(text, &tree, &mut found);
            diagnostics.extend(found);
            let (names, mut places): (Vec<String>, Vec<Diagnostic>) = (resolved.files.into_iter())
                .map(|file| (file.name, file.place))
                .unzip();
            locate(text, &tree, &mut places);
            files = (names.into_iter().zip(places))
                .map(|(name, place)| FileReference::new(name, place))
                .collect();
            graph = resolved.graph.filter(|_| !failed);
        }
    }
    diagnostics.sort_by_key(|diagnostic| (diagnostic.line, diagnostic.column));
    Loaded {
        document,
        graph,
        diagnostics,
        files,
    }
}

/// What resolving found, less what only follows from a mistake of structure: anything in a value of
/// the wrong JSON type, and anything that has a mistake of structure inside.
fn without_consequences(structure: &[Diagnostic], found: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let pointers: BTreeSet<&str> = structure
        .iter()
        .filter_map(|diagnostic| diagnostic.pointer.as_deref())
        .collect();
    let wrong: BTreeSet<&str> = structure
        .iter()
        .filter(|diagnostic| diagnostic.code == "wrong-json-type")
        .filter_map(|diagnostic| diagnostic.pointer.as_deref())
        .collect();
    if pointers.is_empty() {
        return found;
    }
    let follows = |diagnostic: &Diagnostic| {
        let Some(pointer) = diagnostic.pointer.as_deref() else {
            return false;
        };
        let inside = format!("{pointer}/");
        let inner = pointers.range(inside.as_str()..).next();
        let ends = pointer.match_indices('/').map(|(end, _)| &pointer[..end]);
        pointers.contains(pointer)
            || inner.is_some_and(|inner| inner.starts_with(&inside))
            || ends.into_iter().any(|outer| wrong.contains(outer))
    };
    found
        .into_iter()
        .filter(|diagnostic| !follows(diagnostic))
        .collect()
}
