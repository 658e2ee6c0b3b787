//! `import`: a document of another tool as a graph.

use crate::load;
use crate::mistake::Mistake;
use crate::report::Report;
use crate::sources::Sources;
use clap::Args;
use mipless_graph::CheckOptions;
use mipless_import::Format;
use mipless_runtime::image_file::write_whole;
use serde_json::json;
use std::path::PathBuf;

/// The arguments of `import`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// A document: .mtlx (MaterialX), .ptex (Material Maker) or .gltf (KHR_texture_procedurals)
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// The graph to write [default: standard output]
    #[arg(short, long, value_name = "GRAPH.json")]
    out: Option<PathBuf>,
}

/// Writes the graph.
pub(crate) fn run(arguments: &Arguments, report: &mut Report) -> Result<(), Mistake> {
    let path = &arguments.file;
    if Format::of(path).is_none() {
        let message = format!("{} is of no kind that is read", path.display());
        return Err(Mistake::usage("usage", message).help("name a .mtlx, .ptex or .gltf file"));
    }
    if let Some(out) = &arguments.out {
        let mut read = Sources::default();
        read.add(path);
        read.guard(out)?;
    }
    let graph = load::graph(path, report)?;
    // A graph that is written has been checked, so that what it cannot be is said here.
    let checked = load::parse(path, &graph, &CheckOptions::default(), report);
    let text = match &checked {
        Ok(texture) => texture.document().to_text(),
        Err(_) => graph.text.clone(),
    };
    let summary = graph
        .imported
        .as_ref()
        .map(mipless_import::Imported::summary);
    match &arguments.out {
        Some(out) => {
            write_whole(out, text.as_bytes()).map_err(|error| {
                Mistake::usage("unwritable-file", format!("{}: {error}", out.display()))
            })?;
            if let Some(summary) = summary {
                report.note(format_args!("{}: {summary}", out.display()));
            }
            report.result("files", vec![out.display().to_string()]);
        }
        None => report.print(&text),
    }
    if let Some(imported) = &graph.imported {
        report.result("summary", imported.summary());
        let outputs = imported.outputs.iter().map(
            |output| json!({ "name": output.name, "source": output.source, "loads": output.loads }),
        );
        report.result("outputs", outputs.collect::<Vec<_>>());
    }
    checked.map(|_| ())
}
