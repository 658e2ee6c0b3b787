//! What a document means while it is edited: its mistakes, and the part of it that they do not reach.

use super::digest::{Digest, of_nodes, of_program};
use super::picture::Pictures;
use super::sound::keep_sound;
use super::{preview, types};
use crate::Catalogue;
use crate::files::Files;
use mipless_codegen::{Method, Options};
use mipless_graph::{
    CheckOptions, Checked, Diagnostic, Document, Draft, Parameter, Reference, Type, check, draft,
};
use rustc_hash::FxHashSet;
use std::sync::Arc;

/// An output that no mistake reaches.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sound {
    pub(super) name: String,
    pub(super) ty: Type,
    /// Of all that it is a function of.
    pub(super) digest: Digest,
}

/// What a document means.
pub(super) struct Analysis {
    pub(super) diagnostics: Vec<Diagnostic>,
    /// The graph of the outputs that no mistake reaches, with what its program depends on; `None` where
    /// there are none.
    pub(super) sound: Option<(Arc<Checked>, Digest)>,
    pub(super) outputs: Vec<Sound>,
    pub(super) parameters: Vec<Parameter>,
    /// How many nodes there are, sub-graphs expanded.
    pub(super) size: usize,
}

/// What of a session an analysis depends on beside the document.
pub(super) struct Context<'s> {
    pub(super) catalogue: &'s Catalogue,
    pub(super) name: &'s str,
    pub(super) options: &'s Options,
    pub(super) files: &'s dyn Files,
}

impl Context<'_> {
    /// The draft of a document, with its pictures, and with what is wrong with them.
    fn draft(&self, document: &Document, pictures: &mut Pictures) -> Draft {
        let whole = self.catalogue.complete(document);
        let mut draft = draft(&whole, self.catalogue.specs());
        let (images, found) = pictures.read(&draft.files, self.files);
        draft.diagnostics.extend(found);
        if let Some(graph) = &mut draft.graph {
            graph.images = images;
            if document.name.is_none() {
                self.name.clone_into(&mut graph.name);
            }
        }
        draft
    }

    fn check_options(&self) -> CheckOptions {
        CheckOptions {
            allow_sampling: matches!(self.options.method, Method::Supersample(_)),
        }
    }

    pub(super) fn analyse(&self, document: &Document, pictures: &mut Pictures) -> Analysis {
        let mut draft = self.draft(document, pictures);
        let parameters = draft.graph.as_ref().map(|graph| graph.parameters.clone());
        let parameters = parameters.unwrap_or_default();
        let size = draft.graph.as_ref().map_or(0, |graph| graph.nodes.len());
        let mut checked = None;
        while let Some(mut graph) = draft.graph.take() {
            keep_sound(&mut graph, &draft.diagnostics);
            if graph.outputs.is_empty() {
                break;
            }
            let mistakes = draft.diagnostics.iter().filter(|d| d.is_error()).count();
            match check(graph, &self.check_options()) {
                Ok(sound) => {
                    draft.diagnostics.extend(sound.warnings().iter().cloned());
                    checked = Some(sound);
                    break;
                }
                Err(found) => draft.diagnostics.extend(found),
            }
            // The check takes the graph with it: what is left of it is looked at once more.
            let more = draft.diagnostics.iter().filter(|d| d.is_error()).count();
            assert!(more > mistakes, "a check that fails says why");
            let again = self.draft(document, pictures);
            draft.graph = again.graph;
        }
        if let Some(sound) = &checked
            && draft.diagnostics.iter().all(|d| !d.is_error())
        {
            let jumps = crate::texture::jumps(sound, self.catalogue.definitions());
            draft.diagnostics.extend(jumps);
        }
        // What is found in two rounds is said once.
        let mut said = FxHashSet::default();
        let key = |d: &Diagnostic| (d.code, d.pointer.clone(), d.message.clone());
        draft.diagnostics.retain(|d| said.insert(key(d)));
        let mut outputs = Vec::new();
        let sound = checked.map(|checked| {
            let graph = checked.graph();
            let digests = of_nodes(graph, &|name| pictures.digest(name));
            outputs.extend(graph.outputs.iter().map(|output| Sound {
                name: output.name.clone(),
                ty: output.ty,
                digest: digests[output.node.index()],
            }));
            let program = of_program(graph, &digests, self.options);
            (Arc::new(checked), program)
        });
        Analysis {
            diagnostics: draft.diagnostics,
            sound,
            outputs,
            parameters,
            size,
        }
    }

    /// The graph of one node's output alone, whatever the outputs of the document are.
    pub(super) fn preview(
        &self,
        document: &Document,
        pictures: &mut Pictures,
        path: &str,
        port: &str,
    ) -> Result<(Checked, Digest), Vec<Diagnostic>> {
        let (alone, inner) =
            preview::alone(document, path, port).map_err(|refused| vec![*refused])?;
        let mut draft = self.draft(&alone, pictures);
        let Some(mut graph) = draft.graph.take() else {
            return Err(draft.diagnostics);
        };
        if inner && !preview::choose(&mut graph, path, port) {
            let message = format!("there is no node `{path}` that could be shown");
            let first = Diagnostic::error("unknown-node", message);
            draft.diagnostics.insert(0, first);
            return Err(draft.diagnostics);
        }
        keep_sound(&mut graph, &draft.diagnostics);
        if graph.outputs.is_empty() {
            return Err(draft.diagnostics);
        }
        let checked = check(graph, &self.check_options())?;
        let digests = of_nodes(checked.graph(), &|name| pictures.digest(name));
        let program = of_program(checked.graph(), &digests, self.options);
        Ok((checked, program))
    }

    /// The type of an output of a node of the graph, or of a sub-graph wherever that is used first.
    pub(super) fn types(
        &self,
        document: &Document,
        pictures: &mut Pictures,
        scope: &Option<String>,
    ) -> impl Fn(&Reference) -> Option<Type> + use<> {
        let graph = self.draft(document, pictures).graph;
        let whole = self.catalogue.complete(document).into_owned();
        let scope = scope.clone();
        move |reference| types::of(graph.as_ref()?, &whole, &scope, reference)
    }
}
