//! The names of pictures, by patterns: `{graph}`, `{output}`, `{tile}` and `{level}` stand for names.

use crate::load::folder_of;
use crate::mistake::Mistake;
use crate::scene::writable;
use crate::sources::{Sources, place};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// What stands for what.
const WORDS: [&str; 4] = ["{graph}", "{output}", "{tile}", "{level}"];

/// What a picture shows.
pub(super) struct Name<'a> {
    /// The graph's name.
    pub(super) graph: &'a str,
    /// The output's.
    pub(super) output: &'a str,
    /// The tile, if it is one.
    pub(super) tile: Option<[[u32; 2]; 2]>,
    /// The level of its mip chain; 0 is the largest.
    pub(super) level: u32,
}

/// The files that have a picture already, by their places without links.
#[derive(Debug, Default)]
pub(super) struct Names(BTreeSet<PathBuf>);

/// Whether a name stands for several.
pub(super) fn is_pattern(path: &Path) -> bool {
    let text = path.to_string_lossy();
    WORDS.iter().any(|word| text.contains(word))
}

/// Refuses a name that several graphs would have.
pub(super) fn needs_graph(path: &Path, graphs: usize) -> Result<(), Mistake> {
    if graphs > 1 && !path.to_string_lossy().contains("{graph}") {
        let message = format!("{} graphs would all write {}", graphs, path.display());
        return Err(
            Mistake::usage("same-name", message).help("put `{graph}` into the name: {graph}.png")
        );
    }
    Ok(())
}

impl Names {
    /// The file of a picture; its folder is made where its name is the pattern's.
    pub(super) fn take(
        &mut self,
        pattern: &Path,
        name: &Name<'_>,
        read: &Sources,
    ) -> Result<PathBuf, Mistake> {
        let tile = name.tile.map_or("0_0".to_owned(), |[[column, row], _]| {
            format!("{column}_{row}")
        });
        // A name of a graph is any text, and no path.
        let plain = |text: &str| text.replace(['/', '\\', ':', '\0'], "_");
        let mut text = pattern.to_string_lossy().into_owned();
        let words = [
            plain(name.graph),
            plain(name.output),
            tile,
            name.level.to_string(),
        ];
        for (word, of) in WORDS.iter().zip(&words) {
            text = text.replace(word, of);
        }
        let path = PathBuf::from(text);
        let folder = folder_of(&path);
        if is_pattern(folder_of(pattern)) {
            fs::create_dir_all(folder).map_err(|error| {
                let message = format!("{}: {error}", folder.display());
                Mistake::usage("unwritable-file", message)
            })?;
        }
        writable(&path)?;
        read.guard(&path)?;
        if !self.0.insert(place(&path)) {
            let message = format!("two pictures would both be {}", path.display());
            return Err(Mistake::usage("same-name", message)
                .help("put `{graph}` or `{output}` into the name: {graph}_{output}.png"));
        }
        Ok(path)
    }
}
