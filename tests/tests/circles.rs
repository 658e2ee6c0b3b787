//! Files of a crate import each other one way: who reads one need not read the other first.
//!
//! A file and those in the folder of its name are one module that is written in parts, so that arrows
//! between these do not count; `ir.rs` may share a type with `ir/build.rs`. Tests are no part of a
//! module.

use mipless_tests::root;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

const CRATES: [&str; 7] = [
    "graph", "codegen", "nodes", "runtime", "mipless", "cli", "tests",
];

/// A module as the names on the way from the crate's root.
type Module = Vec<String>;

/// What a file says of others: paths, and those that it exports anew, by name.
#[derive(Default)]
struct Words {
    paths: Vec<Vec<String>>,
    exports: BTreeMap<String, Vec<String>>,
}

/// The text without comments and without the tests at its end.
fn bare(text: &str) -> String {
    let text = match text.find("#[cfg(test)]\nmod tests {") {
        Some(end) => &text[..end],
        None => text,
    };
    let code = |line: &str| line.split("//").next().unwrap_or_default().to_owned();
    text.lines().map(code).collect::<Vec<_>>().join("\n")
}

/// The names of a path, without the rawness of keywords.
fn names(path: &str) -> Vec<String> {
    (path.split("::"))
        .map(|name| name.trim().trim_start_matches("r#").to_owned())
        .collect()
}

/// The paths of a tree of imports, `a::{b, c::{d, e}}`.
fn expand(tree: &str) -> Vec<String> {
    let Some((front, rest)) = tree.split_once('{') else {
        let path = tree.split(" as ").next().unwrap_or_default();
        return vec![path.trim().to_owned()];
    };
    let inner = rest.trim_end().strip_suffix('}').unwrap_or(rest);
    let (mut depth, mut start) = (0, 0);
    let mut branches = Vec::new();
    for (at, letter) in inner.char_indices() {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                branches.push(&inner[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    branches.push(&inner[start..]);
    (branches.into_iter())
        .filter(|branch| !branch.trim().is_empty())
        .flat_map(|branch| expand(branch.trim()))
        .map(|path| format!("{}{path}", front.trim()))
        .collect()
}

impl Words {
    fn of(text: &str) -> Self {
        let text = bare(text);
        let mut words = Self::default();
        for statement in text.split([';', '}']) {
            // What is before the keyword tells whether it is exported.
            let Some((before, tree)) = statement.split_once("use ") else {
                continue;
            };
            let before = before.lines().last().unwrap_or_default().trim();
            if !(before.is_empty() || before.starts_with("pub")) {
                continue;
            }
            // A tree has braces, at which the text was split.
            let start = tree.as_ptr() as usize - text.as_ptr() as usize;
            let whole = text[start..].split(';').next().unwrap_or_default();
            for path in expand(whole) {
                let path = names(&path);
                if before.starts_with("pub")
                    && let Some(name) = path.last()
                {
                    words.exports.insert(name.clone(), path.clone());
                }
                words.paths.push(path);
            }
        }
        let part = |letter: char| letter.is_alphanumeric() || "_:#".contains(letter);
        for word in text.split(|letter| !part(letter)) {
            if word.contains("::") {
                words.paths.push(names(word.trim_matches(':')));
            }
        }
        words
    }
}

/// The files of a crate, by module.
struct Files(BTreeMap<Module, Words>);

impl Files {
    fn read(folder: &Path) -> Self {
        let mut found = BTreeMap::new();
        let mut folders = vec![(folder.to_owned(), Module::new())];
        while let Some((folder, module)) = folders.pop() {
            for entry in fs::read_dir(&folder).expect("a readable folder") {
                let path = entry.expect("a readable entry").path();
                let stem = path.file_stem().expect("a name").to_string_lossy();
                let mut module = module.clone();
                if stem == "tests" {
                    continue;
                }
                if !(module.is_empty() && ["lib", "main"].contains(&&*stem)) {
                    module.push(stem.into_owned());
                }
                if path.is_dir() {
                    folders.push((path, module));
                } else if path.extension().is_some_and(|extension| extension == "rs") {
                    let text = fs::read_to_string(&path).expect("a readable file");
                    found.insert(module, Words::of(&text));
                }
            }
        }
        Self(found)
    }

    /// The file that defines what a path names in a file, if it is one of the crate.
    fn defines(&self, from: &Module, path: &[String], turns: usize) -> Option<Module> {
        let mut module = from.clone();
        let mut rest = path;
        match rest.first()?.as_str() {
            "crate" => module.clear(),
            "super" | "self" => {}
            first => {
                let mut child = from.clone();
                child.push(first.to_owned());
                if !self.0.contains_key(&child) {
                    return None;
                }
            }
        }
        while let Some((name, others)) = rest.split_first() {
            match name.as_str() {
                "crate" | "self" => {}
                "super" => {
                    module.pop();
                }
                _ => {
                    module.push(name.clone());
                    if !self.0.contains_key(&module) {
                        module.pop();
                        break;
                    }
                }
            }
            rest = others;
        }
        let exported = (rest.first()).and_then(|name| self.0.get(&module)?.exports.get(name));
        match exported {
            Some(path) if turns > 0 => self.defines(&module, path, turns - 1),
            _ => Some(module),
        }
    }

    /// Which files a file imports from.
    fn arrows(&self) -> BTreeMap<&Module, BTreeSet<Module>> {
        (self.0.iter())
            .map(|(from, words)| {
                let to = (words.paths.iter())
                    .filter_map(|path| self.defines(from, path, 4))
                    .filter(|to| !to.starts_with(from) && !from.starts_with(to))
                    .collect();
                (from, to)
            })
            .collect()
    }

    /// The shortest way around each circle that there is, one by file.
    fn circles(&self) -> Vec<String> {
        let arrows = self.arrows();
        let mut circles = BTreeMap::new();
        for &start in arrows.keys() {
            let mut ways = vec![vec![start]];
            let mut seen = BTreeSet::new();
            while let Some(way) = (!ways.is_empty()).then(|| ways.remove(0)) {
                let here = way[way.len() - 1];
                for next in arrows.get(here).into_iter().flatten() {
                    if next == start {
                        let files: BTreeSet<&Module> = way.iter().copied().collect();
                        let names: Vec<String> = way.iter().map(|m| m.join("/")).collect();
                        circles.entry(files).or_insert(names.join(" → "));
                    } else if seen.insert(next) {
                        ways.push([&way[..], &[next]].concat());
                    }
                }
            }
        }
        circles.into_values().collect()
    }
}

#[test]
fn no_two_files_import_each_other() {
    for name in CRATES {
        let circles = Files::read(&root().join(name).join("src")).circles();
        assert!(circles.is_empty(), "{name}:\n{}", circles.join("\n"));
    }
}

#[test]
fn a_circle_is_found_through_super_children_and_what_a_parent_exports() {
    let of = |files: &[(&str, &str)]| {
        let files = (files.iter()).map(|(path, text)| (names(path), Words::of(text)));
        Files(files.collect()).circles()
    };
    let direct = [("a", "use super::b::{C, d::{E}};"), ("b", "use crate::a;")];
    assert_eq!(of(&direct), ["a → b"]);
    let exported = [
        ("p", "mod x;\npub(crate) use x::X;"),
        ("p::x", "fn f() { crate::q::g() }"),
        ("q", "use super::p::X;"),
    ];
    assert_eq!(of(&exported), ["p/x → q"]);
    let one_module = [("p", "mod x;\nuse x::X;"), ("p::x", "use super::Y;")];
    assert!(of(&one_module).is_empty());
    let one_way = [
        ("a", "use super::b::B; // crate::b"),
        ("b", "// use crate::a::A;"),
    ];
    assert!(of(&one_way).is_empty());
}
