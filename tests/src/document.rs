//! Documents of other tools: reading them, and looking at what they become.

use mipless::{CheckOptions, Footprint, Method, NoFiles, Options, Texture, specs};
use mipless_import::{Format, Imported, import};
use std::io;

/// Reads a document with files and documents of an installation beside it.
pub fn read(
    format: Format,
    text: &str,
    files: &[(&str, &str)],
    library: &[(&str, &str)],
) -> Imported {
    let specs = specs();
    let find = |name: &str| {
        let found = files.iter().find(|(own, _)| *own == name);
        found
            .map(|(_, text)| text.as_bytes().to_vec())
            .ok_or_else(|| io::ErrorKind::NotFound.into())
    };
    let documents = || {
        let pairs = library
            .iter()
            .map(|(name, text)| ((*name).to_owned(), (*text).to_owned()));
        pairs.collect()
    };
    let options = mipless_import::Options {
        specs: &specs,
        files: &find,
        library: &documents,
        ..mipless_import::Options::default()
    };
    import(format, "document", text, &options)
}

/// A MaterialX document with these elements.
pub fn wrapped(body: &str) -> String {
    format!("<?xml version=\"1.0\"?>\n<materialx version=\"1.39\">\n{body}\n</materialx>")
}

/// Reads a MaterialX document with these elements.
pub fn mtlx(body: &str) -> Imported {
    read(Format::MaterialX, &wrapped(body), &[], &[])
}

/// The graph, which has no mistakes.
///
/// # Panics
/// If it has.
pub fn texture(imported: &Imported) -> Texture {
    let errors: Vec<String> = (imported.findings.iter())
        .filter(|finding| finding.diagnostic.is_error())
        .map(|finding| finding.diagnostic.to_string())
        .collect();
    assert!(errors.is_empty(), "{errors:#?}");
    let document = imported.document.as_ref().expect("a graph");
    let text = document.to_text();
    Texture::with_name("t", &text, &CheckOptions::default(), &NoFiles)
        .unwrap_or_else(|mistakes| panic!("{mistakes:#?}\n{text}"))
}

/// The components of the first output at a place.
pub fn at(imported: &Imported, uv: [f32; 2]) -> Vec<f32> {
    let options = Options {
        method: Method::Point,
        ..Options::default()
    };
    let place = Footprint {
        uv,
        ..Footprint::default()
    };
    let values = texture(imported).evaluator(&options).evaluate(&[place]);
    values.into_iter().map(|component| component[0]).collect()
}

/// The value of a node's output at a place, given as the inside of a nodegraph and the type.
pub fn value(nodes: &str, ty: &str, uv: [f32; 2]) -> Vec<f32> {
    let text = format!(
        "<nodegraph name=\"g\">{nodes}<output name=\"out\" type=\"{ty}\" nodename=\"n\"/></nodegraph>"
    );
    at(&mtlx(&text), uv)
}

/// Asserts that numbers are these.
///
/// # Panics
/// If they are not.
pub fn close(values: &[f32], wanted: &[f32]) {
    let near = values.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-5);
    assert!(
        values.len() == wanted.len() && near,
        "{values:?}, not {wanted:?}"
    );
}

/// What is said, as code, line and path.
///
/// # Panics
/// If something has no line.
pub fn said(imported: &Imported) -> Vec<(&str, u32, &str)> {
    let findings = imported.findings.iter().map(|finding| {
        let diagnostic = &finding.diagnostic;
        let path = diagnostic.pointer.as_deref().unwrap_or("");
        (diagnostic.code, diagnostic.line.expect("a line"), path)
    });
    findings.collect()
}
