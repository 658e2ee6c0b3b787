//! What is wrong with a document, where, why, and what to write instead.

use std::fmt;

use serde::Serialize;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// The graph cannot be compiled.
    Error,
    /// The graph compiles, but probably not to what was meant.
    Warning,
    /// Something was read in another way than it is written, as what it is read into has it.
    Note,
}

/// A mistake of the user, found in a document.
///
/// It serialises to the keys of the `--json` output; what is absent is left out.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// A stable kebab-case name of the kind of mistake.
    pub code: &'static str,
    /// Where in the document (RFC 6901); absent where the text is not JSON.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pointer: Option<String>,
    /// The line in the text, from 1; absent where the document did not come from text.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<u32>,
    /// The column in characters, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub column: Option<u32>,
    /// The node.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub node: Option<String>,
    /// The input of the node.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub port: Option<String>,
    /// What is wrong, in one line.
    pub message: String,
    /// The chain of reasons.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub because: Vec<String>,
    /// What to do about it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub help: Option<String>,
}

impl Diagnostic {
    /// An error without a place.
    pub fn error(code: &'static str, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            code,
            pointer: None,
            line: None,
            column: None,
            node: None,
            port: None,
            message: message.into(),
            because: Vec::new(),
            help: None,
        }
    }

    /// A warning without a place.
    pub fn warning(code: &'static str, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Warning,
            ..Self::error(code, message)
        }
    }

    /// A note without a place.
    pub fn note(code: &'static str, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Note,
            ..Self::error(code, message)
        }
    }

    /// The same at a JSON pointer.
    pub fn at(self, pointer: impl Into<String>) -> Self {
        Self {
            pointer: Some(pointer.into()),
            ..self
        }
    }

    /// The same at a line and a column of the text.
    pub fn at_line(self, line: u32, column: u32) -> Self {
        Self {
            line: Some(line),
            column: Some(column),
            ..self
        }
    }

    /// The same in a node.
    pub fn in_node(self, node: impl Into<String>) -> Self {
        Self {
            node: Some(node.into()),
            ..self
        }
    }

    /// The same in an input of the node.
    pub fn in_port(self, port: impl Into<String>) -> Self {
        Self {
            port: Some(port.into()),
            ..self
        }
    }

    /// The same with one more reason.
    pub fn because(mut self, reason: impl Into<String>) -> Self {
        self.because.push(reason.into());
        self
    }

    /// The same with a help line.
    pub fn help(self, help: impl Into<String>) -> Self {
        Self {
            help: Some(help.into()),
            ..self
        }
    }

    /// The same with a help line, if there is one.
    pub fn help_if(self, help: Option<String>) -> Self {
        match help {
            Some(help) => self.help(help),
            None => self,
        }
    }

    /// Whether it keeps the graph from being compiled.
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }

    /// The text for people, with the name of the file that the document was read from.
    pub fn in_file<'a>(&'a self, file: &'a str) -> impl fmt::Display + 'a {
        Shown {
            diagnostic: self,
            file: Some(file),
        }
    }
}

/// A diagnostic with the name of its file.
struct Shown<'a> {
    diagnostic: &'a Diagnostic,
    file: Option<&'a str>,
}

impl fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let diagnostic = self.diagnostic;
        let severity = match diagnostic.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        };
        write!(f, "{severity}[{}]: {}", diagnostic.code, diagnostic.message)?;
        let position = diagnostic.line.zip(diagnostic.column);
        if self.file.is_some() || diagnostic.pointer.is_some() || position.is_some() {
            f.write_str("\n -->")?;
            if let Some(file) = self.file {
                write!(f, " {file}")?;
            }
            match (&diagnostic.pointer, position) {
                (Some(pointer), Some((line, column))) => {
                    write!(
                        f,
                        " {} (line {line}, column {column})",
                        shown_pointer(pointer)
                    )?;
                }
                (Some(pointer), None) => write!(f, " {}", shown_pointer(pointer))?,
                (None, Some((line, column))) => write!(f, " line {line}, column {column}")?,
                (None, None) => {}
            }
        }
        for reason in &diagnostic.because {
            write!(f, "\n  because {reason}")?;
        }
        if let Some(help) = &diagnostic.help {
            write!(f, "\n  help: {help}")?;
        }
        Ok(())
    }
}

/// The pointer of the whole document is empty, which nobody would see.
fn shown_pointer(pointer: &str) -> &str {
    if pointer.is_empty() {
        "(the document)"
    } else {
        pointer
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        Shown {
            diagnostic: self,
            file: None,
        }
        .fmt(f)
    }
}

/// The candidate that was probably meant: the nearest by edits (transpositions count one), at most
/// a third of the letters apart, whatever the case.
pub fn suggest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let wanted = name.to_lowercase();
    let length = wanted.chars().count();
    let limit = (length / 3).max(1);
    let mut best: Option<(usize, &str)> = None;
    for candidate in candidates {
        // The difference of the lengths is a lower bound; a character takes at most four bytes.
        if candidate.len() > 4 * (length + limit) || candidate.len() + limit < length {
            continue;
        }
        let distance = strsim::damerau_levenshtein(&wanted, &candidate.to_lowercase());
        if distance <= limit && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

/// The help line that offers the nearest candidate, or else the few that there are.
pub(crate) fn did_you_mean<'a>(
    name: &str,
    candidates: impl IntoIterator<Item = &'a str> + Clone,
) -> Option<String> {
    const LISTED: usize = 12;
    if let Some(candidate) = suggest(name, candidates.clone()) {
        return Some(format!("did you mean `{candidate}`?"));
    }
    let all: Vec<&str> = candidates.into_iter().take(LISTED + 1).collect();
    let listed = !all.is_empty() && all.len() <= LISTED;
    listed.then(|| format!("one of `{}`", all.join("`, `")))
}

/// A segment of a JSON pointer, escaped (RFC 6901 §3).
pub(crate) fn escape(segment: &str) -> String {
    if segment.contains(['~', '/']) {
        segment.replace('~', "~0").replace('/', "~1")
    } else {
        segment.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn people_read_the_place_the_reasons_and_the_help() {
        let diagnostic = Diagnostic::error("unknown-port", "`noise2d` has no input `freq`")
            .at("/nodes/n/inputs/freq")
            .at_line(3, 9)
            .because("`n` is a `noise2d`")
            .help("did you mean `frequency`?");
        assert_eq!(
            diagnostic.in_file("a.json").to_string(),
            "error[unknown-port]: `noise2d` has no input `freq`\n \
             --> a.json /nodes/n/inputs/freq (line 3, column 9)\n  \
             because `n` is a `noise2d`\n  \
             help: did you mean `frequency`?"
        );
        let json = serde_json::to_value(&diagnostic).expect("a diagnostic serialises");
        assert_eq!(json["severity"], "error");
        assert!(json.get("node").is_none());
    }

    #[test]
    fn suggestions_are_near_and_never_far() {
        let names = ["noise2d", "sin", "multiply"];
        assert_eq!(suggest("nosie2d", names), Some("noise2d"));
        assert_eq!(suggest("Multiply", names), Some("multiply"));
        assert_eq!(suggest("zzz", names), None);
        assert_eq!(suggest("", names), None);
    }
}
