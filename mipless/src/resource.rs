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

/// Reads every file that a graph names, each once. A file that cannot be used has a picture of one
/// texel, so that the graph can be checked all the same; an error says so.
pub(crate) fn read(references: &[FileReference], files: &dyn Files) -> (Images, Vec<Diagnostic>) {
    let mut images = Images::default();
    let mut remarks: BTreeMap<&str, Option<Remark>> = BTreeMap::new();
    let mut diagnostics = Vec::new();
    for reference in references {
        let name = reference.name.as_str();
        let remark = remarks.entry(name).or_insert_with(|| {
            let (picture, remark) = one(name, files);
            images.insert(name, Arc::new(picture));
            remark
        });
        if let Some(remark) = remark.clone() {
            let diagnostic = match remark.severity {
                Severity::Error => reference.error(remark.code, remark.message),
                Severity::Warning | Severity::Note => {
                    reference.warning(remark.code, remark.message)
                }
            };
            diagnostics.push(diagnostic.help(remark.help));
        }
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
