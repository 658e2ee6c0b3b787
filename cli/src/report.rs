//! What a run says, to people or to tools.
//!
//! For people, diagnostics and notes go to standard error as they come, and results to standard
//! output. With `--json`, standard output gets one object in the end, and standard error nothing.
//! A reader that closes either of them early is no mistake.

use crate::foreign::Arguments as Importing;
use crate::mistake::{Mistake, Status};
use mipless::Diagnostic;
use serde_json::{Map, Value, json};
use std::cell::RefCell;
use std::fmt;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Collects what is said, and the worst status.
#[derive(Debug)]
pub(crate) struct Report {
    json: bool,
    root: Option<PathBuf>,
    importing: Importing,
    status: Status,
    diagnostics: Vec<Value>,
    results: Map<String, Value>,
    /// What is said to people, where it is not said at once.
    held: Option<RefCell<String>>,
}

impl Report {
    /// Nothing said yet, of a run whose graphs name no files outside of `root`, and which reads
    /// documents of other tools as `importing` says.
    pub(crate) fn new(json: bool, root: Option<PathBuf>, importing: Importing) -> Self {
        Self {
            json,
            root,
            importing,
            status: Status::Done,
            diagnostics: Vec::new(),
            results: Map::new(),
            held: None,
        }
    }

    /// A report of a part of the work that is done beside others: what it says is held until
    /// [`Report::absorb`] says it.
    pub(crate) fn part(&self) -> Self {
        let mut part = Self::new(self.json, self.root.clone(), self.importing.clone());
        part.held = Some(RefCell::default());
        part
    }

    /// Says what a part of the work has said; its results are left out.
    pub(crate) fn absorb(&mut self, part: Self) {
        self.worsen(part.status);
        self.diagnostics.extend(part.diagnostics);
        if let Some(held) = part.held.map(RefCell::into_inner)
            && !held.is_empty()
        {
            self.complain(&held.trim_end());
        }
    }

    /// One paragraph for people.
    fn complain(&self, text: &dyn fmt::Display) {
        match &self.held {
            Some(held) => *held.borrow_mut() += &format!("{text}\n"),
            None => complain(text),
        }
    }

    /// The folder outside of which no picture is read.
    pub(crate) fn root(&self) -> Option<&Path> {
        self.root.as_deref()
    }

    /// How documents of other tools are read.
    pub(crate) fn importing(&self) -> &Importing {
        &self.importing
    }

    /// Whether tools listen.
    pub(crate) fn is_json(&self) -> bool {
        self.json
    }

    /// Whether a bar of progress has a reader.
    pub(crate) fn shows_progress(&self) -> bool {
        !self.json && io::stderr().is_terminal()
    }

    /// Makes the exit status at least this bad.
    pub(crate) fn worsen(&mut self, status: Status) {
        self.status = self.status.max(status);
    }

    /// Says a diagnostic about a file, if it is about one.
    pub(crate) fn diagnostic(&mut self, file: Option<&str>, diagnostic: &Diagnostic) {
        if self.json {
            let mut value = serde_json::to_value(diagnostic).expect("a diagnostic has plain keys");
            if let (Some(file), Value::Object(members)) = (file, &mut value) {
                members.insert("file".to_owned(), file.into());
            }
            self.diagnostics.push(value);
            return;
        }
        match file {
            Some(file) => self.complain(&diagnostic.in_file(file)),
            None => self.complain(diagnostic),
        }
    }

    /// Says a mistake.
    pub(crate) fn mistake(&mut self, mistake: &Mistake) {
        self.worsen(mistake.status);
        for diagnostic in &mistake.diagnostics {
            self.diagnostic(mistake.file.as_deref(), diagnostic);
        }
    }

    /// Says a warning about the request.
    pub(crate) fn warn(&mut self, code: &'static str, message: impl Into<String>) {
        self.diagnostic(None, &Diagnostic::warning(code, message));
    }

    /// Says how it went, to people.
    pub(crate) fn note(&self, note: impl fmt::Display) {
        if !self.json {
            self.complain(&note);
        }
    }

    /// Prints a result for people.
    pub(crate) fn print(&mut self, text: impl fmt::Display) {
        if !self.json && print(&text).is_err() {
            self.worsen(Status::Usage);
        }
    }

    /// Adds a result for tools.
    pub(crate) fn result(&mut self, key: &str, value: impl Into<Value>) {
        self.results.insert(key.to_owned(), value.into());
    }

    /// Says all that there is so far, where more is to come.
    pub(crate) fn flush(&mut self) {
        if self.json {
            self.print_json();
        }
    }

    fn print_json(&mut self) {
        let mut object = Map::new();
        let diagnostics = std::mem::take(&mut self.diagnostics);
        object.insert("diagnostics".to_owned(), Value::Array(diagnostics));
        object.extend(std::mem::take(&mut self.results));
        if print(&format_args!("{:#}\n", Value::Object(object))).is_err() {
            self.status = Status::Usage;
        }
    }

    /// The end.
    pub(crate) fn finish(mut self) -> ExitCode {
        self.flush();
        ExitCode::from(self.status as u8)
    }
}

/// One paragraph on standard error; nobody can be told if that fails.
fn complain(text: &dyn fmt::Display) {
    drop(writeln!(io::stderr().lock(), "{text}"));
}

/// Text on standard output. Only a closed pipe is no error.
fn print(text: &dyn fmt::Display) -> io::Result<()> {
    let mut out = io::BufWriter::new(io::stdout().lock());
    match write!(out, "{text}").and_then(|()| out.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => {
            // What is left in the buffer would be tried again when it is dropped.
            drop(out.into_parts());
            Ok(())
        }
        Err(error) => {
            complain(&format_args!(
                "error: standard output cannot be written: {error}"
            ));
            drop(out.into_parts());
            Err(error)
        }
        Ok(()) => Ok(()),
    }
}

/// Says why a command line cannot be understood, or prints the help that it asks for.
pub(crate) fn usage(error: &clap::Error) -> ExitCode {
    let wants_json = std::env::args_os().any(|argument| argument == "--json");
    if wants_json && error.use_stderr() {
        let rendered = error.render().to_string();
        let message = rendered.trim().trim_start_matches("error: ");
        let mut report = Report::new(true, None, Importing::default());
        report
            .diagnostics
            .push(json!(Diagnostic::error("usage", message)));
        report.worsen(Status::Usage);
        return report.finish();
    }
    // A closed pipe is no error, and nothing else can be told.
    drop(error.print());
    ExitCode::from(if error.use_stderr() {
        Status::Usage
    } else {
        Status::Done
    } as u8)
}
