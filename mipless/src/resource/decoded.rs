//! A picture from a file, with what is wrong with it.

use super::{Remark, nothing};
use crate::files::{Files, LARGEST_FILE};
use crate::picture::{PictureError, decode};
use mipless_graph::{Picture, Severity};
use std::io;

/// Reads and decodes a file, or says why it cannot be used.
pub(super) fn one(name: &str, files: &dyn Files) -> (Picture, Option<Remark>) {
    let decoded = match files.read(name) {
        Ok(bytes) => decode(&bytes).map_err(|error| unusable(name, &error)),
        Err(error) => Err(unreadable(name, &error)),
    };
    match decoded {
        Ok(decoded) => {
            let remark = (decoded.replaced > 0).then(|| Remark {
                severity: Severity::Warning,
                code: "not-finite-texels",
                message: format!(
                    "{} numbers of `{name}` are not finite, or larger than 1e9",
                    decoded.replaced
                ),
                help: "NaN is taken for 0, infinity for 65504, and what is larger than 1e9 for that",
            });
            (decoded.picture, remark)
        }
        Err(remark) => (nothing(), Some(remark)),
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
        io::ErrorKind::PermissionDenied => Remark::error(
            "unreadable-file",
            format!("`{name}` cannot be read: {error}"),
            "the file must be readable, and lie in the folder that files are limited to, if they are",
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
