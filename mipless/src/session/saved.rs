//! A session as data: what it began with, and the edits since.

use super::edit::Edit;
use super::{Change, Session, Setup};
use mipless_graph::{Diagnostic, Document};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fmt;

/// A session that can be written anywhere and gone on with, undo and all; it has no files and no
/// programs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Saved {
    /// The document before the first step.
    pub document: Value,
    /// The steps, the first one first.
    pub done: Vec<Edit>,
    /// What was taken back, the next to be done again last.
    pub undone: Vec<Edit>,
}

/// Why what was saved is no session.
#[derive(Debug)]
pub enum RestoreError {
    /// The document cannot be read.
    Document(Vec<Diagnostic>),
    /// A step cannot be done.
    Step(usize, Box<Diagnostic>),
}

impl fmt::Display for RestoreError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Document(mistakes) => {
                for mistake in mistakes {
                    writeln!(f, "{mistake}")?;
                }
                Ok(())
            }
            Self::Step(step, reason) => write!(f, "step {step} cannot be done: {reason}"),
        }
    }
}

impl std::error::Error for RestoreError {}

impl Session {
    /// The session as data.
    pub fn save(&self) -> Saved {
        Saved {
            document: self.base.to_json(),
            done: (self.history.done.iter())
                .map(|step| step.edit.clone())
                .collect(),
            undone: self.history.undone.clone(),
        }
    }

    /// The session of what was saved, with these files and this catalogue.
    ///
    /// # Errors
    /// If it is not what [`Session::save`] gives. What was taken back is not tried.
    pub fn restore(saved: &Saved, setup: Setup) -> Result<Self, RestoreError> {
        let (document, mistakes) = Document::parse(&saved.document.to_string());
        let (Some(document), true) = (document, mistakes.is_empty()) else {
            return Err(RestoreError::Document(mistakes));
        };
        let mut session = Self::of(document, setup);
        for (step, edit) in saved.done.iter().enumerate() {
            let inverse = session
                .perform(edit)
                .map_err(|refused| RestoreError::Step(step, refused))?;
            session.history.push(edit.clone(), inverse);
        }
        session.history.undone.clone_from(&saved.undone);
        let _: Change = session.analyse();
        Ok(session)
    }
}
