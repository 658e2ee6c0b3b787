//! Documents of other tools, read where a graph is wanted.

use crate::mistake::Mistake;
use crate::report::Report;
use mipless::{Diagnostic, Files, Severity};
use mipless_import::{Finding, Format, Imported, Options, import};
use std::fs;
use std::path::{Path, PathBuf};

/// The largest document of an installation, how deep its folders are, and how many there are.
const LARGEST: u64 = 16 << 20;
const DEEPEST: usize = 8;
const MOST: usize = 4_000;

/// Reads a document as a graph, and says what was approximated.
pub(crate) fn graph(
    format: Format,
    path: &Path,
    text: &str,
    files: &dyn Files,
    report: &mut Report,
) -> Result<(String, Imported), Mistake> {
    let mut imported = read(format, path, text, files, report)?;
    let arguments = report.importing().clone();
    let is_refused = |finding: &Finding| finding.diagnostic.is_error();
    if arguments.strict {
        for finding in &mut imported.findings {
            finding.diagnostic.severity = Severity::Error;
        }
    }
    let complete = imported.is_complete();
    let refused = match &imported.document {
        Some(_) if arguments.partial => false,
        Some(_) => !complete,
        None => true,
    };
    let (errors, notes): (Vec<Finding>, Vec<Finding>) =
        imported.findings.iter().cloned().partition(is_refused);
    for note in &notes {
        report.diagnostic(Some(&shown(path, &note.file)), &note.diagnostic);
    }
    if refused {
        let mut diagnostics: Vec<Diagnostic> = errors
            .into_iter()
            .map(|finding| in_main(path, finding))
            .collect();
        let mut summary =
            Diagnostic::error("import-incomplete", format!("{} load", imported.summary()));
        if imported.document.is_some() && !arguments.strict {
            summary = summary.help("`--partial` takes what loads");
        }
        diagnostics.push(summary);
        return Err(Mistake::graph(path, diagnostics));
    }
    // With `--partial` what does not load is no reason to stop.
    for mut error in errors {
        error.diagnostic.severity = Severity::Warning;
        report.diagnostic(Some(&shown(path, &error.file)), &error.diagnostic);
    }
    if !complete {
        report.note(format_args!("{}: {}", path.display(), imported.summary()));
    }
    let text = (imported.document.as_ref()).map_or(String::new(), |document| document.to_text());
    Ok((text, imported))
}

/// Reads a document.
fn read(
    format: Format,
    path: &Path,
    text: &str,
    files: &dyn Files,
    report: &Report,
) -> Result<Imported, Mistake> {
    let arguments = report.importing();
    let library = arguments.library.as_deref();
    if let Some(folder) = library.filter(|folder| !folder.is_dir()) {
        let message = format!("`--library {}`: there is no such folder", folder.display());
        return Err(Mistake::usage("usage", message).help("name the folder of an installation"));
    }
    let specs = mipless::specs();
    let options = Options {
        specs: &specs,
        material: arguments.material.as_deref(),
        files: &|name| files.read(name),
        library: &|| documents(library),
    };
    Ok(import(format, &file_name(path), text, &options))
}

fn file_name(path: &Path) -> String {
    path.file_name()
        .map_or(String::new(), |name| name.to_string_lossy().into_owned())
}

/// The name of a file beside the document.
fn shown(path: &Path, file: &str) -> String {
    if file.is_empty() || file == file_name(path) {
        path.display().to_string()
    } else {
        path.with_file_name(file).display().to_string()
    }
}

/// A finding as a diagnostic of the document; of another file it says which.
fn in_main(path: &Path, finding: Finding) -> Diagnostic {
    if finding.file.is_empty() || finding.file == file_name(path) {
        return finding.diagnostic;
    }
    let reason = format!(
        "it stands in `{}`, which the document includes",
        finding.file
    );
    finding.diagnostic.because(reason)
}

/// The documents of an installation of MaterialX.
fn documents(library: Option<&Path>) -> Vec<(String, String)> {
    let folders: Vec<PathBuf> = match library {
        Some(folder) => vec![folder.to_path_buf()],
        None => std::env::var_os("MATERIALX_SEARCH_PATH")
            .map(|paths| std::env::split_paths(&paths).collect())
            .unwrap_or_default(),
    };
    let mut open: Vec<(PathBuf, usize)> = folders.into_iter().map(|folder| (folder, 0)).collect();
    let mut found = Vec::new();
    while let Some((folder, depth)) = open.pop() {
        let Ok(entries) = fs::read_dir(&folder) else {
            continue;
        };
        let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        paths.sort();
        for path in paths {
            if path.is_dir() {
                if depth < DEEPEST {
                    open.push((path, depth + 1));
                }
            } else if path
                .extension()
                .is_some_and(|extension| extension == "mtlx")
                && found.len() < MOST
                && fs::metadata(&path).is_ok_and(|metadata| metadata.len() <= LARGEST)
                && let Ok(text) = fs::read_to_string(&path)
            {
                found.push((path.display().to_string(), text));
            }
        }
    }
    found
}
