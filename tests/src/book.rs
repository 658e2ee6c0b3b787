//! The parts of the book that are generated: the pages of the nodes, their index, and their lines
//! of the table of contents.

use crate::thumbnail::{FAR, SIDE, look};
use mipless::NodeDef;
use mipless_graph::Category;
use std::fmt::Write as _;

/// Where the pages of the nodes lie.
pub const PAGES: &str = "docs/book/src/nodes";

/// Around the lines of the table of contents that are generated.
pub const MARKERS: [&str; 2] = ["<!-- nodes, generated -->", "<!-- end of the nodes -->"];

/// The names of a node's thumbnails, near and far, below [`PAGES`].
pub fn thumbnails(node: &str) -> [String; 2] {
    ["near", "far"].map(|distance| format!("thumbnails/{node}_{distance}.png"))
}

/// The page of a node: what the catalogue says, with the two pictures under its summary.
///
/// # Panics
/// If the page has no summary.
pub fn page(def: &NodeDef) -> String {
    let spec = def.spec;
    let page = mipless_nodes::page(def);
    let head = format!("# {}\n\n{}\n\n", spec.name, spec.summary);
    let rest = page
        .strip_prefix(&head)
        .expect("a page begins with a summary");
    let [near, far] = thumbnails(spec.name);
    let look = look(spec.name);
    let side = look.window[2];
    let mut caption = format!(
        "The example, {side} uv wide and {} uv wide, {SIDE} pixels each",
        FAR * side
    );
    let range = |[low, high]: [f32; 2]| format!("{low} to {high}");
    let [close, wide] = look.ranges.map(range);
    if close != wide {
        caption += &format!("; from black to white {close} near, {wide} far");
    } else if close != "0 to 1" {
        caption += &format!("; from black to white {close}");
    }
    let name = spec.name;
    format!(
        "{head}![{name}, near]({near}) ![{name}, far]({far})\n\n*{}.*\n\n{rest}",
        caption.replace('-', "−")
    )
}

/// The nodes of the catalogue by category.
fn by_category() -> Vec<(Category, Vec<&'static NodeDef>)> {
    let mut categories: Vec<(Category, Vec<&NodeDef>)> = Vec::new();
    for def in mipless::catalogue() {
        match categories.iter_mut().find(|(c, _)| *c == def.spec.category) {
            Some((_, nodes)) => nodes.push(def),
            None => categories.push((def.spec.category, vec![def])),
        }
    }
    categories
}

/// A word with a large first letter.
fn heading(word: &str) -> String {
    let mut letters = word.chars();
    let first = letters.next().map(|c| c.to_uppercase().to_string());
    first.unwrap_or_default() + letters.as_str()
}

/// The page that shows all nodes.
///
/// # Panics
/// Never: a string takes everything.
pub fn index() -> String {
    let mut text = format!(
        "# All {} nodes\n\nEach node has a page with its ports, what it computes, its statistics, how \
         accurate its filter is, and an example. The two pictures are that example near and far. \
         `mipless nodes NAME` prints a page.\n",
        mipless::catalogue().len()
    );
    for (category, nodes) in by_category() {
        writeln!(
            text,
            "\n## {}\n\n| near | far | node | |\n|---|---|---|---|",
            heading(category.name())
        )
        .expect("a string");
        for def in nodes {
            let (name, summary) = (def.spec.name, def.spec.summary);
            let [near, far] = thumbnails(name);
            writeln!(
                text,
                "| ![{name}, near]({near}) | ![{name}, far]({far}) | [{name}]({name}.md) | {summary} |"
            )
            .expect("a string");
        }
    }
    text
}

/// The table of contents with its generated lines made fresh.
///
/// # Errors
/// If it has lost a marker.
///
/// # Panics
/// Never: a string takes everything.
pub fn summary(held: &str) -> Result<String, String> {
    let [begin, end] = MARKERS;
    let lost = |marker| format!("SUMMARY.md has lost its line `{marker}`");
    let (before, rest) = held.split_once(begin).ok_or_else(|| lost(begin))?;
    let (_, after) = rest.split_once(end).ok_or_else(|| lost(end))?;
    let mut lines = String::new();
    for (category, nodes) in by_category() {
        writeln!(lines, "  - [{}]()", heading(category.name())).expect("a string");
        for def in nodes {
            let name = def.spec.name;
            writeln!(lines, "    - [{name}](nodes/{name}.md)").expect("a string");
        }
    }
    Ok(format!("{before}{begin}\n{lines}{end}{after}"))
}
