//! Where the files come from that a graph names.

use mipless_graph::Graph;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// The largest file that is read, in bytes.
pub const LARGEST_FILE: u64 = 256 << 20;

/// The most texels of a picture's side.
pub const LARGEST_SIDE: u32 = 16_384;

/// The most texels of a picture: 2048 × 2048, whose moments take about 350 MB in colour.
pub const LARGEST_PICTURE: u64 = 2048 * 2048;

/// What a graph in a file is called that has no name: the file's name without its extension, and
/// `texture` where that is no name (`-`, which stands for standard input, or a folder's `..`).
pub fn name_of_file(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    if stem.is_empty() || path == Path::new("-") {
        return Graph::NAMELESS.to_owned();
    }
    stem.into_owned()
}

/// Gives the bytes of the files that graphs name: a folder, an archive, a database of a tool.
pub trait Files {
    /// The bytes of the file that a graph calls `name`.
    ///
    /// # Errors
    /// If there is no such file, it cannot be read, or it has more than [`LARGEST_FILE`] bytes
    /// ([`io::ErrorKind::FileTooLarge`]).
    fn read(&self, name: &str) -> io::Result<Vec<u8>>;
}

/// The files of a folder; names are relative to it, absolute ones are taken as they are, so that any
/// file that the process can read may be named. [`Folder::within`] is for graphs of strangers.
#[derive(Clone, Debug)]
pub struct Folder(pub PathBuf);

impl Folder {
    /// The same files as far as they lie in `root`, wherever `..`, an absolute name or a symbolic
    /// link leads; others have [`io::ErrorKind::PermissionDenied`].
    ///
    /// # Errors
    /// If `root` is no folder, or cannot be looked at.
    pub fn within(self, root: &Path) -> io::Result<Within> {
        let root = fs::canonicalize(root)?;
        if !root.is_dir() {
            return Err(io::ErrorKind::NotADirectory.into());
        }
        Ok(Within { folder: self, root })
    }
}

/// The files of a folder that lie in another one: see [`Folder::within`].
#[derive(Clone, Debug)]
pub struct Within {
    folder: Folder,
    root: PathBuf,
}

impl Files for Within {
    fn read(&self, name: &str) -> io::Result<Vec<u8>> {
        let named = self.folder.0.join(name);
        let denied = || {
            let reason = format!("it lies outside of {}", self.root.display());
            io::Error::new(io::ErrorKind::PermissionDenied, reason)
        };
        // Whether a file exists outside is nobody's business.
        let path = fs::canonicalize(&named).map_err(|error| {
            let folder = named
                .parent()
                .and_then(|folder| fs::canonicalize(folder).ok());
            match folder {
                Some(folder) if folder.starts_with(&self.root) => error,
                _ => denied(),
            }
        })?;
        if !path.starts_with(&self.root) {
            return Err(denied());
        }
        // The place without links is what is read, whatever the name leads to by now.
        read(&path)
    }
}

impl Files for Folder {
    fn read(&self, name: &str) -> io::Result<Vec<u8>> {
        read(&self.0.join(name))
    }
}

/// The bytes of a regular file.
fn read(path: &Path) -> io::Result<Vec<u8>> {
    let metadata = fs::metadata(path)?;
    if metadata.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    // A pipe might never end, and never begin.
    if !metadata.is_file() {
        return Err(io::Error::other("it is no regular file"));
    }
    let mut bytes = Vec::new();
    let read = File::open(path)?.take(LARGEST_FILE + 1);
    io::BufReader::new(read).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(io::ErrorKind::FileTooLarge.into());
    }
    Ok(bytes)
}

/// No files: what a text without a place has.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoFiles;

impl Files for NoFiles {
    fn read(&self, _: &str) -> io::Result<Vec<u8>> {
        Err(io::Error::new(
            io::ErrorKind::NotFound,
            "the graph is a text without a folder",
        ))
    }
}

/// Files in memory, by name.
impl Files for BTreeMap<String, Vec<u8>> {
    fn read(&self, name: &str) -> io::Result<Vec<u8>> {
        let bytes = self.get(name).ok_or(io::ErrorKind::NotFound)?;
        if bytes.len() as u64 > LARGEST_FILE {
            return Err(io::ErrorKind::FileTooLarge.into());
        }
        Ok(bytes.clone())
    }
}
