//! The pictures that a graph names, with what is wrong with them.

#[cfg(feature = "files")]
mod decoded;
#[cfg(feature = "files")]
use decoded::one;

use crate::files::Files;
use mipless_graph::{Diagnostic, FileReference, Images, Picture, Severity};
use std::collections::BTreeMap;
use std::sync::Arc;

/// What is said of a file wherever it is named.
#[derive(Clone)]
struct Remark {
    severity: Severity,
    code: &'static str,
    message: String,
    help: &'static str,
}

impl Remark {
    fn error(code: &'static str, message: String, help: &'static str) -> Self {
        Self {
            severity: Severity::Error,
            code,
            message,
            help,
        }
    }
}

/// What a name of a file stands for: a picture of one texel where the file cannot be used, so that the
/// graph can be checked all the same.
pub(crate) struct Found {
    picture: Arc<Picture>,
    remark: Option<Remark>,
}

impl Found {
    pub(crate) fn picture(&self) -> &Arc<Picture> {
        &self.picture
    }

    /// What is said of the file where it is named.
    pub(crate) fn diagnostic(&self, reference: &FileReference) -> Option<Diagnostic> {
        let remark = self.remark.clone()?;
        let diagnostic = match remark.severity {
            Severity::Error => reference.error(remark.code, remark.message),
            Severity::Warning | Severity::Note => reference.warning(remark.code, remark.message),
        };
        Some(diagnostic.help(remark.help))
    }
}

/// Reads pictures.
pub(crate) struct Reader<'f>(pub(crate) &'f dyn Files);

impl Reader<'_> {
    pub(crate) fn read(&self, name: &str) -> Found {
        let (picture, remark) = one(name, self.0);
        Found {
            picture: Arc::new(picture),
            remark,
        }
    }
}

/// Reads every file that a graph names, each once; an error says which cannot be used.
pub(crate) fn read(references: &[FileReference], files: &dyn Files) -> (Images, Vec<Diagnostic>) {
    let mut images = Images::default();
    let mut known: BTreeMap<&str, Found> = BTreeMap::new();
    let mut diagnostics = Vec::new();
    for reference in references {
        let name = reference.name.as_str();
        let found = (known.entry(name)).or_insert_with(|| Reader(files).read(name));
        images.insert(name, found.picture.clone());
        diagnostics.extend(found.diagnostic(reference));
    }
    (images, diagnostics)
}

/// Stands in for a picture that cannot be used.
fn nothing() -> Picture {
    Picture::new((1, 1), 1, false, vec![0.0])
}

/// Without a decoder no file is a picture, so that none is read.
#[cfg(not(feature = "files"))]
fn one(name: &str, _: &dyn Files) -> (Picture, Option<Remark>) {
    let message = format!("`{name}` is not read: the feature `files` of mipless is off");
    let help = "build the tool with the feature `files` of the crate `mipless`";
    (nothing(), Some(Remark::error("feature-off", message, help)))
}
