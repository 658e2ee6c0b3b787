//! The nodes that a tool offers: those of this crate, its own, and sub-graphs of a library.

use crate::files::name_of_file;
use mipless_codegen::NodeDef;
use mipless_graph::{Body, Diagnostic, Document, Map, NodeEntry, NodeSpec, draft};
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};

/// The node types and the library of sub-graphs that graphs may use. Clones share them.
///
/// # Nodes of a tool's own
/// A [`NodeDef`] is a [`NodeSpec`], which is data, and a function that builds the node's output through
/// the moment algebra; [`conformance::check` (feature `targets`) says whether it keeps the laws.
/// ```
/// use mipless::define::*;
/// use mipless::{Catalogue, CheckOptions, NoFiles, Texture};
///
/// /// (in − ½)², which is a product of a signal with itself.
/// fn lower<'b>(lower: &mut Lower<'_, 'b>, node: &Node) -> Bundle<'b> {
///     let signals = lower.bundle(node, "in");
///     let square = |signal: &Signal<'b>| {
///         // It is read twice: what it has for itself becomes what both readers share.
///         let centred = lower.algebra.expose(&signal.offset(-0.5));
///         lower.algebra.product(&centred, &centred)
///     };
///     signals.iter().map(square).collect()
/// }
///
/// static SPEC: NodeSpec = NodeSpec {
///     name: "acme_bowl",
///     aliases: &[],
///     category: Category::Transfer,
///     summary: "The square of how far a signal is from ½.",
///     doc: Doc {
///         computes: "out = (in − ½)².",
///         statistics: "A product: exact in mean and variance for a Gaussian signal.",
///         accuracy: "Exact to rounding.",
///         references: "Isserlis 1918.",
///     },
///     inputs: &[PortSpec::new("in", PortType::Any, Default::Float(0.0), "The signal.")],
///     output: OutputType::Widest,
///     reach: |_| Reach::ANY,
///     class: |_| Behaviour::Product,
///     example: r#"{ "version": 1, "name": "acme_bowl", "nodes": { "noise": { "type": "noise2d" },
///         "bowl": { "type": "acme_bowl", "inputs": { "in": { "node": "noise" } } } },
///         "outputs": { "out": { "node": "bowl" } } }"#,
/// };
///
/// let catalogue = Catalogue::shipped().with_nodes(&[NodeDef::new(&SPEC, lower)])?;
/// let json = r#"{ "version": 1,
///     "nodes": { "noise": { "type": "noise2d" },
///                "bowl": { "type": "acme_bowl", "inputs": { "in": { "node": "noise" } } } },
///     "outputs": { "height": { "node": "bowl" } } }"#;
/// let texture = catalogue.texture("bowl", json, &CheckOptions::default(), &NoFiles).expect("no mistakes");
/// assert_eq!(texture.outputs()[0].name, "height");
/// # Ok::<(), mipless::CatalogueError>(())
/// ```
#[derive(Clone)]
pub struct Catalogue(Arc<Inner>);

struct Inner {
    definitions: Cow<'static, [NodeDef]>,
    specs: Vec<&'static NodeSpec>,
    library: Map<Body>,
}

/// Why nodes or a library cannot be added to a catalogue.
#[derive(Debug)]
pub enum CatalogueError {
    /// A node of this name, or with it as an alias, is there already.
    NameTaken(String),
    /// A name that documents give another meaning: it is empty, or begins with `graph:`.
    Name(String),
    /// A port of a node has the name of another one.
    Port {
        /// The node.
        node: String,
        /// The port.
        port: String,
    },
    /// A file of the library cannot be read.
    Unreadable(PathBuf, io::Error),
    /// A graph of the library has mistakes.
    Mistakes(PathBuf, Vec<Diagnostic>),
}

impl fmt::Display for CatalogueError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NameTaken(name) => write!(f, "there is a node `{name}` already"),
            Self::Name(name) => write!(f, "no node can be called `{name}`"),
            Self::Port { node, port } => write!(f, "`{node}` has two ports `{port}`"),
            Self::Unreadable(path, error) => write!(f, "{}: {error}", path.display()),
            Self::Mistakes(path, mistakes) => {
                for mistake in mistakes {
                    writeln!(f, "{}: {mistake}", path.display())?;
                }
                Ok(())
            }
        }
    }
}

impl std::error::Error for CatalogueError {}

impl fmt::Debug for Catalogue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Catalogue")
            .field("nodes", &self.0.specs.len())
            .field("library", &self.0.library.len())
            .finish()
    }
}

impl Default for Catalogue {
    fn default() -> Self {
        Self::shipped()
    }
}

impl Catalogue {
    /// The nodes of this crate.
    pub fn shipped() -> Self {
        static SHIPPED: LazyLock<Catalogue> =
            LazyLock::new(|| Catalogue::of(Cow::Borrowed(crate::catalogue()), Map::default()));
        SHIPPED.clone()
    }

    fn of(definitions: Cow<'static, [NodeDef]>, library: Map<Body>) -> Self {
        Self(Arc::new(Inner {
            specs: definitions.iter().map(|def| def.spec).collect(),
            definitions,
            library,
        }))
    }

    /// The same with nodes of a tool's own.
    ///
    /// # Errors
    /// If a name is taken, or is none.
    pub fn with_nodes(&self, nodes: &[NodeDef]) -> Result<Self, CatalogueError> {
        let mut definitions = self.0.definitions.to_vec();
        for node in nodes {
            let name = node.spec.name;
            if name.is_empty() || name.starts_with("graph:") {
                return Err(CatalogueError::Name(name.to_owned()));
            }
            let is_taken =
                |known: &NodeDef| known.spec.name == name || known.spec.aliases.contains(&name);
            if definitions.iter().any(is_taken) {
                return Err(CatalogueError::NameTaken(name.to_owned()));
            }
            let mut ports = BTreeSet::new();
            for port in node.spec.inputs {
                if !ports.insert(port.name) {
                    return Err(CatalogueError::Port {
                        node: name.to_owned(),
                        port: port.name.to_owned(),
                    });
                }
            }
            definitions.push(*node);
        }
        Ok(Self::of(Cow::Owned(definitions), self.0.library.clone()))
    }

    /// The same with the graphs of a folder: `FOLDER/rust.json` is the node `graph:rust` of every document
    /// that has no sub-graph of this name. They may use each other.
    ///
    /// # Errors
    /// If a file cannot be read, or a graph has mistakes.
    pub fn with_library(&self, folder: &Path) -> Result<Self, CatalogueError> {
        let unreadable = |path: &Path| {
            let path = path.to_path_buf();
            move |error| CatalogueError::Unreadable(path, error)
        };
        let mut files = Vec::new();
        for entry in std::fs::read_dir(folder).map_err(unreadable(folder))? {
            let path = entry.map_err(unreadable(folder))?.path();
            if path
                .extension()
                .is_some_and(|extension| extension == "json")
            {
                files.push(path);
            }
        }
        files.sort();
        let mut library = self.0.library.clone();
        let mut added = Vec::new();
        for path in files {
            let text = std::fs::read_to_string(&path).map_err(unreadable(&path))?;
            let (document, mistakes) = Document::parse(&text);
            let (Some(document), true) = (document, mistakes.is_empty()) else {
                return Err(CatalogueError::Mistakes(path, mistakes));
            };
            let name = name_of_file(&path);
            add(&mut library, &name, document);
            added.push((name, path));
        }
        let catalogue = Self::of(self.0.definitions.clone(), library);
        for (name, path) in added {
            let errors = catalogue.mistakes_of(&name);
            if !errors.is_empty() {
                return Err(CatalogueError::Mistakes(path, errors));
            }
        }
        Ok(catalogue)
    }

    /// The mistakes of a graph of the library, as a document that shows its outputs.
    fn mistakes_of(&self, name: &str) -> Vec<Diagnostic> {
        let mut document = Document::default();
        let body = &self.0.library[name];
        let node = NodeEntry {
            ty: format!("graph:{name}"),
            ..NodeEntry::default()
        };
        document.body.nodes.insert("node".to_owned(), node);
        for output in body.outputs.keys() {
            let reference = mipless_graph::Reference::to("node", output.as_str());
            document.body.outputs.insert(output.clone(), reference);
        }
        let draft = draft(&self.complete(&document), self.specs());
        let mut found = draft.diagnostics;
        found.retain(Diagnostic::is_error);
        found
    }

    /// What tells catalogues apart, as long as both are there.
    pub(crate) fn identity(&self) -> usize {
        Arc::as_ptr(&self.0) as usize
    }

    /// The definitions of the nodes.
    pub fn definitions(&self) -> &[NodeDef] {
        &self.0.definitions
    }

    /// Their specs.
    pub fn specs(&self) -> &[&'static NodeSpec] {
        &self.0.specs
    }

    /// The sub-graphs of the library, by the names under which documents use them.
    pub fn library(&self) -> impl Iterator<Item = (&str, &Body)> {
        self.0
            .library
            .iter()
            .map(|(name, body)| (name.as_str(), body))
    }

    /// The document with the sub-graphs of the library that it uses.
    pub fn complete<'d>(&self, document: &'d Document) -> Cow<'d, Document> {
        if self.0.library.is_empty() {
            return Cow::Borrowed(document);
        }
        let mut whole = Cow::Borrowed(document);
        let bodies = std::iter::once(&document.body).chain(document.graphs.values());
        let mut pending: Vec<&Body> = bodies.collect();
        while let Some(body) = pending.pop() {
            for node in body.nodes.values() {
                let Some(name) = node.ty.strip_prefix("graph:") else {
                    continue;
                };
                if !whole.graphs.contains_key(name)
                    && let Some(sub) = self.0.library.get(name)
                {
                    whole.to_mut().graphs.insert(name.to_owned(), sub.clone());
                    pending.push(sub);
                }
            }
        }
        whole
    }
}

/// Adds a document to a library. Its own sub-graphs come with it under its name.
fn add(library: &mut Map<Body>, name: &str, document: Document) {
    let own: BTreeSet<String> = document.graphs.keys().cloned().collect();
    let renamed = |mut body: Body| {
        for node in body.nodes.values_mut() {
            if let Some(sub) = node.ty.strip_prefix("graph:")
                && own.contains(sub)
            {
                node.ty = format!("graph:{name}.{sub}");
            }
        }
        body
    };
    for (sub, body) in document.graphs {
        library.insert(format!("{name}.{sub}"), renamed(body));
    }
    library.insert(name.to_owned(), renamed(document.body));
}
