//! `compile`: shaders and what a host needs to know of them.

use crate::forms::{self, FormName, TablesName};
use crate::load::{self, allows_sampling};
use crate::mistake::Mistake;
use crate::report::Report;
use crate::sources::Sources;
use crate::value;
use clap::{Args, ValueEnum};
use mipless::form::Form;
use mipless::target::{Manifest, Range, Target, TranslateError};
use mipless::wgsl::{self, Entry, TABLE_WIDTH, TableForm};
use mipless::{Diagnostic, Method, Options, PixelFilter, Texture};
use mipless_runtime::image_file::write_all;
use mipless_runtime::lit;
use serde_json::{Map, Value};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The arguments of `compile`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Graphs, JSON files; `-` is standard input
    #[arg(value_name = "GRAPH", required = true)]
    graphs: Vec<PathBuf>,

    /// The folder for the shaders, tables and manifests; it is made if it does not exist
    #[arg(short, long, value_name = "DIR")]
    out: PathBuf,

    /// The shading languages [default: wgsl, or none beside forms]
    #[arg(long, value_enum, value_delimiter = ',')]
    target: Vec<TargetName>,

    /// Files for hosts: the function, and what calls it there
    #[arg(long, value_enum, value_delimiter = ',')]
    form: Vec<FormName>,

    /// auto, point, naive, ensemble, local, quad, split:4|7|16 or supersample:N
    #[arg(long, default_value = "auto")]
    method: Method,

    /// The entry point that calls the texture's function [default: none, or fragment where a target
    /// cannot do without]
    #[arg(long, value_enum)]
    entry: Option<EntryName>,

    /// The group of all bindings
    #[arg(long, value_name = "N", default_value_t = 0)]
    group: u32,

    /// The number of the first binding; tables are three behind it
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=HIGHEST_BINDING))]
    binding: u32,

    /// Where tables are read from: a buffer, a texture of one f32 a texel, or such a texture as the function's
    /// first argument; hosts without buffers have a texture anyway
    #[arg(long, value_enum, default_value = "storage")]
    tables: TablesName,

    /// Declare no `Footprint` and `Position`, so that several textures stand in one module (WGSL only)
    #[arg(long)]
    shared_footprint: bool,

    /// Of a graph with a surface: functions beside the texture's that shade it by a light and by a sky;
    /// its outputs are then what they take
    #[arg(long)]
    shade: bool,

    /// The filter over which a pixel is averaged; deviation in pixels
    #[arg(long, value_name = "gaussian:SD|box", default_value = "gaussian:0.5",
        value_parser = value::pixel_filter)]
    pixel_filter: PixelFilter,
}

/// Metal and GLSL number their buffers in a byte, of which lengths of arrays take one more.
const HIGHEST_BINDING: i64 = 250;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum TargetName {
    Wgsl,
    Spirv,
    Glsl,
    GlslEs,
    Hlsl,
    Msl,
}

impl From<TargetName> for Target {
    fn from(name: TargetName) -> Self {
        match name {
            TargetName::Wgsl => Self::Wgsl,
            TargetName::Spirv => Self::Spirv,
            TargetName::Glsl => Self::Glsl,
            TargetName::GlslEs => Self::GlslEs,
            TargetName::Hlsl => Self::Hlsl,
            TargetName::Msl => Self::Msl,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum EntryName {
    Fragment,
    Compute,
    None,
}

/// Compiles every graph; the files of a graph are written together or not at all.
pub(crate) fn run(arguments: &Arguments, report: &mut Report) -> Result<(), Mistake> {
    let job = Job::new(arguments)?;
    // Who writes what, so that two graphs of one name do not overwrite each other.
    let mut owners = BTreeMap::new();
    let mut compiled = Vec::new();
    for path in &arguments.graphs {
        match job.graph(path, &mut owners, report) {
            Ok(result) => compiled.push(result),
            Err(mistake) => report.mistake(&mistake),
        }
    }
    report.result("compiled", compiled);
    Ok(())
}

/// The most letters of a file's name that come from the graph's, which are ASCII.
const LONGEST_STEM: usize = 200;

/// What is done to every graph.
struct Job<'a> {
    arguments: &'a Arguments,
    targets: Vec<Target>,
    forms: Vec<Form>,
    entry: Entry,
    /// The graphs and what they name, which no output may replace.
    read: RefCell<Sources>,
}

impl<'a> Job<'a> {
    fn new(arguments: &'a Arguments) -> Result<Self, Mistake> {
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
        let mut read = Sources::default();
        arguments.graphs.iter().for_each(|path| read.add(path));
        Ok(Self {
            arguments,
            targets,
            forms,
            entry,
            read: RefCell::new(read),
        })
    }

    fn graph(
        &self,
        path: &Path,
        owners: &mut BTreeMap<PathBuf, PathBuf>,
        report: &mut Report,
    ) -> Result<Value, Mistake> {
        let Arguments {
            method,
            pixel_filter,
            out,
            ..
        } = self.arguments;
        let texture = load::load(path, &allows_sampling(*method), report)?;
        self.read.borrow_mut().add_graph(path, &texture);
        let texture = if self.arguments.shade {
            self.shaded(path, &texture)?
        } else {
            texture
        };
        let options = Options {
            method: *method,
            filter: *pixel_filter,
            ..Options::default()
        };
        let program = texture.compile(&options);
        let asked = wgsl::Options {
            entry: self.entry,
            group: self.arguments.group,
            binding: self.arguments.binding,
            shared_footprint: self.arguments.shared_footprint,
            tables: self.arguments.tables.into(),
        };
        let emission = forms::emission(&self.targets, &self.forms, asked);
        let emit = if self.arguments.shade {
            wgsl::emit_shaded
        } else {
            wgsl::emit
        };
        let shader = emit(&program, &emission);
        // Folders take names of 255 bytes.
        let name = &shader.function[..shader.function.len().min(LONGEST_STEM)];

        let mut files = Vec::new();
        let mut listed = Map::new();
        let mut file = |key: &str, extension: &str, bytes: Vec<u8>| {
            let file = format!("{name}.{extension}");
            listed.insert(key.to_owned(), file.clone().into());
            files.push((out.join(file), bytes));
        };
        let invalid = |error: TranslateError| {
            let message = format!("the shader is not valid: {error}");
            let diagnostic = Diagnostic::error("invalid-shader", message)
                .help("this is a bug of the compiler; please report it with the graph");
            Mistake::graph(path, vec![diagnostic])
        };
        let range = |name: &str| -> Range {
            let parameter = texture.parameters().iter().find(|p| p.name == name);
            parameter.map_or((None, None), |p| (p.min, p.max))
        };
        let wanted = (&self.targets[..], &self.forms[..]);
        let emit = |options: &wgsl::Options| emit(&program, options);
        let written = forms::files(wanted, emit, (&shader, emission), name, range);
        for (key, extension, bytes) in written.map_err(invalid)? {
            file(&key, extension, bytes);
        }
        let manifest = Manifest::new(&shader, range);
        let mut manifest = serde_json::from_str(&manifest.to_json()).unwrap_or(Value::Null);
        manifest["method"] = method.to_string().into();
        manifest["pixel_filter"] = value::pixel_filter_name(*pixel_filter).into();
        if let Some(tables) = &shader.tables
            && listed.contains_key("tables")
        {
            let is_buffer = emission.tables == TableForm::Storage && self.forms.is_empty();
            if !is_buffer || self.targets.contains(&Target::GlslEs) {
                let texture = serde_json::json!({
                    "width": TABLE_WIDTH, "height": tables.rows(), "format": "r32float",
                });
                manifest["tables_texture"] = texture;
            }
        }
        if !shader.shading.is_empty() {
            manifest["shading"] = shader.shading.clone().into();
        }
        manifest["files"] = listed.into();
        files.push((
            out.join(format!("{name}.json")),
            format!("{manifest:#}\n").into_bytes(),
        ));

        self.claim(path, &files, owners)?;
        let unwritable = |error: &dyn std::fmt::Display| {
            Mistake::usage("unwritable-file", format!("{}: {error}", out.display()))
        };
        fs::create_dir_all(out).map_err(|error| unwritable(&error))?;
        write_all(&files).map_err(|error| unwritable(&error))?;

        let written: Vec<String> = files.iter().map(|(f, _)| f.display().to_string()).collect();
        report.note(format_args!("{}: {}", path.display(), written.join(", ")));
        Ok(serde_json::json!({
            "graph": path.display().to_string(),
            "files": written,
            "manifest": manifest,
        }))
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

    /// Refuses to write over a graph, or over what another graph of this run has written.
    fn claim(
        &self,
        path: &Path,
        files: &[(PathBuf, Vec<u8>)],
        owners: &mut BTreeMap<PathBuf, PathBuf>,
    ) -> Result<(), Mistake> {
        for (file, _) in files {
            let read = self.read.borrow().guard(file);
            read.map_err(|mistake| mistake.help("choose another folder with `--out`"))?;
            if let Some(owner) = owners.get(file) {
                let message = format!(
                    "{} and {} would both write {}",
                    owner.display(),
                    path.display(),
                    file.display()
                );
                return Err(
                    Mistake::usage("same-name", message).help("give the graphs different names")
                );
            }
        }
        owners.extend(
            files
                .iter()
                .map(|(file, _)| (file.clone(), path.to_path_buf())),
        );
        Ok(())
    }
}
