//! `check`: diagnostics, then the statistics of every signal.

use crate::load;
use crate::mistake::Mistake;
use crate::report::Report;
use clap::Args;
use mipless_graph::CheckOptions;
use serde_json::Value;
use std::path::PathBuf;

/// The arguments of `check`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// Graphs, JSON files; `-` is standard input
    #[arg(value_name = "GRAPH", required = true)]
    graphs: Vec<PathBuf>,
}

/// Checks every graph.
#[expect(clippy::unnecessary_wraps, reason = "the verbs share a signature")]
pub(crate) fn run(arguments: &Arguments, report: &mut Report) -> Result<(), Mistake> {
    let several = arguments.graphs.len() > 1;
    let mut signals = Vec::new();
    for path in &arguments.graphs {
        let texture = match load::load(path, &CheckOptions::default(), report) {
            Ok(texture) => texture,
            Err(mistake) => {
                report.mistake(&mistake);
                continue;
            }
        };
        if several {
            report.print(format_args!("{}\n", path.display()));
        }
        if report.is_json() {
            if let Value::Array(mut found) = texture.checked().signals_json() {
                for signal in found.iter_mut().filter_map(Value::as_object_mut) {
                    signal.insert("file".to_owned(), path.display().to_string().into());
                }
                signals.extend(found);
            }
        } else {
            report.print(texture.checked().report());
        }
    }
    report.result("signals", signals);
    Ok(())
}
