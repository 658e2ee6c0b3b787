//! Reading graphs from files.

use crate::importing;
use crate::mistake::{Mistake, Status};
use crate::report::Report;
use mipless::manifest::{ManifestRead, sha256};
use mipless::{Diagnostic, Files, Folder, Method, Texture, name_of_file};
use mipless_graph::CheckOptions;
use mipless_import::{Format, Imported};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// The largest file that is read, in bytes: a graph of 131,072 nodes takes about a tenth.
const LARGEST: u64 = 1 << 30;

/// Whether a graph may hold signals that only sampling filters.
pub(crate) fn allows_sampling(method: Method) -> CheckOptions {
    CheckOptions {
        allow_sampling: matches!(method, Method::Supersample(_)),
    }
}

/// Reads and checks a graph, and says its warnings; `-` is standard input.
pub(crate) fn load(
    path: &Path,
    options: &CheckOptions,
    report: &mut Report,
) -> Result<Texture, Mistake> {
    let graph = graph(path, report)?;
    let texture = parse(path, &graph, options, report)?;
    warn(path, &texture, report);
    Ok(texture)
}

/// The same of a text that is read already, with the files beside the graph that were read for it, and what
/// they hold.
pub(crate) fn load_recorded(
    path: &Path,
    text: String,
    options: &CheckOptions,
    report: &mut Report,
) -> Result<(Texture, Recorded), Mistake> {
    let files = Recorded {
        files: files(path, report)?,
        read: RefCell::default(),
    };
    let graph = graph_with(path, text, &files, report)?;
    let texture = parse_with(path, &graph, options, &files, report)?;
    warn(path, &texture, report);
    Ok((texture, files))
}

/// Files that remember which of them were read.
pub(crate) struct Recorded {
    files: Box<dyn Files>,
    read: RefCell<BTreeMap<String, String>>,
}

impl Recorded {
    /// The names, with the SHA-256 of what the files hold.
    pub(crate) fn read(self) -> Vec<ManifestRead> {
        let read = self.read.into_inner().into_iter();
        read.map(|(name, sha256)| ManifestRead { name, sha256 })
            .collect()
    }
}

impl Files for Recorded {
    fn read(&self, name: &str) -> io::Result<Vec<u8>> {
        let bytes = self.files.read(name)?;
        let mut read = self.read.borrow_mut();
        read.insert(name.to_owned(), sha256(&bytes));
        Ok(bytes)
    }
}

/// The text of a graph, and where it comes from if another tool wrote it.
#[derive(Debug)]
pub(crate) struct Written {
    pub(crate) text: String,
    pub(crate) imported: Option<Imported>,
}

/// Reads a file as the text of a graph; a document of another tool is converted on the way.
pub(crate) fn graph(path: &Path, report: &mut Report) -> Result<Written, Mistake> {
    let files = files(path, report)?;
    graph_with(path, read(path)?, &*files, report)
}

fn graph_with(
    path: &Path,
    text: String,
    files: &dyn Files,
    report: &mut Report,
) -> Result<Written, Mistake> {
    match Format::of(path) {
        Some(format) => {
            let (text, imported) = importing::graph(format, path, &text, files, report)?;
            Ok(Written {
                text,
                imported: Some(imported),
            })
        }
        None => Ok(Written {
            text,
            imported: None,
        }),
    }
}

/// Says the warnings of a graph.
pub(crate) fn warn(path: &Path, texture: &Texture, report: &mut Report) {
    let file = path.display().to_string();
    for warning in texture.warnings() {
        report.diagnostic(Some(&file), warning);
    }
}

/// The folder that files are named from; of standard input, the current one.
pub(crate) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Checks the text of a graph; mistakes stand where its author wrote what they are about.
pub(crate) fn parse(
    path: &Path,
    graph: &Written,
    options: &CheckOptions,
    report: &Report,
) -> Result<Texture, Mistake> {
    parse_with(path, graph, options, &*files(path, report)?, report)
}

fn parse_with(
    path: &Path,
    graph: &Written,
    options: &CheckOptions,
    files: &dyn Files,
    report: &Report,
) -> Result<Texture, Mistake> {
    let name = name_of_file(path);
    let checked = Texture::with_name(&name, &graph.text, options, files);
    let fixed = graph.imported.as_ref().filter(|_| checked.is_err());
    if let Some(document) = fixed.and_then(Imported::without_inputs)
        && let Ok(texture) = Texture::with_name(&name, &document.to_text(), options, files)
    {
        report.note(format_args!(
            "{}: the inputs are written as the numbers that they hold, since not all that they may \
             be is a texture",
            path.display()
        ));
        return Ok(texture);
    }
    checked.map_err(|diagnostics| {
        let located = match &graph.imported {
            Some(imported) => (diagnostics.into_iter())
                .map(|diagnostic| imported.located(diagnostic).diagnostic)
                .collect(),
            None => diagnostics,
        };
        Mistake::graph(path, located)
    })
}

/// The files that a graph names, or a document includes.
pub(crate) fn files(path: &Path, report: &Report) -> Result<Box<dyn Files>, Mistake> {
    let folder = Folder(folder_of(path).to_path_buf());
    Ok(match report.root() {
        Some(root) => Box::new(folder.within(root).map_err(|error| {
            let message = format!("`--root {}`: {error}", root.display());
            Mistake::usage("usage", message).help("name a folder that exists")
        })?),
        None => Box::new(folder),
    })
}

/// Reads a text; `-` is standard input.
pub(crate) fn read(path: &Path) -> Result<String, Mistake> {
    let unreadable = |error: io::Error| Mistake {
        status: Status::Usage,
        file: Some(path.display().to_string()),
        diagnostics: vec![Diagnostic::error(
            "unreadable-file",
            format!("the file cannot be read: {error}"),
        )],
    };
    let mut bytes = Vec::new();
    let read = if path == Path::new("-") {
        io::stdin().lock().take(LARGEST + 1).read_to_end(&mut bytes)
    } else {
        File::open(path).and_then(|file| file.take(LARGEST + 1).read_to_end(&mut bytes))
    };
    let length = read.map_err(unreadable)?;
    if length as u64 > LARGEST {
        return Err(unreadable(io::Error::other("it is larger than 1 GiB")));
    }
    String::from_utf8(bytes).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let (line, column) = place(&String::from_utf8_lossy(good));
        let diagnostic = Diagnostic::error("not-utf8", "the text is not UTF-8")
            .at_line(line, column)
            .help("save the file as UTF-8");
        Mistake::graph(path, vec![diagnostic])
    })
}

/// The line and the column, from 1, of what follows `text`.
fn place(text: &str) -> (u32, u32) {
    // A byte order mark is no column of an editor.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let line = text.bytes().filter(|&byte| byte == b'\n').count() + 1;
    let column = text.rsplit('\n').next().unwrap_or("").chars().count() + 1;
    (line as u32, column as u32)
}

#[cfg(test)]
mod tests {
    #[test]
    fn places_count_characters_from_one() {
        assert_eq!(super::place(""), (1, 1));
        assert_eq!(super::place("a\nöb"), (2, 3));
        assert_eq!(super::place("\u{feff}ab"), (1, 3));
    }
}
