//! The pictures that a graph names, with what is wrong with them.

use crate::files::{Files, LARGEST_FILE};
use crate::picture::{PictureError, decode};
use mipless_graph::{Diagnostic, FileReference, Images, Picture, Severity};
use std::collections::BTreeMap;
use std::io;
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
                Severity::Warning => reference.warning(remark.code, remark.message),
            };
            diagnostics.push(diagnostic.help(remark.help));
        }
    }
    (images, diagnostics)
}

fn one(name: &str, files: &dyn Files) -> (Picture, Option<Remark>) {
    let decoded = match files.read(name) {
        Ok(bytes) => decode(&bytes).map_err(|error| unusable(name, &error)),
        Err(error) => Err(unreadable(name, &error)),
    };
    match decoded {
        Ok(decoded) => {
            let remark = (decoded.replaced > 0).then(|| Remark {
                severity: Severity::Warning,
                code: "not-finite-texels",
                message: format!("{} numbers of `{name}` are not finite", decoded.replaced),
                help: "NaN is taken for 0, and infinity for 65504",
            });
            (decoded.picture, remark)
        }
        Err(remark) => (Picture::new((1, 1), 1, false, vec![0.0]), Some(remark)),
    }
}

fn unreadable(name: &str, error: &io::Error) -> Remark {
    let limit = LARGEST_FILE >> 20;
    match error.kind() {
        io::ErrorKind::NotFound => Remark::error(
            "missing-file",
            format!("there is no file `{name}`: {error}"),
            "names are relative to the file of the graph",
        ),
        io::ErrorKind::FileTooLarge => Remark::error(
            "image-too-large",
            format!("`{name}` is larger than {limit} MiB"),
            "make it smaller",
        ),
        io::ErrorKind::IsADirectory => Remark::error(
            "unreadable-file",
            format!("`{name}` is a folder"),
            "name a picture in it",
        ),
        _ => Remark::error(
            "unreadable-file",
            format!("`{name}` cannot be read: {error}"),
            "the file must be readable",
        ),
    }
}

fn unusable(name: &str, error: &PictureError) -> Remark {
    let message = format!("`{name}` cannot be used: {error}");
    match error {
        PictureError::Format => {
            Remark::error("not-an-image", message, "convert it to .png, .jpg or .exr")
        }
        PictureError::Corrupt(..) | PictureError::Empty => {
            Remark::error("bad-image", message, "save or export it again")
        }
        PictureError::TooLarge(..) => Remark::error("image-too-large", message, "scale it down"),
        PictureError::Channels(_) => Remark::error(
            "bad-image",
            message,
            "name its channels R, G, B and A, or Y, or X, Y, Z and W",
        ),
    }
}
