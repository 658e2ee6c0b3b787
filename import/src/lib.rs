//! Reads texture graphs of other tools into Mipless's JSON document: MaterialX (`.mtlx`), Material
//! Maker (`.ptex`) and glTF (`KHR_texture_procedurals`).
//!
//! ```text
//! text ──read──► elements ──rules──► Document, and what was found
//! ```
//!
//! What a node of another tool becomes is said by tables (`materialx/rules.txt`), in a language of
//! expressions that `rule` reads and `eval` works out; node definitions are a table as well. What
//! cannot be had is told all at once, each with its file, line, column and path, and does not keep
//! other outputs from loading.
//!
//! ```
//! use mipless_import::{Format, Options, import};
//!
//! let text = r#"<?xml version="1.0"?>
//! <materialx version="1.39">
//!   <nodegraph name="mask">
//!     <normal name="n" type="vector3" />
//!     <output name="out" type="vector3" nodename="n" />
//!   </nodegraph>
//! </materialx>"#;
//! let imported = import(Format::MaterialX, "mask.mtlx", text, &Options::default());
//! let finding = &imported.findings[0];
//! assert_eq!(finding.diagnostic.code, "import-geometry");
//! assert_eq!((finding.diagnostic.line, finding.diagnostic.column), (Some(4), Some(5)));
//! assert_eq!(imported.summary(), "0 of 1 outputs");
//! ```

mod build;
mod element;
mod eval;
mod export;
mod gltf;
mod json;
mod materialmaker;
mod materialx;
mod matrix;
mod place;
mod rule;
mod surface;
#[cfg(test)]
mod tests;
mod value;

use build::Builder;
use mipless_graph::{Binding, Diagnostic, Document, NodeSpec};
use place::{Findings, Place, Source};
use rustc_hash::{FxHashMap, FxHashSet};
use std::fmt;
use std::io;
use std::path::Path;

pub use export::{Exported, export};
pub use place::Finding;

/// What a file is written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// MaterialX, `.mtlx`.
    MaterialX,
    /// Material Maker, `.ptex`.
    MaterialMaker,
    /// glTF with `KHR_texture_procedurals`, `.gltf`.
    Gltf,
}

impl Format {
    /// The format of a file, by its extension.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "mtlx" => Some(Self::MaterialX),
            "ptex" => Some(Self::MaterialMaker),
            "gltf" => Some(Self::Gltf),
            _ => None,
        }
    }

    /// What it is called.
    pub const fn name(self) -> &'static str {
        match self {
            Self::MaterialX => "MaterialX",
            Self::MaterialMaker => "Material Maker",
            Self::Gltf => "glTF",
        }
    }
}

/// How a document is read.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// The nodes that there are.
    pub specs: &'a [&'static NodeSpec],
    /// The material, shader or nodegraph to read; all of them without one.
    pub material: Option<&'a str>,
    /// Reads what the document includes, by names relative to it.
    pub files: &'a dyn Fn(&str) -> io::Result<Vec<u8>>,
    /// The documents of an installation of MaterialX, with their names; asked for where a node
    /// needs them.
    pub library: &'a dyn Fn() -> Vec<(String, String)>,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Self {
            specs: &[],
            material: None,
            files: &|_| Err(io::ErrorKind::NotFound.into()),
            library: &Vec::new,
        }
    }
}

impl fmt::Debug for Options<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Options")
            .field("specs", &self.specs.len())
            .field("material", &self.material)
            .finish_non_exhaustive()
    }
}

/// An output that a document has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    /// What it is called in the graph.
    pub name: String,
    /// What it shows of the document: `nodegraph/output`, `shader/input`.
    pub source: String,
    /// Whether it is in the graph.
    pub loads: bool,
}

/// What became of a document.
#[derive(Debug)]
pub struct Imported {
    /// The graph with the outputs that load, if any does.
    pub document: Option<Document>,
    /// Every output that the document has.
    pub outputs: Vec<Output>,
    /// Errors and notes, in the order of the text.
    pub findings: Vec<Finding>,
    places: FxHashMap<String, Place>,
    sources: Vec<Source>,
}

impl Imported {
    fn nothing(findings: Findings) -> Self {
        let (findings, sources) = findings.into_findings();
        Self {
            document: None,
            outputs: Vec::new(),
            findings,
            places: FxHashMap::default(),
            sources,
        }
    }

    fn new(builder: Builder, outputs: Vec<Output>, findings: Findings) -> Self {
        let (findings, sources) = findings.into_findings();
        let mut document = builder.document;
        keep_what_is_read(&mut document);
        Self {
            document: outputs
                .iter()
                .any(|output| output.loads)
                .then_some(document),
            outputs,
            findings,
            places: builder.places,
            sources,
        }
    }

    /// Whether every output loads and nothing else is wrong.
    pub fn is_complete(&self) -> bool {
        self.outputs.iter().all(|output| output.loads)
            && !self
                .findings
                .iter()
                .any(|finding| finding.diagnostic.is_error())
    }

    /// How much loads: `12 of 14 outputs`.
    pub fn summary(&self) -> String {
        let loads = self.outputs.iter().filter(|output| output.loads).count();
        let s = if self.outputs.len() == 1 && loads == 1 {
            ""
        } else {
            "s"
        };
        format!("{loads} of {} output{s}", self.outputs.len())
    }

    /// The graph with its inputs written as the numbers that they hold, for graphs that do not check
    /// over all that an input may be; nothing where it has none.
    pub fn without_inputs(&self) -> Option<Document> {
        let mut document = self.document.clone()?;
        let body = &mut document.body;
        // Three or four numbers alone are a colour, which such a vector is not.
        let is_kept = |ty: &str| matches!(ty, "vector3" | "vector4");
        let mut written = false;
        for node in body.nodes.values_mut() {
            for binding in node.inputs.values_mut() {
                if let Binding::Input(name) = binding
                    && let Some(entry) = body.inputs.get(name)
                    && !is_kept(&entry.ty)
                {
                    *binding = Binding::Value(entry.value.clone());
                    written = true;
                }
            }
        }
        body.inputs.retain(|_, entry| is_kept(&entry.ty));
        written.then_some(document)
    }

    /// A diagnostic about the graph, at the place in the document that its node comes from.
    pub fn located(&self, diagnostic: Diagnostic) -> Finding {
        let node = diagnostic.pointer.as_deref().and_then(|pointer| {
            let name = pointer.strip_prefix("/nodes/")?;
            Some(name.split('/').next().unwrap_or(name))
        });
        let place = node.and_then(|node| self.places.get(node));
        let Some((place, source)) =
            place.and_then(|place| Some((place, self.sources.get(place.file)?)))
        else {
            return Finding {
                file: self
                    .sources
                    .first()
                    .map_or(String::new(), |source| source.name.clone()),
                diagnostic: Diagnostic {
                    line: None,
                    column: None,
                    ..diagnostic
                },
            };
        };
        let (line, column) = source.line_and_column(place.offset);
        let pointer = diagnostic.pointer.clone().unwrap_or_default();
        Finding {
            file: source.name.clone(),
            diagnostic: diagnostic
                .because(format!("it became `{pointer}` of the graph"))
                .at(place.path.clone())
                .at_line(line, column),
        }
    }
}

/// Takes away the nodes and inputs that no output reads.
fn keep_what_is_read(document: &mut Document) {
    let mut wanted: Vec<String> = (document.body.outputs.values())
        .map(|reference| reference.node.clone())
        .collect();
    let (mut nodes, mut inputs) = (FxHashSet::default(), FxHashSet::default());
    while let Some(name) = wanted.pop() {
        let Some(node) = document.body.nodes.get(&name) else {
            continue;
        };
        for binding in node.inputs.values() {
            match binding {
                Binding::Node(reference) if !nodes.contains(&reference.node) => {
                    wanted.push(reference.node.clone());
                }
                Binding::Input(input) => {
                    inputs.insert(input.clone());
                }
                _ => {}
            }
        }
        nodes.insert(name);
    }
    document.body.nodes.retain(|name, _| nodes.contains(name));
    document.body.inputs.retain(|name, _| inputs.contains(name));
}

/// Reads a document of another tool; `name` is that of its file.
pub fn import(format: Format, name: &str, text: &str, options: &Options<'_>) -> Imported {
    match format {
        Format::MaterialX => materialx::import(name, text, options),
        Format::MaterialMaker => materialmaker::import(name, text, options),
        Format::Gltf => gltf::import(name, text, options),
    }
}
