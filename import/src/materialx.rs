//! MaterialX documents (`.mtlx`) of versions 1.38 and 1.39.

pub(crate) mod definition;
pub(crate) mod literal;
pub(crate) mod network;
mod read;
mod root;
mod surfaces;
mod upgrade;

use crate::build::{Builder, Refusal};
use crate::element::Tree;
use crate::place::{Findings, Place};
use crate::rule::Rules;
use crate::{Imported, Options, Output};
use mipless_graph::Diagnostic;
use network::{Library, Network};
use read::Reader;
use std::sync::OnceLock;
use surfaces::Surfaces;

/// What MaterialX's nodes become.
const RULES: &str = include_str!("materialx/rules.txt");

fn rules() -> &'static Rules {
    static PARSED: OnceLock<Rules> = OnceLock::new();
    PARSED.get_or_init(|| Rules::parse(RULES))
}

/// Reads a document.
pub(crate) fn import(name: &str, text: &str, options: &Options<'_>) -> Imported {
    let mut findings = Findings::default();
    let mut tree = Tree::new();
    let mut reader = Reader::new(options.files, &mut findings, Tree::ROOT);
    if reader.document(&mut tree, name, text.to_owned()).is_none() {
        return Imported::nothing(findings);
    }
    if !check_version(&mut tree, &mut findings) {
        return Imported::nothing(findings);
    }
    of_tree(tree, findings, options)
}

/// Converts a tree that is of version 1.39.
pub(crate) fn of_tree(tree: Tree, findings: Findings, options: &Options<'_>) -> Imported {
    let mut builder = Builder::new(options.specs);
    let library = Library::new(|tree: &mut Tree, findings: &mut Findings| {
        let documents = (options.library)();
        if documents.is_empty() {
            return None;
        }
        let root = tree.add_root();
        for (name, text) in documents {
            // What is wrong with an installation is nothing that the document could mend.
            let mut apart = Findings::default();
            std::mem::swap(&mut apart.sources, &mut findings.sources);
            let mut reader = Reader::new(options.files, &mut apart, root);
            reader.document(tree, &name, text);
            std::mem::swap(&mut apart.sources, &mut findings.sources);
        }
        Some(root)
    });
    let mut network = Network::new(tree, findings, rules(), library, options.specs);
    let start = Place {
        file: 0,
        offset: 0,
        path: String::new(),
    };
    let roots = match root::find(&mut network, options.material) {
        Ok(roots) => roots,
        Err(refusal) => {
            let diagnostic = Diagnostic::error(refusal.code, refusal.message);
            network.findings.say(&start, diagnostic);
            return Imported::nothing(network.findings);
        }
    };
    if roots.outputs.is_empty() && roots.surfaces.is_empty() {
        let message = "the document has no output: no shader of a material, and no nodegraph";
        let diagnostic = Diagnostic::error("import-empty", message);
        network.findings.say(&start, diagnostic);
    }
    let mut surfaces = Surfaces::new(&builder, &roots.surfaces);
    let mut outputs = Vec::with_capacity(roots.outputs.len());
    for root in roots.outputs {
        let scope = network.scope_of(root.graph);
        let value = network.value(&mut builder, scope, root.element);
        let source = network.source_of(scope, root.element);
        outputs.push(match surfaces.take(&mut network, &builder, &root, &value) {
            Some(name) => Output {
                name,
                source,
                loads: value.is_ok(),
            },
            None => {
                let name = surfaces.distinct(&builder, root.name);
                let made = value.and_then(|value| {
                    let place = network.tree.place(root.element);
                    let made = builder.output(&name, value);
                    made.map_err(|refusal| refuse(&mut network, &place, &refusal))
                });
                Output {
                    loads: made.is_ok(),
                    name,
                    source,
                }
            }
        });
    }
    surfaces.finish(&mut network, &mut builder, &mut outputs);
    Imported::new(builder, outputs, network.findings)
}

/// Says why something at a place does not load.
fn refuse(network: &mut Network<'_>, place: &Place, refusal: &Refusal) {
    let diagnostic = Diagnostic::error(refusal.code, refusal.message.clone());
    network.findings.say(place, diagnostic);
}

/// Whether the version is one of those that are read; what is older becomes 1.39.
fn check_version(tree: &mut Tree, findings: &mut Findings) -> bool {
    let version = tree
        .get(Tree::ROOT)
        .attribute("version")
        .unwrap_or("")
        .to_owned();
    let mut numbers = version.split('.').map(|part| part.trim().parse::<u32>());
    let (major, minor) = (numbers.next(), numbers.next());
    let place = tree.place(Tree::ROOT);
    match (major, minor) {
        (Some(Ok(1)), Some(Ok(39))) => true,
        (Some(Ok(1)), Some(Ok(38))) => {
            upgrade::upgrade(tree);
            true
        }
        (Some(Ok(1)), Some(Ok(newer))) if newer > 39 => {
            let message = format!("MaterialX {version} is newer than 1.39, as which it is read");
            findings.say(&place, Diagnostic::note("import-version", message));
            true
        }
        _ => {
            let message = format!("MaterialX `{version}` is not read: 1.38 and 1.39 are");
            let diagnostic = Diagnostic::error("import-version", message)
                .help("open it once in a program that has MaterialX 1.39, and save it");
            findings.say(&place, diagnostic);
            false
        }
    }
}
