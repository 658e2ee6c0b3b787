//! The pictures that a session has read: each file once, until it is told to look again.

use super::digest::{Digest, Words};
use crate::files::Files;
use crate::resource::{Found, Reader};
use mipless_graph::{Diagnostic, FileReference, Images};
use std::collections::BTreeMap;

#[derive(Default)]
pub(super) struct Pictures {
    known: BTreeMap<String, (Found, Digest)>,
}

impl Pictures {
    /// The pictures that a document names, with what is wrong with them.
    pub(super) fn read(
        &mut self,
        references: &[FileReference],
        files: &dyn Files,
    ) -> (Images, Vec<Diagnostic>) {
        let mut images = Images::default();
        let mut diagnostics = Vec::new();
        for reference in references {
            let name = reference.name.as_str();
            if !self.known.contains_key(name) {
                let found = Reader(files).read(name);
                let picture = found.picture();
                let mut words = Words::default();
                let digest = words
                    .number(picture.width().into())
                    .number(picture.channels().into())
                    .number(picture.encoded().into())
                    .reals(picture.numbers())
                    .take();
                self.known.insert(name.to_owned(), (found, digest));
            }
            let (found, _) = &self.known[name];
            images.insert(name, found.picture().clone());
            diagnostics.extend(found.diagnostic(reference));
        }
        (images, diagnostics)
    }

    /// The digest of what a name stands for.
    pub(super) fn digest(&self, name: &str) -> Option<Digest> {
        self.known.get(name).map(|(_, digest)| *digest)
    }

    /// Forgets what the files held.
    pub(super) fn forget(&mut self) {
        self.known.clear();
    }
}
