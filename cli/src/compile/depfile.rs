//! Rules for make and ninja: what depends on what.

use crate::mistake::Mistake;
use mipless_runtime::image_file::write_whole;
use std::fs;
use std::path::{Path, PathBuf};

/// The rule of a graph: what was made of it depends on it and on what it reads.
pub(super) fn rule(files: &[PathBuf], graph: &Path, reads: &[PathBuf]) -> String {
    let joined = |paths: &mut dyn Iterator<Item = &Path>| {
        let escaped: Vec<String> = paths.map(escaped).collect();
        escaped.join(" ")
    };
    let made = joined(&mut files.iter().map(PathBuf::as_path));
    let reads = reads.iter().map(PathBuf::as_path);
    let needed = joined(&mut std::iter::once(graph).chain(reads));
    format!("{made}: {needed}\n")
}

/// A path as make and ninja both read it.
fn escaped(path: &Path) -> String {
    let mut text = String::new();
    for letter in path.to_string_lossy().chars() {
        match letter {
            ' ' | '#' => text.push('\\'),
            '$' => text.push('$'),
            _ => {}
        }
        text.push(letter);
    }
    text
}

/// Writes the rules, if they are not there already.
pub(super) fn write(path: &Path, rules: &[String]) -> Result<(), Mistake> {
    let text = rules.concat();
    if fs::read_to_string(path).is_ok_and(|held| held == text) {
        return Ok(());
    }
    write_whole(path, text.as_bytes()).map_err(|error| {
        let message = format!("{}: cannot be written: {error}", path.display());
        Mistake::usage("unwritable-file", message)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_with_spaces_are_one_name() {
        let path = |name: &str| PathBuf::from(name);
        let made = [path("out/a.wgsl"), path("out/a.json")];
        let rule = rule(&made, &path("my graphs/a#1.json"), &[path("$x.png")]);
        assert_eq!(
            rule,
            "out/a.wgsl out/a.json: my\\ graphs/a\\#1.json $$x.png\n"
        );
    }
}
