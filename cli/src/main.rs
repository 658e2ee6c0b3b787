//! The command `mipless`: textures that filter themselves, from JSON graphs.
//!
//! Each verb is a module of its own with its arguments and a function `run`. What a verb finds out
//! goes into a [`report::Report`], which knows how it is shown; what stops it is a
//! [`mistake::Mistake`].

mod bake;
mod check;
mod compare;
mod compile;
mod completions;
mod export;
mod foreign;
mod forms;
mod import;
mod importing;
mod load;
mod mistake;
mod new;
mod nodes;
mod plan;
mod progress;
mod render;
mod report;
mod scene;
mod schema;
mod serve;
mod sources;
mod strips;
mod trade;
mod value;

use clap::{CommandFactory, Parser, Subcommand};
use report::Report;
use std::path::PathBuf;
use std::process::ExitCode;

/// Procedural textures that filter themselves, from JSON node graphs.
///
/// Exit status: 0 done (warnings allowed); 1 a graph has errors or is not JSON; 2 wrong usage, a
/// missing or unwritable file, or a bad --set.
#[derive(Debug, Parser)]
#[command(
    name = "mipless",
    version,
    propagate_version = true,
    arg_required_else_help = true
)]
struct Cli {
    /// Print the diagnostics and the results as one JSON object on standard output
    #[arg(long, global = true)]
    json: bool,

    /// Refuse the pictures that graphs name outside of this folder, through symbolic links too
    /// [default: any file may be named]
    #[arg(long, global = true, value_name = "DIR")]
    root: Option<PathBuf>,

    #[command(flatten)]
    importing: foreign::Arguments,

    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Evaluate a graph to an image file
    Render(render::Arguments),
    /// Set point sampling, mipless and the truth side by side, each with its error
    Compare(compare::Arguments),
    /// Check graphs, and explain the statistics of every signal
    Check(check::Arguments),
    /// Compile graphs to shaders
    Compile(compile::Arguments),
    /// Measure error against cost for every method on a graph
    Trade(trade::Arguments),
    /// Read a document of another tool (.mtlx, .ptex, .gltf) and write it as a graph
    Import(import::Arguments),
    /// Write a graph as a MaterialX document (.mtlx)
    Export(export::Arguments),
    /// List the catalogue of nodes, or show the page of one
    Nodes(nodes::Arguments),
    /// Write a small commented graph to start from
    New(new::Arguments),
    /// Edit and evaluate graphs for another program, by JSON-RPC 2.0 on standard input and output
    Serve(serve::Arguments),
    /// Print the JSON Schema of graphs
    Schema,
    /// Print a script that completes the command line
    Completions(completions::Arguments),
}

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return report::usage(&error),
    };
    let mut report = Report::new(cli.json, cli.root, cli.importing);
    let result = match &cli.verb {
        Verb::Render(arguments) => render::run(arguments, &mut report),
        Verb::Compare(arguments) => compare::run(arguments, &mut report),
        Verb::Check(arguments) => check::run(arguments, &mut report),
        Verb::Compile(arguments) => compile::run(arguments, &mut report),
        Verb::Trade(arguments) => trade::run(arguments, &mut report),
        Verb::Import(arguments) => import::run(arguments, &mut report),
        Verb::Export(arguments) => export::run(arguments, &mut report),
        Verb::Nodes(arguments) => nodes::run(arguments, &mut report),
        Verb::New(arguments) => new::run(arguments, &mut report),
        Verb::Serve(arguments) => serve::run(arguments, &mut report),
        Verb::Schema => schema::run(&mut report),
        Verb::Completions(arguments) => completions::run(arguments, Cli::command(), &mut report),
    };
    if let Err(mistake) = result {
        report.mistake(&mistake);
    }
    report.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }
}
