//! `compile`: shaders and what a host needs to know of them.

mod depfile;
mod job;
mod output;
mod watch;

use crate::bake;
use crate::forms::{FormName, TablesName};
use crate::mistake::Mistake;
use crate::progress;
use crate::report::Report;
use crate::sources::Sources;
use crate::value;
use clap::{Args, ValueEnum};
use job::Job;
use mipless::target::Target;
use mipless::{Method, PixelFilter};
use output::{Done, Written};
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// The arguments of `compile`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Graphs, JSON files; `-` is standard input
    #[arg(value_name = "GRAPH", required = true)]
    graphs: Vec<PathBuf>,

    /// The folder for the shaders, tables and manifests; it is made if it does not exist. What is in it
    /// and would not change is not touched
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

    #[command(flatten)]
    bake: bake::Arguments,

    /// Also write a rule for make and ninja: which files each shader depends on
    #[arg(long, value_name = "FILE")]
    depfile: Option<PathBuf>,

    /// Compile graphs too whose files are what the manifest says
    #[arg(long)]
    force: bool,

    /// Go on: compile again whenever a graph, or a file that it reads, changes
    #[arg(long)]
    watch: bool,
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

/// Graphs that are compiled before the first of them is written: what they make is held in memory.
const BATCH: usize = 64;

/// Compiles every graph; the files of a graph are written together or not at all.
pub(crate) fn run(arguments: &Arguments, report: &mut Report) -> Result<(), Mistake> {
    let standard_input = arguments.graphs.iter().any(|path| path == Path::new("-"));
    if arguments.watch && standard_input {
        return Err(Mistake::usage(
            "usage",
            "`--watch` watches files, and `-` is standard input",
        )
        .help("name the file of the graph"));
    }
    let read = round(arguments, report)?;
    if arguments.watch {
        return watch::watch(arguments, read, report);
    }
    Ok(())
}

/// Compiles all graphs once; returns what was read.
fn round(arguments: &Arguments, report: &mut Report) -> Result<Vec<PathBuf>, Mistake> {
    let job = Job::new(arguments)?;
    let mut folder = output::Folder::open(&arguments.out);
    let mut sources = Sources::default();
    arguments.graphs.iter().for_each(|path| sources.add(path));
    if let Some(depfile) = &arguments.depfile {
        sources.guard(depfile)?;
    }
    let (mut compiled, mut rules) = (Vec::new(), Vec::new());
    let mut read = arguments.graphs.clone();
    let count = arguments.graphs.len() as u32;
    let finished = AtomicU32::new(0);
    for graphs in arguments.graphs.chunks(BATCH) {
        // What each says is held until all are done, so that it comes in the order of the graphs.
        let parts: Vec<Report> = graphs.iter().map(|_| report.part()).collect();
        let results: Vec<(Result<Done, Mistake>, Report)> =
            progress::watch(report, "compiling", |bar| {
                let one = |(path, mut part): (&PathBuf, Report)| {
                    let result = job.graph(path, &folder, &mut part);
                    let finished = finished.fetch_add(1, Ordering::Relaxed) + 1;
                    if let Some(progress) = bar.progress {
                        progress(finished, count);
                    }
                    (result, part)
                };
                graphs.par_iter().zip(parts).map(one).collect()
            });
        for (path, (result, part)) in graphs.iter().zip(results) {
            report.absorb(part);
            if let Ok(done) = &result {
                done.reads.iter().for_each(|file| sources.add(file));
            }
            let written = result.and_then(|done| {
                let written = folder.write(path, &done, &sources)?;
                Ok((done, written))
            });
            match written {
                Ok((done, written)) => {
                    report.note(format_args!("{}: {written}", path.display()));
                    let Written { files, .. } = &written;
                    rules.push(depfile::rule(files, path, &done.reads));
                    read.extend(done.reads);
                    compiled.push(written.to_json(path));
                }
                Err(mistake) => report.mistake(&mistake),
            }
        }
    }
    if let Some(path) = &arguments.depfile {
        // By now what the graphs read is known too.
        sources.guard(path)?;
        depfile::write(path, &rules)?;
    }
    report.result("compiled", compiled);
    Ok(read)
}
