//! What is done to every graph.

use super::output::{Done, Folder, Made};
use super::{Arguments, EntryName};
use crate::forms;
use crate::load::{self, allows_sampling};
use crate::mistake::Mistake;
use crate::report::Report;
use mipless::artifact::{Artifact, Recipe, target_key};
use mipless::form::Form;
use mipless::manifest::{COMPILER, ManifestSource, sha256};
use mipless::target::{Target, TranslateError};
use mipless::wgsl::{self, Entry};
use mipless::{Diagnostic, Options, Texture, name_of_file};
use mipless_import::Format;
use mipless_runtime::lit;
use std::path::Path;

/// What is done to every graph.
pub(super) struct Job<'a> {
    arguments: &'a Arguments,
    targets: Vec<Target>,
    forms: Vec<Form>,
    emission: wgsl::Options,
}

impl<'a> Job<'a> {
    pub(super) fn new(arguments: &'a Arguments) -> Result<Self, Mistake> {
        let mut targets: Vec<Target> = arguments.target.iter().map(|&name| name.into()).collect();
        targets.sort();
        targets.dedup();
        let mut forms: Vec<Form> = arguments.form.iter().map(|&name| name.into()).collect();
        forms.sort();
        forms.dedup();
        if targets.is_empty() && forms.is_empty() {
            targets.push(Target::Wgsl);
        }
        let needs = targets.iter().find(|target| target.needs_entry());
        let entry = match (arguments.entry, needs) {
            (Some(EntryName::None), Some(&target)) => {
                return Err(
                    Mistake::usage("needs-entry", TranslateError::NeedsEntry(target))
                        .help("choose `--entry fragment` or `--entry compute`"),
                );
            }
            (Some(EntryName::Fragment), _) | (None, Some(_)) => Entry::Fragment,
            (Some(EntryName::Compute), _) => Entry::Compute,
            (Some(EntryName::None) | None, None) => Entry::None,
        };
        if entry == Entry::Compute && targets.contains(&Target::GlslEs) {
            let lacks = TranslateError::Lacks(Target::GlslEs, "compute shaders");
            return Err(Mistake::usage("no-compute", lacks).help("choose `--entry fragment`"));
        }
        if arguments.shared_footprint
            && let Some(target) = targets.iter().find(|target| **target != Target::Wgsl)
        {
            let message = format!(
                "`--shared-footprint` leaves a struct undeclared, so that there is no {}",
                target.name()
            );
            return Err(Mistake::usage("shared-footprint", message).help("choose `--target wgsl`"));
        }
        if arguments.out.exists() && !arguments.out.is_dir() {
            let message = format!("{}: it is no folder", arguments.out.display());
            return Err(Mistake::usage("unwritable-file", message));
        }
        Ok(Self {
            arguments,
            targets,
            forms,
            emission: wgsl::Options {
                entry,
                group: arguments.group,
                binding: arguments.binding,
                shared_footprint: arguments.shared_footprint,
                tables: arguments.tables.into(),
            },
        })
    }

    /// Compiles a graph, unless the folder holds what would come of it.
    pub(super) fn graph(
        &self,
        path: &Path,
        folder: &Folder,
        report: &mut Report,
    ) -> Result<Done, Mistake> {
        let text = load::read(path)?;
        let key = self.key(path, &text, report);
        if let Some(key) = &key
            && !self.arguments.force
        {
            let files = load::files(path, report)?;
            let targets = self.targets.iter().map(|target| target.name());
            let forms = self.forms.iter().map(|form| form.name());
            let targets: Vec<&str> = targets.chain(forms).collect();
            let known = folder.unchanged(key, &targets, &target_key(&self.emission), &*files);
            if let Some(manifest) = known {
                let read = manifest["source"]["files"].as_array().into_iter().flatten();
                let names = read.filter_map(|file| file["name"].as_str());
                let reads = names.map(|name| load::folder_of(path).join(name));
                return Ok(Done {
                    reads: reads.collect(),
                    made: Made::Unchanged(Box::new(manifest.clone())),
                });
            }
        }
        let digest = sha256(text.as_bytes());
        let options = allows_sampling(self.arguments.method);
        let (texture, files) = load::load_recorded(path, text, &options, report)?;
        let texture = self.arguments.bake.apply(path, texture, &options)?;
        let texture = if self.arguments.shade {
            self.shaded(path, &texture)?
        } else {
            texture
        };
        let files = files.read();
        let reads = files
            .iter()
            .map(|file| load::folder_of(path).join(&file.name));
        let reads = reads.collect();
        let source = key.map(|key| ManifestSource {
            file: path
                .file_name()
                .map_or(String::new(), |name| name.to_string_lossy().into_owned()),
            sha256: digest,
            files,
            key,
        });
        let recipe = Recipe {
            options: Options {
                method: self.arguments.method,
                filter: self.arguments.pixel_filter,
                ..Options::default()
            },
            emission: self.emission,
            targets: self.targets.clone(),
            forms: self.forms.clone(),
            is_shaded: self.arguments.shade,
            source,
        };
        let mut artifact = Artifact::new(&texture, &recipe).map_err(|error| {
            let message = format!("the shader is not valid: {error}");
            let diagnostic = Diagnostic::error("invalid-shader", message)
                .help("this is a bug of the compiler; please report it with the graph");
            Mistake::graph(path, vec![diagnostic])
        })?;
        forms::push_picture(&mut artifact, &self.forms);
        Ok(Done {
            reads,
            made: Made::Files(Box::new(artifact)),
        })
    }

    /// A digest of all that shapes the function and its tables beside the files that the graph reads.
    /// `None` where that is not known: of standard input, and of a document that may need others of an
    /// installation.
    fn key(&self, path: &Path, text: &str, report: &Report) -> Option<String> {
        let importing = report.importing();
        let is_foreign = Format::of(path).is_some();
        let library = importing.library.is_some()
            || std::env::var_os("MATERIALX_SEARCH_PATH").is_some_and(|folders| !folders.is_empty());
        if path == Path::new("-") || is_foreign && library {
            return None;
        }
        let foreign =
            is_foreign.then_some((&importing.material, importing.strict, importing.partial));
        let said = format!(
            "{COMPILER}\n{}\n{}\n{}\n{}\n{}\n{:?}\n{foreign:?}",
            name_of_file(path),
            sha256(text.as_bytes()),
            self.arguments.method,
            self.arguments.pixel_filter,
            self.arguments.shade,
            self.arguments.bake.constants,
        );
        Some(sha256(said.as_bytes()))
    }

    /// What the functions that shade take of the graph's material.
    fn shaded(&self, path: &Path, texture: &Texture) -> Result<Texture, Mistake> {
        let parts = [&lit::parts()[..], &["mean_opacity", "displacement"]].concat();
        let Some(material) = texture.material(&parts, &allows_sampling(self.arguments.method))
        else {
            let message = format!(
                "{}: `--shade` shades a material, and the graph has none",
                path.display()
            );
            return Err(Mistake::usage("no-surface", message).help("end the graph in a `surface`"));
        };
        material.map_err(|wrong| Mistake::graph(path, wrong))
    }
}
