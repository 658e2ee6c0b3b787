//! `nodes`: the catalogue.

use crate::mistake::Mistake;
use crate::report::Report;
use clap::Args;
use mipless::NodeDef;
use mipless_graph::suggest;
use serde_json::Value;
use std::fmt::Write;

/// The arguments of `nodes`.
#[derive(Args, Debug)]
pub(crate) struct Arguments {
    /// The type of a node, to see its page; without one, all are listed
    #[arg(value_name = "NAME")]
    name: Option<String>,
}

/// Lists the catalogue, or shows a page.
pub(crate) fn run(arguments: &Arguments, report: &mut Report) -> Result<(), Mistake> {
    let catalogue = mipless::catalogue();
    let chosen = match &arguments.name {
        None => {
            report.print(list(catalogue));
            catalogue
        }
        Some(name) => {
            let definition = find(catalogue, name)?;
            report.print(mipless_nodes::page(definition));
            std::slice::from_ref(definition)
        }
    };
    if report.is_json()
        && let Value::Object(members) = mipless_nodes::describe(chosen)
    {
        for (key, value) in members {
            report.result(&key, value);
        }
    }
    Ok(())
}

/// The catalogue by category.
fn list(catalogue: &[NodeDef]) -> String {
    let width = catalogue
        .iter()
        .map(|def| def.spec.name.len())
        .max()
        .unwrap_or(0);
    let mut categories: Vec<_> = catalogue.iter().map(|def| def.spec.category).collect();
    categories.sort();
    categories.dedup();
    let mut text = String::new();
    for (index, category) in categories.iter().enumerate() {
        let gap = if index == 0 { "" } else { "\n" };
        writeln!(text, "{gap}{}", category.name()).expect("a string takes everything");
        for spec in catalogue
            .iter()
            .map(|def| def.spec)
            .filter(|s| s.category == *category)
        {
            let (name, summary) = (spec.name, spec.summary);
            writeln!(text, "  {name:width$}  {summary}").expect("a string takes everything");
        }
    }
    text
}

/// The node type of that name; others' names for it are suggested.
fn find<'a>(catalogue: &'a [NodeDef], name: &str) -> Result<&'a NodeDef, Mistake> {
    if let Some(definition) = catalogue.iter().find(|def| def.spec.name == name) {
        return Ok(definition);
    }
    let known =
        |def: &'a NodeDef| std::iter::once(def.spec.name).chain(def.spec.aliases.iter().copied());
    let near = suggest(name, catalogue.iter().flat_map(known));
    let owner = near.and_then(|near| catalogue.iter().find(|def| known(def).any(|n| n == near)));
    let help = match (near, owner) {
        (Some(near), Some(owner)) if near != owner.spec.name => {
            format!(
                "did you mean `{}`, also known as `{near}`?",
                owner.spec.name
            )
        }
        (Some(near), _) => format!("did you mean `{near}`?"),
        _ => "`mipless nodes` lists all".to_owned(),
    };
    Err(Mistake::usage(
        "unknown-node-type",
        format!("there is no node type `{name}`"),
    )
    .help(help))
}
