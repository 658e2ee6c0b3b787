//! `export`: a graph as a document of another tool.

use crate::load;
use crate::mistake::Mistake;
use crate::report::Report;
use crate::sources::Sources;
use clap::Args;
use mipless::{Diagnostic, Severity};
use mipless_graph::CheckOptions;
use mipless_import::export;
use mipless_runtime::image_file::write_whole;
use std::path::PathBuf;

/// The arguments of `export`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// The graph
    #[arg(value_name = "GRAPH")]
    graph: PathBuf,
    /// The MaterialX document to write (.mtlx) [default: standard output]
    #[arg(short, long, value_name = "FILE.mtlx")]
    out: Option<PathBuf>,
}

/// Writes the document.
pub(crate) fn run(arguments: &Arguments, report: &mut Report) -> Result<(), Mistake> {
    let path = &arguments.graph;
    if let Some(out) = &arguments.out {
        if out.extension().is_none_or(|extension| extension != "mtlx") {
            let message = format!("{} is of no kind that is written", out.display());
            return Err(Mistake::usage("usage", message).help("name a .mtlx file"));
        }
        let mut read = Sources::default();
        read.add(path);
        read.guard(out)?;
    }
    let texture = load::load(path, &CheckOptions::default(), report)?;
    let strict = report.importing().strict;
    let exported = export(texture.checked().graph(), &mipless::specs());
    let (refused, notes): (Vec<Diagnostic>, Vec<Diagnostic>) = (exported.diagnostics.into_iter())
        .map(|diagnostic| match strict {
            true => Diagnostic {
                severity: Severity::Error,
                ..diagnostic
            },
            false => diagnostic,
        })
        .partition(Diagnostic::is_error);
    let file = path.display().to_string();
    for note in &notes {
        report.diagnostic(Some(&file), note);
    }
    let (Some(text), true) = (exported.text, refused.is_empty()) else {
        return Err(Mistake::graph(path, refused));
    };
    match &arguments.out {
        Some(out) => {
            write_whole(out, text.as_bytes()).map_err(|error| {
                Mistake::usage("unwritable-file", format!("{}: {error}", out.display()))
            })?;
            report.result("files", vec![out.display().to_string()]);
        }
        None => report.print(&text),
    }
    Ok(())
}
