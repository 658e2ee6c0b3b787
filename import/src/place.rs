//! Where in which file something stands, and what is said about it.

use mipless_graph::Diagnostic;
use rustc_hash::FxHashSet;

/// A place in one of the files that were read.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Place {
    /// The position in the list of files.
    pub(crate) file: usize,
    /// Bytes before it.
    pub(crate) offset: usize,
    /// The path of names that leads to it, as `/NG_marble/noise`.
    pub(crate) path: String,
}

/// A file that was read.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    pub(crate) name: String,
    pub(crate) text: String,
    /// The bytes at which lines begin.
    lines: Vec<usize>,
}

impl Source {
    pub(crate) fn new(name: String, text: String) -> Self {
        let breaks = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let lines = std::iter::once(0)
            .chain(breaks.map(|(at, _)| at + 1))
            .collect();
        Self { name, text, lines }
    }

    /// The line and the column in characters, from 1, of the byte at `offset`.
    pub(crate) fn line_and_column(&self, offset: usize) -> (u32, u32) {
        let mut offset = offset.min(self.text.len());
        while !self.text.is_char_boundary(offset) {
            offset -= 1;
        }
        let line = self.lines.partition_point(|start| *start <= offset) - 1;
        let before = &self.text[self.lines[line]..offset];
        let column = before.chars().count() + 1;
        (to_u32(line + 1), to_u32(column))
    }
}

fn to_u32(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}

/// Something that was found in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The file: the document, or one that it includes.
    pub file: String,
    /// What, with line and column, and the path of names in place of a JSON pointer.
    pub diagnostic: Diagnostic,
}

/// Collects what is found; the same at the same place is said once.
#[derive(Debug, Default)]
pub(crate) struct Findings {
    pub(crate) sources: Vec<Source>,
    found: Vec<(usize, usize, Diagnostic)>,
    said: FxHashSet<(&'static str, usize, usize, String)>,
}

/// The most findings that are kept: a file of a million mistakes needs no more to be mended.
const MOST: usize = 10_000;

impl Findings {
    /// Says something at a place.
    pub(crate) fn say(&mut self, place: &Place, diagnostic: Diagnostic) {
        let key = (
            diagnostic.code,
            place.file,
            place.offset,
            diagnostic.message.clone(),
        );
        if self.found.len() >= MOST || !self.said.insert(key) {
            return;
        }
        let diagnostic = self.located(place, diagnostic);
        self.found.push((place.file, place.offset, diagnostic));
    }

    /// A diagnostic with the place's line, column and path.
    pub(crate) fn located(&self, place: &Place, diagnostic: Diagnostic) -> Diagnostic {
        let Some(source) = self.sources.get(place.file) else {
            return diagnostic;
        };
        let (line, column) = source.line_and_column(place.offset);
        let node = place
            .path
            .rsplit('/')
            .next()
            .filter(|name| !name.is_empty());
        let diagnostic = diagnostic.at_line(line, column);
        let diagnostic = if place.path.is_empty() {
            diagnostic
        } else {
            diagnostic.at(place.path.clone())
        };
        match node {
            Some(node) => diagnostic.in_node(node),
            None => diagnostic,
        }
    }

    /// Everything in the order of the text.
    pub(crate) fn into_findings(mut self) -> (Vec<Finding>, Vec<Source>) {
        self.found.sort_by_key(|(file, offset, _)| (*file, *offset));
        let found = (self.found.into_iter())
            .map(|(file, _, diagnostic)| Finding {
                file: (self.sources.get(file)).map_or(String::new(), |source| source.name.clone()),
                diagnostic,
            })
            .collect();
        (found, self.sources)
    }
}
