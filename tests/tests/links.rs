//! What documents link to, show and quote is there.

use mipless_tests::case::load;
use mipless_tests::markdown::Markdown;
use mipless_tests::root;
use std::fs;
use std::path::{Path, PathBuf};

/// All documents below a folder.
fn below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a readable folder") {
        let path = entry.expect("a readable entry").path();
        if path.is_dir() {
            found.extend(below(&path));
        } else if path.extension().is_some_and(|extension| extension == "md") {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn documents() -> Vec<Markdown> {
    let outside = [
        "README.md",
        "ARCHITECTURE.md",
        "CONTRIBUTING.md",
        "BENCHMARKS.md",
        "CHANGELOG.md",
    ];
    let outside = outside.iter().map(|name| root().join(name));
    let all = outside.chain(below(&root().join("docs")));
    all.map(|path| Markdown::read(&path)).collect()
}

/// What is wrong with a link of a document.
fn broken(document: &Markdown, link: &str) -> Option<String> {
    let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
    let folder = document.path.parent().expect("a folder");
    let target = if file.is_empty() {
        document.path.clone()
    } else {
        folder.join(file)
    };
    if !target.exists() {
        return Some(format!("{}: no {link}", document.path.display()));
    }
    let is_document = target
        .extension()
        .is_some_and(|extension| extension == "md");
    if anchor.is_empty() || !is_document {
        return None;
    }
    let anchors = Markdown::read(&target).anchors();
    (!anchors.iter().any(|held| held == anchor))
        .then(|| format!("{}: no heading {link}", document.path.display()))
}

#[test]
fn links_and_pictures_are_there() {
    let mut mistakes = Vec::new();
    for document in documents() {
        let targets = document.links().into_iter().chain(document.includes());
        mistakes.extend(targets.filter_map(|link| broken(&document, &link)));
    }
    assert!(mistakes.is_empty(), "{}", mistakes.join("\n"));
}

/// mdBook copies what lies below its sources and nothing else, and shows what its contents list.
#[test]
fn the_book_is_whole_in_itself() {
    let sources = root().join("docs/book/src");
    let contents = Markdown::read(&sources.join("SUMMARY.md")).links();
    let mut mistakes = Vec::new();
    for path in below(&sources) {
        let name = path.strip_prefix(&sources).expect("it lies there");
        let listed = name.to_str().is_some_and(|name| {
            name == "SUMMARY.md" || contents.iter().any(|listed| listed == name)
        });
        if !listed {
            mistakes.push(format!("{} is in no table of contents", name.display()));
        }
        let document = Markdown::read(&path);
        let folder = path.parent().expect("a folder").to_owned();
        for link in document.links() {
            let file = folder.join(link.split('#').next().unwrap_or_default());
            let inside = file
                .canonicalize()
                .is_ok_and(|file| file.starts_with(sources.canonicalize().expect("the book")));
            if !inside {
                mistakes.push(format!("{}: {link} leaves the book", name.display()));
            }
        }
    }
    assert!(mistakes.is_empty(), "{}", mistakes.join("\n"));
}

#[test]
fn every_graph_of_the_book_has_a_place_in_the_gallery() {
    let gallery = Markdown::read(&root().join("docs/book/src/gallery.md"));
    for case in mipless_tests::case::files() {
        let picture = format!("images/{}.png", case.name);
        let graph = format!("../../../graphs/{}.json", case.name);
        assert!(gallery.links().contains(&picture), "no {picture}");
        assert!(gallery.includes().contains(&graph), "no {graph}");
    }
}

/// What is quoted as a whole graph is one; those that are shown for their mistakes are `jsonc`.
#[test]
fn quoted_graphs_load() {
    for document in documents() {
        for text in document.fenced("json") {
            if !text.contains("\"version\"") || !text.contains("\"outputs\"") {
                continue;
            }
            if let Err(mistakes) = load(&text) {
                let mistakes: Vec<String> = mistakes.iter().map(ToString::to_string).collect();
                let path = document.path.display();
                panic!("{path}:\n{}\n{text}", mistakes.join("\n"));
            }
        }
    }
}
