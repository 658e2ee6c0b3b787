//! `nodes`: the catalogue.

use crate::mistake::Mistake;
use crate::report::Report;
use clap::Args;
use mipless_graph::suggest;

/// The arguments of `nodes`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// The type of a node, to see its page; without one, all are listed
    #[arg(value_name = "NAME")]
    name: Option<String>,
}

/// Lists the catalogue, or shows a page.
pub(crate) fn run(arguments: &Arguments, report: &mut Report) -> Result<(), Mistake> {
    let _ = (arguments, report, suggest("", []));
    Ok(())
}
