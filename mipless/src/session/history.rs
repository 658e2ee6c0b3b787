//! What has been done and can be taken back.
//!
//! A step is an edit with what takes it back. Edits of one gesture are one step: the last of them, with
//! what takes back the first.

use super::edit::Edit;
use super::patch::Patch;
use mipless_graph::Document;

/// The most steps that can be taken back.
const MOST: usize = 1000;

#[derive(Debug)]
pub(super) struct Step {
    pub(super) edit: Edit,
    pub(super) inverse: Vec<Patch>,
}

#[derive(Debug, Default)]
pub(super) struct History {
    pub(super) done: Vec<Step>,
    /// What was taken back, the next to be done again last.
    pub(super) undone: Vec<Edit>,
    /// Whether the next edit may belong to the gesture of the last one.
    is_open: bool,
}

impl History {
    /// Keeps what has been done; the first step is forgotten where there are too many.
    pub(super) fn record(&mut self, edit: Edit, inverse: Vec<Patch>) -> Option<Step> {
        self.undone.clear();
        if self.is_open
            && let Some(last) = self.done.last_mut()
            && edit.continues(&last.edit)
        {
            last.edit = edit;
            return None;
        }
        self.is_open = true;
        self.push(edit, inverse)
    }

    /// Keeps what has been done as a step of its own.
    pub(super) fn push(&mut self, edit: Edit, inverse: Vec<Patch>) -> Option<Step> {
        self.done.push(Step { edit, inverse });
        (self.done.len() > MOST).then(|| self.done.remove(0))
    }

    /// Ends the gesture.
    pub(super) fn close(&mut self) {
        self.is_open = false;
    }

    /// Takes the last step back; its edit can be done again.
    pub(super) fn undo(&mut self, document: &mut Document) -> bool {
        self.close();
        let Some(Step { edit, inverse }) = self.done.pop() else {
            return false;
        };
        super::patch::revert(document, inverse);
        self.undone.push(edit);
        true
    }
}
