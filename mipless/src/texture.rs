//! A checked graph with its catalogue.

use crate::files::{Files, Folder, NoFiles, name_of_file};
use crate::{Audit, Catalogue, NodeDef, Options, Program, TextureEvaluator, resource};
use std::fmt;
use std::io;
use std::path::Path;

use mipless_graph::{
    CheckOptions, Checked, Diagnostic, Document, Graph, NodeSpec, Output, Parameter, ParameterId,
    SettingError, Signal, Type, check, load_with,
};

/// The specs of the catalogue.
pub fn specs() -> Vec<&'static NodeSpec> {
    crate::catalogue()
        .iter()
        .map(|definition| definition.spec)
        .collect()
}

/// Why a file gives no texture.
#[derive(Debug)]
pub enum FromFileError {
    /// It cannot be read, or is not UTF-8.
    Unreadable(io::Error),
    /// The graph has mistakes.
    Mistakes(Vec<Diagnostic>),
}

impl fmt::Display for FromFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(error) => write!(f, "the file cannot be read: {error}"),
            Self::Mistakes(mistakes) => {
                for (index, mistake) in mistakes.iter().enumerate() {
                    write!(f, "{}{mistake}", if index == 0 { "" } else { "\n" })?;
                }
                Ok(())
            }
        }
    }
}

impl std::error::Error for FromFileError {}

/// Why an input cannot be made a constant.
#[derive(Clone, Debug, PartialEq)]
pub enum BakeError {
    /// The graph has no input of this name.
    NoInput(String),
    /// The input of this name does not take the value.
    Value(String, SettingError),
    /// The graph has mistakes with these values.
    Mistakes(Vec<Diagnostic>),
}

impl fmt::Display for BakeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoInput(name) => write!(f, "the graph has no input `{name}`"),
            Self::Value(name, error) => write!(f, "input `{name}`: {error}"),
            Self::Mistakes(mistakes) => {
                let first = mistakes.iter().find(|mistake| mistake.is_error());
                first.map_or(Ok(()), |mistake| mistake.fmt(f))
            }
        }
    }
}

impl std::error::Error for BakeError {}

/// A texture graph without mistakes.
#[derive(Clone, Debug)]
pub struct Texture {
    catalogue: Catalogue,
    checked: Checked,
    document: Document,
    warnings: Vec<Diagnostic>,
}

impl Texture {
    /// Loads and checks the JSON graph of a file, with the pictures that it names, relative to
    /// its folder (reading them needs the feature `files`). A graph without a name is called as
    /// the file is, without its extension.
    ///
    /// # Errors
    /// If the file cannot be read as text; else every mistake, located, and the warnings with them.
    pub fn from_file(path: &Path) -> Result<Self, FromFileError> {
        let text = std::fs::read_to_string(path).map_err(FromFileError::Unreadable)?;
        let folder = Folder(path.parent().unwrap_or(Path::new("")).to_path_buf());
        Self::with_name(
            &name_of_file(path),
            &text,
            &CheckOptions::default(),
            &folder,
        )
        .map_err(FromFileError::Mistakes)
    }

    /// Loads and checks a JSON graph that names no files. One without a name is called `texture`.
    ///
    /// # Errors
    /// Every mistake, located, and the warnings with them.
    pub fn from_json(text: &str) -> Result<Self, Vec<Diagnostic>> {
        Self::with_options(text, &CheckOptions::default())
    }

    /// The same; `options` may allow signals without statistics, which only
    /// [`crate::Method::Supersample`] filters.
    ///
    /// # Errors
    /// Every mistake, located, and the warnings with them.
    pub fn with_options(text: &str, options: &CheckOptions) -> Result<Self, Vec<Diagnostic>> {
        Self::with_files(text, options, &NoFiles)
    }

    /// The same for a graph that may name files, which `files` gives: pictures of at most
    /// [`crate::LARGEST_SIDE`] texels a side and [`crate::LARGEST_PICTURE`] in all, in files of at
    /// most [`crate::LARGEST_FILE`] bytes. Without the feature `files` there is no decoder, and
    /// each name of a picture is a mistake that says so.
    ///
    /// # Errors
    /// Every mistake, those of the files among them, located, and the warnings with them.
    pub fn with_files(
        text: &str,
        options: &CheckOptions,
        files: &dyn Files,
    ) -> Result<Self, Vec<Diagnostic>> {
        Self::with_name(Graph::NAMELESS, text, options, files)
    }

    /// The same; a graph without a name is called `name`, in its shaders too, as an identifier that
    /// is made of it. The document stays without one.
    ///
    /// # Errors
    /// Every mistake, those of the files among them, located, and the warnings with them.
    pub fn with_name(
        name: &str,
        text: &str,
        options: &CheckOptions,
        files: &dyn Files,
    ) -> Result<Self, Vec<Diagnostic>> {
        Self::of_catalogue(&Catalogue::shipped(), name, text, options, files)
    }

    /// The same with the nodes and the library of a catalogue.
    pub(crate) fn of_catalogue(
        catalogue: &Catalogue,
        name: &str,
        text: &str,
        options: &CheckOptions,
        files: &dyn Files,
    ) -> Result<Self, Vec<Diagnostic>> {
        let loaded = load_with(text, catalogue.specs(), |document| {
            catalogue.complete(document)
        });
        let (images, found) = resource::read(&loaded.files, files);
        let mut diagnostics = loaded.diagnostics;
        diagnostics.extend(found);
        diagnostics.sort_by_key(|diagnostic| (diagnostic.line, diagnostic.column));
        let (Some(mut graph), Some(document)) = (loaded.graph, loaded.document) else {
            return Err(diagnostics);
        };
        graph.images = images;
        if document.name.is_none() {
            name.clone_into(&mut graph.name);
        }
        let unusable = diagnostics.iter().any(Diagnostic::is_error);
        match check(graph, options) {
            Ok(checked) if !unusable => {
                diagnostics.extend(checked.warnings().iter().cloned());
                diagnostics.extend(jumps(&checked, catalogue.definitions()));
                Ok(Self {
                    catalogue: catalogue.clone(),
                    checked,
                    document,
                    warnings: diagnostics,
                })
            }
            Ok(checked) => {
                diagnostics.extend(checked.warnings().iter().cloned());
                Err(diagnostics)
            }
            Err(mistakes) => {
                diagnostics.extend(mistakes);
                Err(diagnostics)
            }
        }
    }

    /// The parts of the graph's material by these names, of those that it has, as a texture of which they
    /// are the outputs, whatever the graph's own are. `None` where the graph has no material.
    ///
    /// # Errors
    /// The mistakes that only such parts have.
    pub fn material(
        &self,
        parts: &[&str],
        options: &CheckOptions,
    ) -> Option<Result<Self, Vec<Diagnostic>>> {
        let graph = self.checked.graph();
        let graph = graph.with_parts(graph.materials.first()?, parts);
        let checked = check(graph, options);
        Some(checked.map(|checked| Self {
            catalogue: self.catalogue.clone(),
            checked,
            document: self.document.clone(),
            warnings: Vec::new(),
        }))
    }

    /// The document, to edit and to save; load the result again.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// The graph's name: the document's, or that which stood in for it.
    pub fn name(&self) -> &str {
        &self.checked.graph().name
    }

    /// The checked graph.
    pub fn checked(&self) -> &Checked {
        &self.checked
    }

    /// The warnings of loading and checking.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// The graph's inputs.
    pub fn parameters(&self) -> &[Parameter] {
        &self.checked.graph().parameters
    }

    /// The graph's outputs.
    pub fn outputs(&self) -> &[Output] {
        &self.checked.graph().outputs
    }

    /// Whether people look at an output as it is: a colour that is no normal or the like.
    pub fn is_color(&self, output: &Output) -> bool {
        let is_mean = self.checked.graph().node(output.node).is_mean();
        is_mean && matches!(output.ty, Type::Color3 | Type::Color4)
    }

    /// The texture with those of its outputs alone that have these names, in their order: what only others
    /// need is not computed.
    ///
    /// # Panics
    /// If it has none of them: a bug of the caller.
    pub fn with_outputs(&self, names: &[&str]) -> Self {
        let graph = self.checked.graph().with_outputs(names);
        assert!(!graph.outputs.is_empty(), "outputs of the texture");
        // What has no statistics was allowed before, or is not there.
        let options = CheckOptions {
            allow_sampling: true,
        };
        Self {
            checked: check(graph, &options).expect("what is read has been checked"),
            ..self.clone()
        }
    }

    /// What the check says of each node's signal.
    pub fn signals(&self) -> &[Signal] {
        self.checked.signals()
    }

    /// Compiles the graph for both back ends.
    pub fn compile(&self, options: &Options) -> Program {
        mipless_codegen::compile(&self.checked, self.catalogue.definitions(), options)
    }

    /// The same, with what [`Texture::audit`] says of it, where the method is `auto`.
    pub fn compile_audited(&self, options: &Options) -> (Program, Option<Audit>) {
        mipless_codegen::compile_audited(&self.checked, self.catalogue.definitions(), options)
    }

    /// The texture in which these inputs are constants for good, written as on the command line: `0.5`,
    /// `0.1,0.2,0.3`, `#rrggbb`, `true`. What follows from them alone is worked out when it is compiled.
    ///
    /// # Errors
    /// [`BakeError`] of an input that is not there or does not take its value, and of a graph that has
    /// mistakes with it.
    pub fn baked(
        &self,
        settings: &[(&str, &str)],
        options: &CheckOptions,
    ) -> Result<Self, BakeError> {
        let graph = self.checked.graph();
        let mut constants = Vec::new();
        for &(name, text) in settings {
            let index = (0..).zip(&graph.parameters).find(|(_, p)| p.name == name);
            let Some((index, parameter)) = index else {
                return Err(BakeError::NoInput(name.to_owned()));
            };
            let value = parameter.parse(text);
            let value = value.map_err(|error| BakeError::Value(name.to_owned(), error))?;
            constants.push((ParameterId(index), value));
        }
        let checked = check(graph.with_constants(&constants), options);
        Ok(Self {
            checked: checked.map_err(BakeError::Mistakes)?,
            ..self.clone()
        })
    }

    /// What `auto` does where closed forms are wrong, and how far it is off: measured on the CPU at a
    /// few places, once for each graph, by [`Texture::compile`] too.
    pub fn audit(&self, options: &Options) -> Audit {
        mipless_codegen::audit(&self.checked, self.catalogue.definitions(), options)
    }

    /// Compiles the graph for evaluation on the CPU, with its inputs at their defaults.
    pub fn evaluator(&self, options: &Options) -> TextureEvaluator {
        TextureEvaluator::new(self.parameters().to_vec(), &self.compile(options))
    }
}

impl Catalogue {
    /// The graph of a text, whose nodes these are; a graph without a name is called `name`.
    ///
    /// # Errors
    /// Every mistake, located, and the warnings with them.
    pub fn texture(
        &self,
        name: &str,
        text: &str,
        options: &CheckOptions,
        files: &dyn Files,
    ) -> Result<Texture, Vec<Diagnostic>> {
        Texture::of_catalogue(self, name, text, options, files)
    }
}

/// Warnings of heights that jump.
pub(crate) fn jumps(checked: &Checked, catalogue: &[NodeDef]) -> Vec<Diagnostic> {
    let nodes = mipless_codegen::jumps(checked, catalogue);
    let warn = |id| {
        let node = checked.graph().node(id);
        let message = format!("the height of a material jumps at `{}`", node.name);
        Diagnostic::warning("height-jumps", message)
            .at(&*node.pointer)
            .in_node(&*node.name)
            .because(
                "a jump has no slope: what is counted of it is that of its first Hermite \
                 polynomials, a lower bound",
            )
            .help("make its edge a ramp: `smoothstep` in place of `step`, a `bevel`, a linear ramp")
    };
    nodes.into_iter().map(warn).collect()
}
