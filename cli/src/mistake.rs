//! What stops a verb: diagnostics and the exit status that they lead to.

use mipless::Diagnostic;
use mipless_runtime::image_file::FileError;
use std::fmt;
use std::path::Path;

/// The exit status, the better first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Status {
    /// Done; there may be warnings.
    Done = 0,
    /// A graph has errors, or is not JSON.
    Graph = 1,
    /// Wrong usage, or a file or device that is not there.
    Usage = 2,
}

/// Why a verb stops, or why one of its inputs is skipped.
#[derive(Debug)]
pub(crate) struct Mistake {
    /// The exit status that it leads to.
    pub(crate) status: Status,
    /// The graph's file, if the diagnostics are about it.
    pub(crate) file: Option<String>,
    /// At least one error.
    pub(crate) diagnostics: Vec<Diagnostic>,
}

impl Mistake {
    /// Wrong usage, or something that the machine does not have.
    pub(crate) fn usage(code: &'static str, message: impl fmt::Display) -> Self {
        Self {
            status: Status::Usage,
            file: None,
            diagnostics: vec![Diagnostic::error(code, message.to_string())],
        }
    }

    /// The same with a help line.
    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        if let Some(diagnostic) = self.diagnostics.pop() {
            self.diagnostics.push(diagnostic.help(help));
        }
        self
    }

    /// A graph with errors.
    pub(crate) fn graph(file: &Path, diagnostics: Vec<Diagnostic>) -> Self {
        let file = Some(file.display().to_string());
        Self {
            status: Status::Graph,
            file,
            diagnostics,
        }
    }
}

impl From<FileError> for Mistake {
    fn from(error: FileError) -> Self {
        Self::usage("unwritable-file", error)
    }
}
