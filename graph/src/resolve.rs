//! Names become ids: a document becomes a [`Graph`], or every reason why it cannot.
//!
//! 1. Each body (the graph and its sub-graphs) is checked once by itself into a *template*: node
//!    types, ports, references, cycles (`template`, `order`).
//! 2. The expansion is counted before anything is expanded (`nesting`).
//! 3. The templates are expanded in topological order with a stack of our own (`expand`), which
//!    types the nodes, reads the literals (`literal`) and checks what is connected (`connect`, `range`).
//!
//! Nothing recurses over the user's graph, so a chain of 100,000 nodes is an ordinary input.

mod connect;
mod expand;
mod literal;
mod nesting;
mod order;
mod range;
mod synonym;
mod template;

use rustc_hash::{FxHashMap, FxHashSet};

use crate::diagnostic::did_you_mean;
use crate::document::Document;
use crate::{Diagnostic, FileReference, Graph, NodeSpec};

pub use literal::linear_from_srgb;
pub(crate) use literal::{color, from_numbers};
pub(crate) use range::{outside, shown_bounds};

/// How many nodes a graph may have when its sub-graphs are expanded: what is accepted is compiled, and
/// takes by `auto` about 20 KB a node.
pub const MAX_NODES: u64 = 1 << 17;

/// How deep sub-graphs may be nested.
pub const MAX_NESTING: usize = 256;

/// Gives meaning to a document: the graph, if there is no error, and all errors and warnings.
///
/// [`Node::definition`](crate::Node::definition) is the position in `specs`. A mistake in a
/// sub-graph is reported once, however often the sub-graph is used; the literals and types of a
/// sub-graph that nothing uses are not looked at.
pub fn resolve(
    document: &Document,
    specs: &[&'static NodeSpec],
) -> (Option<Graph>, Vec<Diagnostic>) {
    let resolved = resolve_with_files(document, specs);
    (resolved.graph, resolved.diagnostics)
}

/// What becomes of a document that may have mistakes.
#[derive(Clone, Debug)]
pub struct Draft {
    /// What could be made of the document: nodes that could not be made, and those that read them, are
    /// not there, and neither are outputs that read one. A node that is there may have a mistake all the
    /// same: the diagnostics say at which pointers. `None` where the whole is too large, or has sub-graphs
    /// that contain themselves.
    pub graph: Option<Graph>,
    /// Every error and warning; they have pointers, but no lines.
    pub diagnostics: Vec<Diagnostic>,
    /// The files that the nodes name, each place once.
    pub files: Vec<FileReference>,
}

/// Gives as much meaning to a document as it has, for editors: the outputs that a mistake does not
/// reach.
pub fn draft(document: &Document, specs: &[&'static NodeSpec]) -> Draft {
    let mut context = Context::new(specs);
    let mut templates = template::build(&mut context, document);
    order::sort(&mut context, &mut templates);
    let fits = nesting::check(&mut context, &mut templates);
    template::find_unused(&mut context, &templates);
    let graph = fits.then(|| expand::expand(&mut context, document, &templates));
    // A sub-graph that is used several times names its files once.
    let mut seen = FxHashSet::default();
    let mut files = context.files;
    files.retain(|file| seen.insert(file.place.pointer.clone()));
    Draft {
        graph,
        diagnostics: context.diagnostics,
        files,
    }
}

/// The same where the graph is there only if it has no errors.
pub(crate) fn resolve_with_files(document: &Document, specs: &[&'static NodeSpec]) -> Draft {
    let draft = draft(document, specs);
    let failed = draft.diagnostics.iter().any(Diagnostic::is_error);
    Draft {
        graph: draft.graph.filter(|_| !failed),
        ..draft
    }
}

/// What every part of the resolver needs.
struct Context<'s> {
    specs: &'s [&'static NodeSpec],
    by_name: FxHashMap<&'static str, usize>,
    diagnostics: Vec<Diagnostic>,
    files: Vec<FileReference>,
    /// What was reported, so that a sub-graph used a thousand times reports once.
    reported: FxHashSet<(&'static str, Option<String>)>,
    /// How many names may still be compared for suggestions: a file of 100,000 wrong names in a
    /// graph of 100,000 nodes must not take hours.
    comparisons: usize,
}

impl<'s> Context<'s> {
    fn new(specs: &'s [&'static NodeSpec]) -> Self {
        let by_name = specs
            .iter()
            .enumerate()
            .map(|(index, spec)| (spec.name, index))
            .collect();
        Self {
            specs,
            by_name,
            diagnostics: Vec::new(),
            files: Vec::new(),
            reported: FxHashSet::default(),
            comparisons: 300_000,
        }
    }

    /// Reports, unless the same was reported at the same place.
    fn report(&mut self, diagnostic: Diagnostic) {
        if self
            .reported
            .insert((diagnostic.code, diagnostic.pointer.clone()))
        {
            self.diagnostics.push(diagnostic);
        }
    }

    /// A help line that offers the nearest of some names.
    fn nearest<'a>(
        &mut self,
        name: &str,
        candidates: impl ExactSizeIterator<Item = &'a str> + Clone,
    ) -> Option<String> {
        self.comparisons = self.comparisons.checked_sub(candidates.len())?;
        did_you_mean(name, candidates)
    }

    /// A help line for an unknown node type: an alias of one, or the nearest name or alias.
    fn nearest_type(&mut self, name: &str) -> Option<String> {
        let names = self.specs.iter().map(|spec| (spec.name, spec.name));
        let aliases = self
            .specs
            .iter()
            .flat_map(|spec| spec.aliases.iter().map(|alias| (*alias, spec.name)));
        let all: Vec<(&str, &str)> = names.chain(aliases).collect();
        let exact = all
            .iter()
            .find(|(known, _)| known.eq_ignore_ascii_case(name));
        if let Some((alias, spec)) = exact {
            return Some(if alias == spec {
                format!("did you mean `{spec}`?")
            } else {
                format!("`{alias}` is called `{spec}` here")
            });
        }
        self.comparisons = self.comparisons.checked_sub(all.len())?;
        let near = crate::suggest(name, all.iter().map(|(known, _)| *known))?;
        let (alias, spec) = all.iter().find(|(known, _)| *known == near)?;
        Some(if alias == spec {
            format!("did you mean `{spec}`?")
        } else {
            format!("did you mean `{spec}`, also known as `{alias}`?")
        })
    }
}
