//! What a run reads, which it never writes over.

use crate::load::folder_of;
use crate::mistake::Mistake;
use mipless::Texture;
use std::fs;
use std::path::{Path, PathBuf};

/// Files that have been read, by their places without links.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sources(Vec<PathBuf>);

impl Sources {
    /// Adds a file, if there is one.
    pub(crate) fn add(&mut self, path: &Path) {
        self.0.extend(fs::canonicalize(path).ok());
    }

    /// Adds the graph of a file, and the pictures that it names.
    pub(crate) fn add_graph(&mut self, path: &Path, texture: &Texture) {
        self.add(path);
        let folder = folder_of(path);
        for name in texture.checked().graph().images.names() {
            self.add(&folder.join(name));
        }
    }

    /// Refuses to write over one of them.
    pub(crate) fn guard(&self, file: &Path) -> Result<(), Mistake> {
        let replaced = fs::canonicalize(file).ok();
        if replaced.is_some_and(|file| self.0.contains(&file)) {
            let message = format!("{} would replace a file that is read", file.display());
            return Err(Mistake::usage("unwritable-file", message).help("choose another name"));
        }
        Ok(())
    }
}

/// Where a file is without links, which need not exist yet; as it is named where its folder is not there.
pub(crate) fn place(path: &Path) -> PathBuf {
    let place = fs::canonicalize(path).ok().or_else(|| {
        let folder = fs::canonicalize(folder_of(path)).ok()?;
        Some(folder.join(path.file_name()?))
    });
    place.unwrap_or_else(|| path.to_owned())
}

/// Whether two paths are one file, which need not exist yet.
pub(crate) fn is_same(first: &Path, second: &Path) -> bool {
    place(first) == place(second)
}
