//! Files that are generated and committed. Their tests compare; with `MIPLESS_WRITE=1` they write.

use crate::{asked, root};
use std::fs;
use std::path::Path;

/// What to do about a stale file.
pub const FRESH: &str = "bash .ci/fresh makes it fresh";

/// Compares a committed file with what it should hold, or writes it.
///
/// # Errors
/// If the file is stale or missing, with the command that makes it fresh.
///
/// # Panics
/// If it cannot be written.
pub fn compare(path: &str, wanted: &str) -> Result<(), String> {
    let file = root().join(path);
    if fs::read_to_string(&file).is_ok_and(|held| held == wanted) {
        return Ok(());
    }
    if asked("MIPLESS_WRITE") {
        fs::create_dir_all(file.parent().expect("a folder")).expect("a folder for the file");
        fs::write(&file, wanted).expect("the file is written");
        return Ok(());
    }
    Err(format!("{path} is stale: {FRESH}"))
}

/// The names of the files of a folder that end as given, sorted; none if there is no such folder.
///
/// # Panics
/// If an entry cannot be read.
pub fn names(folder: &Path, ending: &str) -> Vec<String> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut names: Vec<String> = entries
        .map(|entry| {
            entry
                .expect("a readable entry")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .filter(|name| name.ends_with(ending))
        .collect();
    names.sort();
    names
}
