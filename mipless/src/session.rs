//! Sessions: a graph while it is edited.
//!
//! A [`Session`] holds a document and what it means. An [`Edit`] is data; [`Session::apply`] does it and
//! says what has changed. A graph with mistakes keeps what they do not reach: its outputs have new programs,
//! and those that a mistake reaches keep their last good one ([`Session::output`]).
//!
//! Analysing is cheap and done with every edit; compiling is done when a program is asked for, and baking
//! when a table is read. What an edit leaves as it was is not compiled again, and a graph that was
//! compiled before, in any session, is known.
//!
//! ```
//! use mipless::session::{Edit, Session};
//! use serde_json::json;
//!
//! let mut session = Session::open(r##"{ "version": 1, "name": "clouds",
//!     "inputs": { "scale": { "type": "float", "value": 4.0, "min": 0.5, "max": 64 } },
//!     "nodes": {
//!         "noise": { "type": "fractal2d", "inputs": { "frequency": { "input": "scale" } } },
//!         "color": { "type": "colorramp", "inputs": { "in": { "node": "noise" },
//!             "stops": [ { "at": -0.5, "value": "#2a5f9e" }, { "at": 0.5, "value": "#ffffff" } ] } }
//!     },
//!     "outputs": { "height": { "node": "noise" }, "base_color": { "node": "color" } } }"##)
//! .expect("it is a document");
//! let edit = |edit| serde_json::from_value::<Edit>(edit).expect("an edit");
//!
//! // A slider is dragged: nothing is compiled, and it is one step.
//! let scale = |value| edit(json!({ "edit": "set_input", "input": "scale", "value": value }));
//! let change = session.apply(scale(5.0)).expect("there is such an input");
//! assert_eq!((&change.parameters[..], change.shaders.len()), (&["scale".to_owned()][..], 0));
//! session.apply(scale(8.0)).expect("there is such an input");
//! session.commit();
//!
//! // A mistake reaches one of the outputs; the other one goes on, and this one keeps its program.
//! let change = session
//!     .apply(edit(json!({ "edit": "set", "node": "color", "input": "stops", "value": [] })))
//!     .expect("there is such a node");
//! assert!(change.diagnostics.iter().any(|diagnostic| diagnostic.is_error()));
//! assert!(session.output("height").is_some_and(|output| output.is_current));
//! assert!(session.output("base_color").is_some_and(|output| !output.is_current));
//!
//! // Undo mends it, and undo again takes the whole drag back.
//! session.undo();
//! assert!(session.output("base_color").is_some_and(|output| output.is_current));
//! session.undo();
//! assert_eq!(session.document().body.inputs["scale"].value, json!(4.0));
//! ```

mod analysis;
mod apply;
mod compiled;
mod digest;
mod edit;
mod group;
mod history;
mod patch;
mod picture;
mod preview;
mod rewire;
mod saved;
mod sound;
mod types;

pub use compiled::Compiled;
pub use edit::Edit;
pub use saved::{RestoreError, Saved};

use crate::files::{Files, NoFiles};
use crate::{Catalogue, NodeEntry, Options};
use analysis::{Analysis, Context};
use digest::Digest;
use history::History;
use mipless_codegen::Method;
use mipless_graph::{Diagnostic, Document, Graph, Map, Parameter, Type};
use patch::Recorder;
use picture::Pictures;
use std::fmt;
use std::sync::Arc;

/// How a session is opened. The default has no files, the nodes of this crate, and filters by `local`,
/// which compiles at once; `auto` measures what it makes of a graph, which takes longer than an edit
/// should.
#[derive(Clone)]
pub struct Setup {
    /// The node types and the library.
    pub catalogue: Catalogue,
    /// What the graph is called if its document does not say.
    pub name: String,
    /// The files that the graph names.
    pub files: Arc<dyn Files + Send + Sync>,
    /// What programs are compiled for.
    pub options: Options,
}

impl Default for Setup {
    fn default() -> Self {
        Self {
            catalogue: Catalogue::shipped(),
            name: Graph::NAMELESS.to_owned(),
            files: Arc::new(NoFiles),
            options: Options {
                method: Method::Local,
                ..Options::default()
            },
        }
    }
}

impl fmt::Debug for Setup {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Setup")
            .field("catalogue", &self.catalogue)
            .field("name", &self.name)
            .field("options", &self.options)
            .finish_non_exhaustive()
    }
}

/// What an edit has changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Change {
    /// Every mistake and warning of the document as it is now; they have pointers into it, but no lines.
    pub diagnostics: Vec<Diagnostic>,
    /// Whether these are others than before.
    pub diagnostics_changed: bool,
    /// The outputs whose shader is another now, or that are new.
    pub shaders: Vec<String>,
    /// The outputs that are there no more.
    pub removed: Vec<String>,
    /// The outputs that a mistake reaches now: they keep their last good program.
    pub broken: Vec<String>,
    /// The inputs of the graph whose value is another: a uniform to update.
    pub parameters: Vec<String>,
}

/// An output of a session.
#[derive(Clone, Debug)]
pub struct LiveOutput {
    /// Its name.
    pub name: String,
    /// Its type.
    pub ty: Type,
    /// The graph of its program, which has it among its outputs.
    pub compiled: Arc<Compiled>,
    /// Whether it is what the document says; if not, a mistake reaches it, and this is the last good one.
    pub is_current: bool,
}

struct Kept {
    output: LiveOutput,
    digest: Digest,
}

/// A graph while it is edited. See the [module](self) for a tour.
pub struct Session {
    setup: Setup,
    /// The document before the first step that can be taken back.
    base: Document,
    document: Document,
    history: History,
    pictures: Pictures,
    diagnostics: Vec<Diagnostic>,
    parameters: Vec<Parameter>,
    size: usize,
    outputs: Map<Kept>,
    /// Whether values of inputs have changed since the document was analysed.
    is_dragged: bool,
}

impl fmt::Debug for Session {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Session")
            .field("setup", &self.setup)
            .field("nodes", &self.document.body.nodes.len())
            .field("steps", &self.history.done.len())
            .finish_non_exhaustive()
    }
}

impl Session {
    /// A graph without nodes, which is a mistake that edits mend.
    pub fn new(setup: Setup) -> Self {
        Self::of(Document::default(), setup)
    }

    /// The graph of a text, with nodes of this crate and without files.
    ///
    /// # Errors
    /// As [`Session::open_with`].
    pub fn open(text: &str) -> Result<Self, Vec<Diagnostic>> {
        Self::open_with(text, Setup::default())
    }

    /// The graph of a text. It may have mistakes of meaning ([`Session::diagnostics`]).
    ///
    /// # Errors
    /// If the text is no document: what cannot be read would be lost when it is saved.
    pub fn open_with(text: &str, setup: Setup) -> Result<Self, Vec<Diagnostic>> {
        match Document::parse(text) {
            (Some(document), mistakes) if mistakes.is_empty() => Ok(Self::of(document, setup)),
            (_, mistakes) => Err(mistakes),
        }
    }

    fn of(document: Document, setup: Setup) -> Self {
        let mut session = Self {
            setup,
            base: document.clone(),
            document,
            history: History::default(),
            pictures: Pictures::default(),
            diagnostics: Vec::new(),
            parameters: Vec::new(),
            size: 0,
            outputs: Map::default(),
            is_dragged: false,
        };
        session.analyse();
        session
    }

    /// The document, with the values that inputs have now.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// The text of the document.
    pub fn to_text(&self) -> String {
        self.document.to_text()
    }

    /// How it was opened.
    pub fn setup(&self) -> &Setup {
        &self.setup
    }

    /// Every mistake and warning of the document.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// The inputs of the graph with the values that they have now.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// The numbers of all inputs, one a component, in their order: what evaluators and uniforms take.
    pub fn numbers(&self) -> Vec<f32> {
        let numbers = self.parameters.iter().flat_map(|p| p.value.numbers());
        numbers.collect()
    }

    /// The outputs of the document that have or had a program, in the document's order.
    pub fn outputs(&self) -> impl Iterator<Item = &LiveOutput> {
        self.outputs.values().map(|kept| &kept.output)
    }

    /// One of them.
    pub fn output(&self, name: &str) -> Option<&LiveOutput> {
        self.outputs.get(name).map(|kept| &kept.output)
    }

    /// Does an edit. Edits that follow each other and set the same thing are one gesture and one step of
    /// undo, until [`Session::commit`] ends it.
    ///
    /// The value of an input of the graph is no reason to compile: as long as it is dragged, what a
    /// compile measures at that value (taps, the audit of `auto`) stays as it was.
    ///
    /// # Errors
    /// If it names what is not there, takes a name twice, or is not written as a document writes it; then
    /// nothing is changed.
    pub fn apply(&mut self, edit: Edit) -> Result<Change, Box<Diagnostic>> {
        let inverse = self.perform(&edit)?;
        let dragged = match &edit {
            Edit::SetInput {
                graph: None, input, ..
            } => self.dragged(input),
            _ => None,
        };
        if let Some(first) = self.history.record(edit, inverse) {
            self.forget(first);
        }
        Ok(dragged.unwrap_or_else(|| self.analyse()))
    }

    /// Does it to the document, and gives what takes it back.
    fn perform(&mut self, edit: &Edit) -> Result<Vec<patch::Patch>, Box<Diagnostic>> {
        perform(&self.setup, &mut self.document, &mut self.pictures, edit)
    }

    /// What a new value of an input changes, where that is nothing but its numbers.
    fn dragged(&mut self, input: &str) -> Option<Change> {
        if self.diagnostics.iter().any(Diagnostic::is_error) {
            return None;
        }
        let index = self.document.body.inputs.get_index_of(input)?;
        // The value is read by who reads documents.
        let mut alone = Document::default();
        let entry = self.document.body.inputs[index].clone();
        alone.body.inputs.insert(input.to_owned(), entry);
        let draft = mipless_graph::draft(&alone, self.setup.catalogue.specs());
        let place = "/inputs/";
        let is_wrong = |d: &Diagnostic| {
            d.is_error() && d.pointer.as_deref().is_some_and(|at| at.starts_with(place))
        };
        if draft.diagnostics.iter().any(is_wrong) {
            return None;
        }
        let parameter = draft.graph?.parameters.into_iter().next()?;
        let known = self.parameters.get_mut(index)?;
        let mut change = Change {
            diagnostics: self.diagnostics.clone(),
            ..Change::default()
        };
        if known.value != parameter.value {
            *known = parameter;
            self.is_dragged = true;
            change.parameters.push(input.to_owned());
        }
        Some(change)
    }

    /// Ends a gesture: the next edit is a step of its own, and what depends on the values of inputs beyond
    /// uniforms is looked at again.
    pub fn commit(&mut self) -> Change {
        self.history.close();
        if self.is_dragged {
            return self.analyse();
        }
        Change {
            diagnostics: self.diagnostics.clone(),
            ..Change::default()
        }
    }

    /// Takes the last step back; nothing if there is none.
    pub fn undo(&mut self) -> Option<Change> {
        let undone = self.history.undo(&mut self.document);
        undone.then(|| self.analyse())
    }

    /// Does again what was taken back last; nothing if there is none.
    pub fn redo(&mut self) -> Option<Change> {
        let edit = self.history.undone.pop()?;
        self.history.close();
        let inverse = self.perform(&edit);
        let inverse = inverse.expect("what was done can be done again where it was taken back");
        if let Some(first) = self.history.push(edit, inverse) {
            self.forget(first);
        }
        Some(self.analyse())
    }

    /// How many steps can be taken back, and done again.
    pub fn steps(&self) -> (usize, usize) {
        (self.history.done.len(), self.history.undone.len())
    }

    /// The first step cannot be taken back any more: it belongs to what a session begins with.
    fn forget(&mut self, first: history::Step) {
        let done = perform(&self.setup, &mut self.base, &mut self.pictures, &first.edit);
        assert!(done.is_ok(), "what was done can be done again");
    }

    /// Forgets all steps: nothing can be taken back any more.
    pub fn clear_history(&mut self) {
        self.history = History::default();
        self.base.clone_from(&self.document);
    }

    /// How many nodes the graph has, those of sub-graphs as often as they are used.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Reads the files again that the graph names.
    pub fn reload(&mut self) -> Change {
        self.pictures.forget();
        self.analyse()
    }

    /// Compiles for something else: another method, moments.
    pub fn set_options(&mut self, options: Options) -> Change {
        self.setup.options = options;
        self.analyse()
    }

    /// Looks at the document anew.
    fn analyse(&mut self) -> Change {
        let context = self.setup.context(&self.setup.options);
        let Analysis {
            diagnostics,
            sound,
            outputs,
            parameters,
            size,
        } = context.analyse(&self.document, &mut self.pictures);
        self.is_dragged = false;
        let mut change = Change {
            diagnostics_changed: diagnostics != self.diagnostics,
            ..Change::default()
        };
        let values = parameters.iter().filter(|parameter| {
            let mut known = self.parameters.iter();
            let known = known.find(|known| known.name == parameter.name);
            known.is_some_and(|known| known.value != parameter.value)
        });
        change.parameters = values.map(|parameter| parameter.name.clone()).collect();

        let has_mistakes = diagnostics.iter().any(Diagnostic::is_error);
        let compiled = sound.map(|(checked, digest)| {
            Compiled::of(&checked, digest, &self.setup.catalogue, &self.setup.options)
        });
        let mut before = std::mem::take(&mut self.outputs);
        let mut next: Map<Kept> = Map::default();
        if let Some(compiled) = &compiled {
            for sound in outputs {
                let known = before.shift_remove(&sound.name);
                let same = known.as_ref().is_some_and(|kept| {
                    kept.digest == sound.digest
                        && kept.output.compiled.method() == compiled.method()
                });
                let was_current = known.as_ref().is_some_and(|kept| kept.output.is_current);
                if !same || !was_current {
                    change.shaders.push(sound.name.clone());
                }
                // While there are mistakes, what they do not reach stays what it is.
                let compiled = match known {
                    Some(kept) if same && has_mistakes => kept.output.compiled,
                    _ => Arc::clone(compiled),
                };
                let output = LiveOutput {
                    name: sound.name.clone(),
                    ty: sound.ty,
                    compiled,
                    is_current: true,
                };
                let digest = sound.digest;
                next.insert(sound.name, Kept { output, digest });
            }
        }
        // What is left is broken, or gone.
        for (name, mut kept) in before {
            let is_there = self.document.body.outputs.contains_key(&name)
                || (has_mistakes
                    && self.document.body.outputs.values().any(|output| {
                        // The parts of a material have names of their own.
                        is_material(&self.setup.catalogue, &self.document, &output.node)
                    }));
            if !is_there || !has_mistakes {
                change.removed.push(name);
                continue;
            }
            if kept.output.is_current {
                change.broken.push(name.clone());
            }
            kept.output.is_current = false;
            next.insert(name, kept);
        }
        self.outputs = next;
        self.parameters = parameters;
        self.size = size;
        self.diagnostics.clone_from(&diagnostics);
        change.diagnostics = diagnostics;
        change
    }

    /// The program of one output of a node: what a preview shows. A node inside of a sub-graph is named by
    /// its path, `sky/noise`. Mistakes elsewhere in the document do not matter.
    ///
    /// # Errors
    /// The mistakes of what the node needs, or that there is no such node.
    pub fn preview(
        &mut self,
        node: &str,
        port: &str,
        options: &Options,
    ) -> Result<Arc<Compiled>, Vec<Diagnostic>> {
        let context = self.setup.context(options);
        let (checked, digest) = context.preview(&self.document, &mut self.pictures, node, port)?;
        let catalogue = &self.setup.catalogue;
        Ok(Compiled::of(&Arc::new(checked), digest, catalogue, options))
    }
}

impl Setup {
    fn context<'s>(&'s self, options: &'s Options) -> Context<'s> {
        Context {
            catalogue: &self.catalogue,
            name: &self.name,
            options,
            files: &*self.files,
        }
    }
}

/// Does an edit to a document, and gives what takes it back; a document that refuses it is as it was.
fn perform(
    setup: &Setup,
    document: &mut Document,
    pictures: &mut Pictures,
    edit: &Edit,
) -> Result<Vec<patch::Patch>, Box<Diagnostic>> {
    // Only a group asks for types, which take a look at the whole document.
    let types = match edit {
        Edit::Group { graph, .. } => {
            let context = setup.context(&setup.options);
            Some(context.types(document, pictures, graph))
        }
        _ => None,
    };
    let mut recorder = Recorder::new(document);
    let done = apply::apply(&mut recorder, edit, &|reference| types.as_ref()?(reference));
    let inverse = recorder.finish();
    match done {
        Ok(()) => Ok(inverse),
        Err(refused) => {
            patch::revert(document, inverse);
            Err(refused)
        }
    }
}

/// Whether a node gives a material.
fn is_material(catalogue: &Catalogue, document: &Document, node: &str) -> bool {
    let ty = |node: &NodeEntry| node.ty.clone();
    let ty = document.body.nodes.get(node).map(ty);
    let mut specs = catalogue.specs().iter();
    ty.is_some_and(|ty| specs.any(|spec| spec.name == ty && spec.material().is_some()))
}
